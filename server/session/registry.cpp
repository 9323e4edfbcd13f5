#include "session/registry.h"

#include <algorithm>

#include "base/text.h"
#include "scene/error_goal.h"
#include "session/access.h"

namespace lpv {
namespace {

constexpr std::chrono::seconds kSweepInterval{1};
constexpr std::chrono::hours kRequestMemory{1};
constexpr std::size_t kMaxRequestIdBytes = 128;

Status checkId(const std::string& id) {
  const auto plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; };
  if (id.size() <= 63 && std::all_of(id.begin(), id.end(), plain) && id[0] >= 'a' && id[0] <= 'z') return {};
  return invalid("session_id", "session_id is \"" + truncatedUtf8(id) +
                                   "\", allowed are 1 to 63 of a-z, 0-9 and '-', first a letter");
}

}  // namespace

Registry::Registry(const SessionServices& services, std::chrono::seconds retain)
    : services_(services),
      retain_(retain),
      limits_(services.limits),
      // Higher than any epoch of an earlier run on this machine: clients never mistake old results for new ones.
      epoch_(std::uint64_t(
          std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch())
              .count())) {
  sweepLater();
}

Registry::~Registry() {
  const MutexLock lock(life_->mutex);  // a sweep that has begun ends first
  life_->ended = true;
}

Status Registry::open() {
  const Expected<std::vector<SessionHead>> kept = services_.journal->heads();
  if (!kept) return kept.status();
  const MutexLock lock(mutex_);
  epoch_ = std::max(epoch_, services_.journal->highestEpoch() + 1);
  for (const SessionHead& session : *kept) {
    durableSessions_[session.id] = session;
    if (!session.requestId.empty()) requests_[session.requestId] = {session.id, session.created};
  }
  return {};
}

SessionServices Registry::servicesNow() const {
  SessionServices out = services_;
  out.limits = limits_;
  return out;
}

Status Registry::checkRoom() const {
  if (std::ssize(sessions_) + std::ssize(inTransition_) < limits_.maxSessions) return {};
  return exhausted(Reason::kMaxSessions, "max_sessions",
                   "max_sessions: this server has " + std::to_string(sessions_.size()) + " sessions, allowed are " +
                       std::to_string(limits_.maxSessions));
}

Status Registry::checkNew(const std::string& wantedId) const {
  if (draining_)
    return Status(Code::kUnavailable, Reason::kDraining, "draining: this server takes no new sessions; ask another");
  if (!wantedId.empty()) {
    if (Status s = checkId(wantedId); !s.ok()) return s;
    if (sessions_.contains(wantedId) || durableSessions_.contains(wantedId)) {
      return Status(Code::kAlreadyExists, Reason::kNameTaken,
                    "session \"" + wantedId + "\" exists; choose another id or leave it empty", "session_id");
    }
  }
  if (Status s = services_.journal->available(); !s.ok()) return s;
  return checkRoom();
}

Expected<SessionPtr> Registry::create(const std::string& wantedId, const LightingSettings& options,
                                      const SessionPolicy& policy, const std::string& requestId) {
  if (Status s = checkOptions(options); !s.ok()) return s.within("settings");
  const Expected<Grid> grid = gridFor(options, Bounds());
  if (!grid) return grid.status().within("settings.grid");
  const Prediction tick = services_.engine->predict(Workload(resolved(options), *grid));
  if (Status s = checkTickSeconds(tick, limits()); !s.ok()) return s;
  if (requestId.size() > kMaxRequestIdBytes) {
    return invalid("request_id", "request_id has " + std::to_string(requestId.size()) + " bytes, allowed are 128");
  }
  std::string first;
  {
    const MutexLock lock(mutex_);
    const auto repeated = requests_.find(requestId);
    const auto now = std::chrono::system_clock::now();
    if (!requestId.empty() && repeated != requests_.end() && now - repeated->second.when <= kRequestMemory) {
      const std::string& id = repeated->second.session;
      if (sessions_.contains(id) || durableSessions_.contains(id)) first = id;
    }
    if (first.empty()) {
      if (Status s = checkNew(wantedId); !s.ok()) return s;
      const std::string id = wantedId.empty() ? std::string("s").append(randomHex(6)) : wantedId;
      return registerNew(std::make_shared<Session>(id, nextKey_++, epoch_, options, policy, servicesNow()), requestId);
    }
  }
  return find(first);
}

Expected<SessionPtr> Registry::create(const std::string& wantedId, SavedSession state) {
  const MutexLock lock(mutex_);
  if (Status s = checkNew(wantedId); !s.ok()) return s;
  state.id = wantedId.empty() ? std::string("s").append(randomHex(6)) : wantedId;
  state.created = std::chrono::system_clock::now();
  state.clients.clear();
  const auto session = std::make_shared<Session>(nextKey_++, epoch_, state, servicesNow());
  if (Status s = session->checkCost(); !s.ok()) return s;
  return registerNew(session, {});
}

/// Takes a new session in and gives it to the journal.
SessionPtr Registry::registerNew(const SessionPtr& session, const std::string& requestId) {
  const auto now = std::chrono::system_clock::now();
  sessions_[session->id()] = session;
  if (!requestId.empty()) requests_[requestId] = {session->id(), now};
  const std::chrono::seconds ttl = session->journalCreation(requestId);
  if (session->durability() != Durability::kMemory)
    durableSessions_[session->id()] = {session->id(), epoch_, requestId, now, now, ttl};
  return session;
}

/// Until nobody brings the session back or removes it; other sessions' work goes on.
void Registry::waitForMove(MutexLock& lock, const std::string& id) {
  if (!inTransition_.contains(id)) return;
  services_.pool->blockingSection([&] {
    mutex_.assertHeld();
    while (inTransition_.contains(id)) transitionDone_.wait(lock);
  });
}

Expected<SessionPtr> Registry::find(const std::string& id) {
  {
    MutexLock lock(mutex_);
    waitForMove(lock, id);
    if (const auto found = sessions_.find(id); found != sessions_.end()) {
      found->second->touch();
      return found->second;
    }
    if (!durableSessions_.contains(id)) {
      return Status(Code::kNotFound,
                    "there is no session \"" + truncatedUtf8(id) + "\" on this server; it may have expired", "session");
    }
    if (draining_) return Status(Code::kUnavailable, Reason::kDraining, "draining: this server ends; ask another");
    if (Status s = checkRoom(); !s.ok()) return s;
    inTransition_.insert(id);
  }
  Expected<SessionPtr> session = SessionPtr();
  services_.pool->blockingSection([&] { session = restore(id); });
  {
    const MutexLock lock(mutex_);
    inTransition_.erase(id);
    // The server drains: nothing would drain this session any more.
    if (session && draining_)
      session = Status(Code::kUnavailable, Reason::kDraining, "draining: this server ends; ask another");
    if (session) (*session)->setLimits(limits_);  // they may have changed meanwhile
    if (session) sessions_[id] = *session;
  }
  transitionDone_.notifyAll();
  return session;
}

/// The epoch rises, and is kept before anybody sees it: result ids start again, and readers may have seen revisions
/// that were lost with the last process.
Expected<SessionPtr> Registry::restore(const std::string& id) {
  const Expected<SavedSession> state = services_.journal->load(id);
  noteRead(services_, id, state.status());
  if (!state) return state.status();
  SessionKey key = 0;
  std::uint64_t epoch = 0;
  SessionServices services;
  {
    const MutexLock lock(mutex_);
    services = servicesNow();
    key = nextKey_++;
    epoch = epoch_ = std::max(epoch_, state->epoch + 1);
  }
  (void)services_.journal->setEpoch(id, epoch);
  if (Status s = services_.journal->flush(); !s.ok()) return s;
  return std::make_shared<Session>(key, epoch, *state, services);
}

void Registry::remove(const std::string& id, std::function<void(const Status&)> done) {
  removeIf(
      id, [](const SessionPtr&) { return true; }, std::move(done));
}

void Registry::removeIf(const std::string& id, const std::function<bool(const SessionPtr&)>& over,
                        std::function<void(const Status&)> done) {
  if (Status s = services_.journal->writable(id); !s.ok()) return done(s);
  SessionPtr session;
  Position gone = 0;
  {
    MutexLock lock(mutex_);
    waitForMove(lock, id);
    const auto found = sessions_.find(id);
    if (found == sessions_.end() && !durableSessions_.contains(id)) {
      lock.unlock();
      return done(Status(Code::kNotFound, "there is no session \"" + id + "\"", "name"));
    }
    if (found != sessions_.end()) session = found->second;
    if (!over(session)) {
      lock.unlock();
      return done(Status(Code::kAborted, "session \"" + id + "\" is in use again", "name"));
    }
    if (session) sessions_.erase(found);
    inTransition_.insert(id);
    ++epoch_;  // a later session of the same id is another one for clients that still hold results
  }
  if (session) session->close(Closing::kDeleted);
  {
    // Behind everything that the session gave the journal, and before the id is free again.
    const MutexLock lock(mutex_);
    gone = services_.journal->remove(id);
    durableSessions_.erase(id);
    inTransition_.erase(id);
    services_.damaged->forget(id);
    if (services_.access) services_.access->forget(id);
  }
  transitionDone_.notifyAll();
  services_.journal->whenDurable(id, gone, std::move(done));
}

std::vector<SessionPtr> Registry::all() const {
  const MutexLock lock(mutex_);
  std::vector<SessionPtr> out;
  for (const auto& [id, session] : sessions_) out.push_back(session);
  return out;
}

std::size_t Registry::keptCount() const {
  const MutexLock lock(mutex_);
  return durableSessions_.size();
}

SessionTotals Registry::totals() const {
  SessionTotals out;
  for (const SessionPtr& session : all()) {
    const SessionSummary summary = session->summary();
    ++out.sessions;
    out.clients += summary.clients;
    out.subscribers += summary.subscribers;
    out.blobs += summary.blobs;
    out.blobBytes += summary.blobBytes;
    if (summary.measured) {
      out.worstMeasuredError = std::max(out.worstMeasuredError.value_or(0.0), summary.measured->error);
    }
  }
  return out;
}

std::vector<SessionSummary> Registry::summaries() {
  std::map<std::string, SessionSummary> out;
  std::vector<std::string> kept;
  for (const SessionPtr& session : all()) out[session->id()] = session->summary();
  {
    const MutexLock lock(mutex_);
    for (const auto& [id, session] : durableSessions_) {
      if (!out.contains(id)) kept.push_back(id);
    }
  }
  for (const std::string& id : kept) {
    if (const Expected<SessionSummary> summary = services_.journal->summary(id)) out[id] = *summary;
  }
  std::vector<SessionSummary> list;
  for (auto& [id, summary] : out) list.push_back(std::move(summary));
  return list;
}

Limits Registry::limits() const {
  const MutexLock lock(mutex_);
  return limits_;
}

void Registry::setLimits(const Limits& limits) {
  const MutexLock lock(mutex_);
  limits_ = limits;
  for (const auto& [id, session] : sessions_) session->setLimits(limits);
}

Status Registry::quiesce() {
  {
    const MutexLock lock(mutex_);
    draining_ = true;
  }
  for (const SessionPtr& session : all()) session->quiesce(Closing::kDraining);
  return services_.journal->flush();
}

void Registry::drain() {
  (void)quiesce();
  for (const SessionPtr& session : all()) session->close(Closing::kDraining);
}

void Registry::sweepLater() {
  services_.timers->at(Clock::now() + kSweepInterval, [this, life = life_] {
    const MutexLock lock(life->mutex);
    if (life->ended) return;
    sweep();
    services_.counters->lastSweep = Clock::now();
    sweepLater();
  });
}

void Registry::sweep() {
  const auto now = std::chrono::system_clock::now();
  for (const SessionPtr& session : all()) {
    session->dropUnusedBlobs();
    session->dropSilentMembers(Clock::now());
  }
  evictExpired(now);
  forgetKept(now);
  const MutexLock lock(mutex_);
  std::erase_if(requests_, [now](const auto& entry) { return now - entry.second.when > kRequestMemory; });
}

void Registry::evictExpired(std::chrono::system_clock::time_point now) {
  std::vector<std::string> evicted;
  for (const SessionPtr& session : all()) {
    const std::string& id = session->id();
    if (session->durability() == Durability::kMemory) {
      if (session->expired(now)) {
        removeIfUnused(id, SessionEvent::kExpired, [now](const SessionPtr& it) { return it && it->expired(now); });
      }
      continue;
    }
    const MutexLock lock(mutex_);  // nobody finds the session while it is decided whether it goes
    auto used = session->useToKeep(now);
    if (const auto last = session->evict(now)) {
      used = last;
      sessions_.erase(id);
      evicted.push_back(id);
    }
    const auto kept = durableSessions_.find(id);
    if (!used || kept == durableSessions_.end()) continue;
    kept->second.lastUsed = *used;
    kept->second.ttl = session->summary().ttl;
    (void)services_.journal->touch(id, *used);
  }
  for (const std::string& id : evicted) report(SessionEvent::kEvicted, id);
}

void Registry::report(SessionEvent incident, const std::string& id) const {
  if (services_.onEvent) services_.onEvent(incident, id, {});
}

/// Removes the session unless it is in use again; reports the event after removal.
void Registry::removeIfUnused(const std::string& id, SessionEvent incident,
                              const std::function<bool(const SessionPtr&)>& over) {
  removeIf(id, over, [tell = services_.onEvent, incident, id](const Status& gone) {
    if (gone.ok() && tell) tell(incident, id, {});
  });
}

void Registry::forgetKept(std::chrono::system_clock::time_point now) {
  if (!services_.journal->available().ok()) return;
  const auto overdue = [this, now](const SessionHead& kept) {
    return kept.ttl.count() > 0 && now - kept.lastUsed > kept.ttl + retain_;
  };
  std::vector<std::string> over;
  {
    const MutexLock lock(mutex_);
    for (const auto& [id, kept] : durableSessions_) {
      if (!sessions_.contains(id) && !inTransition_.contains(id) && overdue(kept)) over.push_back(id);
    }
  }
  for (const std::string& id : over) {
    removeIfUnused(id, SessionEvent::kRetentionEnded, [&](const SessionPtr& session) {
      mutex_.assertHeld();
      return session == nullptr && overdue(durableSessions_.at(id));
    });
  }
}

}  // namespace lpv
