// Members: who comes and goes, how the others see them, what they lock, what they take back and make again.

#include <algorithm>
#include <utility>

#include "base/text.h"
#include "session/session.h"

namespace lpv {

Expected<ClientIdentity> Session::join(const PresenceUpdate& seenAs) {
  const Expected<ClientIdentity> client = addMember(seenAs);
  if (client) tellWatchers();
  return client;
}

Expected<ClientIdentity> Session::addMember(const PresenceUpdate& seenAs) {
  if (Status s = checkPresence(seenAs); !s.ok()) return s;
  std::set<std::string> connected = delivery_.clients();
  const MutexLock lock(mutex_);
  if (closed_) return closedStatus("session");
  if (Status s = services_.journal->writable(id_); !s.ok()) return s;
  if (members_.full()) {
    connected.merge(watching());
    removeMember(members_.silent(connected, Clock::now()));
  }
  Expected<ClientIdentity> client = members_.join();
  if (!client) return client;
  presence_.join(client->id, seenAs, Clock::now());
  JournalStep step = nextStep();
  step.joined = members_.state(client->id);
  journal(std::move(step));
  return client;
}

void Session::leave(const ClientIdentity& client) {
  {
    const MutexLock lock(mutex_);
    if (closed_ || !members_.verify(client).ok()) return;
    removeMember(client.id);
  }
  tellWatchers();
}

/// No-op for an empty id.
void Session::removeMember(const std::string& client) {
  if (client.empty()) return;
  members_.leave(client);
  history_.leave(client);
  presence_.leave(client);
  locks_.release(client, {});
  JournalStep step = nextStep();
  step.left = client;
  journal(std::move(step));
}

/// Members that watch the scene.
std::set<std::string> Session::watching() const {
  std::set<std::string> out;
  for (const auto& [key, watcher] : watchers_) out.insert(watcher.client);
  return out;
}

void Session::markActive(const std::string& client) {
  const Clock::time_point now = Clock::now();
  members_.markActive(client, now);
  presence_.markActive(client, now);
}

EditOutcome Session::undoRedo(const ClientIdentity& client, std::uint64_t sequence, UndoDirection direction) {
  EditOutcome outcome;
  {
    const MutexLock lock(mutex_);
    outcome = applyUndoRedo(client, sequence, direction);
  }
  announce(outcome);
  return outcome;
}

EditOutcome Session::applyUndoRedo(const ClientIdentity& client, std::uint64_t sequence, UndoDirection direction) {
  EditOutcome outcome;
  if (!admit(client, sequence, &outcome)) return outcome;
  if (client.id.empty()) {
    outcome.status = invalid("client",
                             "client is not set: steps belong to members; call JoinSession, and send its "
                             "identity with edits, undo and redo");
    return outcome;
  }
  Expected<History::Plan> plan = history_.plan(client.id, direction, document_);
  outcome.status = plan.status();
  for (std::size_t i = 0; outcome.status.ok() && i < plan->objects.size(); ++i) {
    const ObjectKey& key = plan->objects[i].first;
    if (!key.camera) outcome.status = locks_.check(client.id, key.name, Clock::now());
  }
  if (outcome.status.ok()) outcome.status = document_.restore(plan->objects, plan->grid);
  outcome.revision = document_.revision();
  if (outcome.status.ok()) {
    const auto most = std::size_t(limits_.maxOperationsPerEdit);  // a step of many edits may be of any size
    for (const auto& [key, object] : plan->objects) {
      if (outcome.names.size() < most) outcome.names.push_back(key.name);
    }
    outcome.skipped = plan->skipped;
    outcome.skipped.resize(std::min(outcome.skipped.size(), most));
    history_.done(client.id, direction, std::move(*plan), document_);
  }
  recordOutcome(client, outcome);
  return outcome;
}

/// False where the outcome is known already: an edit that is not applied.
bool Session::admit(const ClientIdentity& client, std::uint64_t sequence, EditOutcome* outcome) {
  lastUsed_ = std::chrono::system_clock::now();
  outcome->sequence = sequence;
  outcome->revision = document_.revision();
  outcome->status = closed_ ? closedStatus("session") : members_.verify(client);
  if (!outcome->status.ok()) return false;
  const Expected<std::optional<EditOutcome>> before = members_.repeated(client.id, sequence);
  if (!before) {
    outcome->status = before.status().within("edit");
    return false;
  }
  if (*before) {
    *outcome = **before;
    return false;
  }
  outcome->status = services_.journal->writable(id_);
  if (outcome->status.ok()) outcome->status = members_.admit(client.id, Clock::now());
  markActive(client.id);
  return outcome->status.ok();
}

Status Session::present(const ClientIdentity& client, const PresenceUpdate& update) {
  {
    const MutexLock lock(mutex_);
    if (closed_) return closedStatus("session");
    if (client.id.empty()) {
      return invalid("client", "client is not set: only members are seen; call JoinSession and send its identity");
    }
    if (Status s = members_.verify(client); !s.ok()) return s;
    if (Status s = checkPresence(update); !s.ok()) return s.within("presence");
    lastUsed_ = std::chrono::system_clock::now();
    markActive(client.id);
    if (Status s = presence_.update(client.id, update, Clock::now()); !s.ok()) return s;
  }
  tellWatchers();
  return {};
}

std::uint64_t Session::presenceChanges() const {
  const MutexLock lock(mutex_);
  return presence_.changes();
}

PresenceSnapshot Session::presenceSnapshot() const {
  const MutexLock lock(mutex_);
  return presence_.members();
}

Status Session::lockObjects(const ClientIdentity& client, const std::vector<std::string>& names,
                            std::chrono::seconds time) {
  {
    const MutexLock lock(mutex_);
    if (closed_) return closedStatus("session");
    if (client.id.empty()) {
      return invalid("client", "client is not set: only members lock; call JoinSession and send its identity");
    }
    if (Status s = members_.verify(client); !s.ok()) return s;
    if (Status s = lockNamed(client.id, names, time); !s.ok()) return s;
    lastUsed_ = std::chrono::system_clock::now();
    markActive(client.id);
    presence_.setLocked(client.id, locks_.heldBy(client.id));
  }
  tellWatchers();
  return {};
}

Status Session::lockNamed(const std::string& client, const std::vector<std::string>& names, std::chrono::seconds time) {
  if (time.count() < 0 || time > kMaxLockTime) {
    return invalid("ttl", "ttl is " + std::to_string(time.count()) + " s, allowed are 1 to " +
                              std::to_string(kMaxLockTime.count()) + ", and 0 to release");
  }
  if (time.count() == 0) {
    locks_.release(client, names);
    return {};
  }
  if (names.empty()) return invalid("objects", "objects is empty; say what shall be locked");
  for (const std::string& name : names) {
    if (document_.object({false, name}).stands()) continue;
    return Status(Code::kNotFound, "there is no light or surface \"" + truncatedUtf8(name) + "\" in this session",
                  "objects");
  }
  return locks_.lock(client, names, time, Clock::now());
}

void Session::dropSilentMembers(Clock::time_point now) {
  {
    const MutexLock lock(mutex_);
    const std::uint64_t before = presence_.changes();
    presence_.dropSilent(watching(), now);
    for (const std::string& client : locks_.expire(now)) presence_.setLocked(client, locks_.heldBy(client));
    if (presence_.changes() == before) return;
  }
  tellWatchers();
}

}  // namespace lpv
