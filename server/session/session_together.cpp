// Members: who comes and goes, what they take back and make again, how the others see them.

#include <utility>

#include "session/session.h"

namespace lpv {

Expected<ClientIdentity> Session::join(const PresenceUpdate& seenAs) {
  const Expected<ClientIdentity> client = addMember(seenAs);
  if (client) tellWatchers();
  return client;
}

Expected<ClientIdentity> Session::addMember(const PresenceUpdate& seenAs) {
  if (Status s = checkPresence(seenAs); !s.ok()) return s;
  const std::lock_guard lock(mutex_);
  if (closed_) return closedStatus("session");
  if (Status s = workshop_.journal->writable(); !s.ok()) return s;
  Expected<ClientIdentity> client = clients_.join();
  if (!client) return client;
  presence_.join(client->id, seenAs, Clock::now());
  JournalStep step = nextStep();
  step.joined = clients_.state(client->id);
  keep(std::move(step));
  return client;
}

void Session::leave(const ClientIdentity& client) {
  {
    const std::lock_guard lock(mutex_);
    if (closed_ || client.id.empty() || !clients_.verify(client).ok()) return;
    clients_.leave(client.id);
    history_.leave(client.id);
    presence_.leave(client.id);
    JournalStep step = nextStep();
    step.left = client.id;
    keep(std::move(step));
  }
  tellWatchers();
}

EditOutcome Session::takeStep(const ClientIdentity& client, std::uint64_t sequence, Direction direction) {
  EditOutcome outcome;
  {
    const std::lock_guard lock(mutex_);
    outcome = takeStepLocked(client, sequence, direction);
  }
  if (outcome.status.ok()) {
    ++workshop_.counters->editsAccepted;
    tellWatchers();
  } else {
    workshop_.counters->editsRejected.add(outcome.status);
  }
  return outcome;
}

EditOutcome Session::takeStepLocked(const ClientIdentity& client, std::uint64_t sequence, Direction direction) {
  EditOutcome outcome;
  if (!admit(client, sequence, &outcome)) return outcome;
  if (client.id.empty()) {
    outcome.status = invalid("client",
                             "client is not set: steps belong to members; call JoinSession, and send its "
                             "identity with edits, undo and redo");
    return outcome;
  }
  Expected<History::Plan> plan = history_.plan(client.id, direction, document_);
  outcome.status = plan ? document_.restore(plan->objects) : plan.status();
  outcome.revision = document_.revision();
  if (outcome.status.ok()) {
    for (const auto& [key, object] : plan->objects) outcome.names.push_back(key.name);
    outcome.skipped = plan->skipped;
    history_.done(client.id, direction, std::move(*plan));
  }
  record(client, outcome);
  if (outcome.status.ok()) kick();
  return outcome;
}

/// False where the outcome is known already: an edit that is not applied.
bool Session::admit(const ClientIdentity& client, std::uint64_t sequence, EditOutcome* outcome) {
  lastUsed_ = std::chrono::system_clock::now();
  outcome->sequence = sequence;
  outcome->revision = document_.revision();
  outcome->status = closed_ ? closedStatus("session") : clients_.verify(client);
  if (!outcome->status.ok()) return false;
  const Expected<std::optional<EditOutcome>> before = clients_.repeated(client.id, sequence);
  if (!before) {
    outcome->status = before.status().within("edit");
    return false;
  }
  if (*before) {
    *outcome = **before;
    return false;
  }
  outcome->status = workshop_.journal->writable();
  if (outcome->status.ok()) outcome->status = clients_.admit(client.id, Clock::now());
  presence_.hear(client.id, Clock::now());
  return outcome->status.ok();
}

Status Session::present(const ClientIdentity& client, const PresenceUpdate& update) {
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return closedStatus("session");
    if (client.id.empty()) {
      return invalid("client", "client is not set: only members are seen; call JoinSession and send its identity");
    }
    if (Status s = clients_.verify(client); !s.ok()) return s;
    if (Status s = checkPresence(update); !s.ok()) return s.within("presence");
    lastUsed_ = std::chrono::system_clock::now();
    if (Status s = presence_.update(client.id, update, Clock::now()); !s.ok()) return s;
  }
  tellWatchers();
  return {};
}

std::uint64_t Session::presenceChanges() const {
  const std::lock_guard lock(mutex_);
  return presence_.changes();
}

PresentMembers Session::presentMembers() const {
  const std::lock_guard lock(mutex_);
  return presence_.members();
}

void Session::dropSilentMembers(Clock::time_point now) {
  {
    const std::lock_guard lock(mutex_);
    std::set<std::string> connected;
    for (const auto& [key, watcher] : watchers_) connected.insert(watcher.client);
    if (!presence_.dropSilent(connected, now)) return;
  }
  tellWatchers();
}

}  // namespace lpv
