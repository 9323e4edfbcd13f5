// What changes a session's inputs, and when its clients are told: never before the journal has it.

#include <utility>

#include "session/session.h"

namespace lpv {

EditOutcome Session::apply(const ClientIdentity& client, Edit edit) {
  for (Operation& operation : edit.operations) {
    auto* vertices = std::get_if<SetVertices>(&operation);
    if (!vertices) continue;
    MeshPtr base;
    {
      const MutexLock lock(mutex_);
      base = document_.meshOf(vertices->object);
    }
    // A failure here is found again, with its place in the edit, when the document applies it.
    (void)prepareVertices(*vertices, base, services_.hasher).ok();
  }
  EditOutcome outcome;
  {
    const MutexLock lock(mutex_);
    outcome = applyEdit(client, edit);
  }
  announce(outcome);
  return outcome;
}

EditOutcome Session::recordRejected(const ClientIdentity& client, std::uint64_t sequence, const Status& why) {
  services_.counters->editsRejected.add(why);
  const MutexLock lock(mutex_);
  EditOutcome outcome;
  outcome.sequence = sequence;
  outcome.revision = document_.revision();
  outcome.status = closed_ ? closedStatus("session") : members_.verify(client);
  if (!outcome.status.ok()) return outcome;
  const Expected<std::optional<EditOutcome>> before = members_.repeated(client.id, sequence);
  if (before && *before) return **before;
  if (!before) {
    outcome.status = before.status().within("edit");
    return outcome;
  }
  outcome.status = services_.journal->writable(id_);
  if (outcome.status.ok()) outcome.status = members_.admit(client.id, Clock::now());
  if (!outcome.status.ok()) return outcome;
  outcome.status = why;
  recordOutcome(client, outcome);
  return outcome;
}

EditOutcome Session::applyEdit(const ClientIdentity& client, const Edit& edit) {
  EditOutcome outcome;
  if (!admit(client, edit.sequence, &outcome)) return outcome;
  const Status locked = locks_.check(client.id, edit, Clock::now());
  document_.noteMeasured(delivery_.measured());
  const Expected<std::vector<std::string>> names =
      locked.ok() ? document_.apply(edit, blobs_) : Expected<std::vector<std::string>>(locked);
  outcome.status = names.status().within("edit");
  outcome.revision = document_.revision();
  if (names) {
    outcome.names = *names;
    history_.recordWrites(client.id, edit, *names, document_);
  }
  recordOutcome(client, outcome);
  return outcome;
}

/// Remembers the outcome, and gives the journal what the edit made of the session.
void Session::recordOutcome(const ClientIdentity& client, const EditOutcome& outcome) {
  members_.record(client.id, outcome);
  JournalStep step = nextStep();
  const bool remembered = !client.id.empty() && (outcome.sequence != 0 || outcome.status.ok());
  if (outcome.status.ok()) step.changes = document_.lastChange();
  if (remembered) {
    step.client = client.id;
    step.outcome = outcome;
  }
  if (remembered || outcome.status.ok()) journal(std::move(step));
}

JournalStep Session::nextStep() const {
  JournalStep step;
  step.changes.revision = document_.revision();
  return step;
}

void Session::journal(JournalStep step) { lastJournalled_ = services_.journal->append(id_, std::move(step)); }

void Session::whenDurable(std::function<void(const Status&)> done) const {
  Position position = 0;
  {
    const MutexLock lock(mutex_);
    position = lastJournalled_;
  }
  services_.journal->whenDurable(id_, position, std::move(done));
}

void Session::confirmWhenDurable(EditOutcome outcome, std::function<void(const EditOutcome&)> done) const {
  whenDurable([outcome = std::move(outcome), done = std::move(done)](const Status& durable) {
    if (durable.ok()) return done(outcome);
    EditOutcome unknown;
    unknown.sequence = outcome.sequence;
    unknown.revision = outcome.revision;
    unknown.status = durable;
    done(unknown);
  });
}

Status Session::changeSettings(const std::function<Expected<SessionSettings>(const SessionSettings&)>& change) {
  {
    const MutexLock lock(mutex_);
    if (closed_) return closedStatus("name");
    if (Status s = services_.journal->writable(id_); !s.ok()) return s;
    const std::uint64_t before = document_.revision();
    const Expected<SessionSettings> changed = change({document_.options(), policy_});
    if (!changed) return changed.status();
    if (Status s = document_.setOptions(changed->options); !s.ok()) return s;
    policy_ = changed->policy;
    JournalStep step = nextStep();
    if (document_.revision() != before) step.changes = document_.lastChange();
    step.settings = *changed;
    journal(std::move(step));
    lastUsed_ = std::chrono::system_clock::now();
  }
  delivery_.sceneChanged();
  tellWatchers();
  return {};
}

/// Counts an edit, an undo or a redo, and tells readers and watchers.
void Session::announce(const EditOutcome& outcome) {
  if (outcome.status.ok()) {
    ++services_.counters->editsAccepted;
    delivery_.sceneChanged();
    tellWatchers();
  } else {
    services_.counters->editsRejected.add(outcome.status);
  }
}

}  // namespace lpv
