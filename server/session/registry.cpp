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
  return invalid("session_id",
                 "session_id is \"" + shortened(id) + "\", allowed are 1 to 63 of a-z, 0-9 and '-', first a letter");
}

}  // namespace

Registry::Registry(const Workshop& workshop, std::chrono::seconds retain)
    : workshop_(workshop),
      retain_(retain),
      // Higher than any epoch of an earlier run on this machine: clients never mistake old results for new ones.
      epoch_(std::uint64_t(
          std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch())
              .count())) {
  sweepLater();
}

Registry::~Registry() {
  const std::lock_guard lock(life_->mutex);  // a sweep that has begun ends first
  life_->ended = true;
}

Status Registry::open() {
  const Expected<std::vector<KeptSession>> kept = workshop_.journal->kept();
  if (!kept) return kept.status();
  const std::lock_guard lock(mutex_);
  epoch_ = std::max(epoch_, workshop_.journal->highestEpoch() + 1);
  for (const KeptSession& session : *kept) {
    kept_[session.id] = session;
    if (!session.requestId.empty()) requests_[session.requestId] = {session.id, session.created};
  }
  return {};
}

Status Registry::checkRoom() const {
  if (std::ssize(sessions_) + std::ssize(moving_) < workshop_.limits.maxSessions) return {};
  return exhausted("max_sessions", "max_sessions: this server has " + std::to_string(sessions_.size()) +
                                       " sessions, allowed are " + std::to_string(workshop_.limits.maxSessions));
}

Status Registry::checkNew(const std::string& wantedId) const {
  if (draining_) return Status(Code::kUnavailable, "draining: this server takes no new sessions; ask another");
  if (!wantedId.empty()) {
    if (Status s = checkId(wantedId); !s.ok()) return s;
    if (sessions_.contains(wantedId) || kept_.contains(wantedId)) {
      return Status(Code::kAlreadyExists, "session \"" + wantedId + "\" exists; choose another id or leave it empty",
                    "session_id");
    }
  }
  if (Status s = workshop_.journal->writable(); !s.ok()) return s;
  return checkRoom();
}

Expected<SessionPtr> Registry::create(const std::string& wantedId, const SessionOptions& options,
                                      const SessionManners& manners, const std::string& requestId) {
  if (Status s = checkOptions(options); !s.ok()) return s.within("settings");
  const Expected<Grid> grid = gridFor(options, Bounds());
  if (!grid) return grid.status().within("settings.grid");
  const Prediction tick = workshop_.engine->predict(Workload(carriedOut(options), *grid));
  if (Status s = checkTickSeconds(tick, limits()); !s.ok()) return s;
  if (requestId.size() > kMaxRequestIdBytes) {
    return invalid("request_id", "request_id has " + std::to_string(requestId.size()) + " bytes, allowed are 128");
  }
  std::string first;
  {
    const std::lock_guard lock(mutex_);
    const auto repeated = requests_.find(requestId);
    const auto now = std::chrono::system_clock::now();
    if (!requestId.empty() && repeated != requests_.end() && now - repeated->second.when <= kRequestMemory) {
      const std::string& id = repeated->second.session;
      if (sessions_.contains(id) || kept_.contains(id)) first = id;
    }
    if (first.empty()) {
      if (Status s = checkNew(wantedId); !s.ok()) return s;
      const std::string id = wantedId.empty() ? std::string("s").append(randomHex(6)) : wantedId;
      return adopt(std::make_shared<Session>(id, nextKey_++, epoch_, options, manners, workshop_), requestId);
    }
  }
  return find(first);
}

Expected<SessionPtr> Registry::create(const std::string& wantedId, SavedSession state) {
  const std::lock_guard lock(mutex_);
  if (Status s = checkNew(wantedId); !s.ok()) return s;
  state.id = wantedId.empty() ? std::string("s").append(randomHex(6)) : wantedId;
  state.created = std::chrono::system_clock::now();
  state.clients.clear();
  const auto session = std::make_shared<Session>(nextKey_++, epoch_, state, workshop_);
  if (Status s = session->checkCost(); !s.ok()) return s;
  return adopt(session, {});
}

/// Takes a new session in and gives it to the journal. With the lock held.
SessionPtr Registry::adopt(const SessionPtr& session, const std::string& requestId) {
  const auto now = std::chrono::system_clock::now();
  sessions_[session->id()] = session;
  if (!requestId.empty()) requests_[requestId] = {session->id(), now};
  const std::chrono::seconds ttl = session->begin(requestId);
  if (session->durability() != Durability::kMemory) kept_[session->id()] = {session->id(), requestId, now, now, ttl};
  return session;
}

/// Until nobody brings the session back or removes it; other sessions' work goes on.
void Registry::waitForMove(std::unique_lock<std::mutex>& lock, const std::string& id) {
  if (!moving_.contains(id)) return;
  workshop_.pool->whileBlocked([&] { moved_.wait(lock, [&] { return !moving_.contains(id); }); });
}

Expected<SessionPtr> Registry::find(const std::string& id) {
  {
    std::unique_lock lock(mutex_);
    waitForMove(lock, id);
    if (const auto found = sessions_.find(id); found != sessions_.end()) {
      found->second->touch();
      return found->second;
    }
    if (!kept_.contains(id)) {
      return Status(Code::kNotFound,
                    "there is no session \"" + shortened(id) + "\" on this server; it may have expired", "session");
    }
    if (draining_) return Status(Code::kUnavailable, "draining: this server ends; ask another");
    if (Status s = checkRoom(); !s.ok()) return s;
    moving_.insert(id);
  }
  Expected<SessionPtr> session = SessionPtr();
  workshop_.pool->whileBlocked([&] { session = restore(id); });
  {
    const std::lock_guard lock(mutex_);
    moving_.erase(id);
    // Nobody would freeze it any more.
    if (session && draining_) session = Status(Code::kUnavailable, "draining: this server ends; ask another");
    if (session) (*session)->setLimits(workshop_.limits);  // they may have changed meanwhile
    if (session) sessions_[id] = *session;
  }
  moved_.notify_all();
  return session;
}

/// The epoch rises, and is kept before anybody sees it: result ids start again, and readers may have seen revisions
/// that were lost with the last process.
Expected<SessionPtr> Registry::restore(const std::string& id) {
  const Expected<SavedSession> state = workshop_.journal->load(id);
  if (!state) return state.status();
  SessionKey key = 0;
  std::uint64_t epoch = 0;
  Workshop workshop;
  {
    const std::lock_guard lock(mutex_);
    workshop = workshop_;
    key = nextKey_++;
    epoch = epoch_ = std::max(epoch_, state->epoch + 1);
  }
  (void)workshop_.journal->setEpoch(id, epoch);
  if (Status s = workshop_.journal->flush(); !s.ok()) return s;
  return std::make_shared<Session>(key, epoch, *state, workshop);
}

void Registry::remove(const std::string& id, std::function<void(const Status&)> done) {
  removeIf(
      id, [](const SessionPtr&) { return true; }, std::move(done));
}

void Registry::removeIf(const std::string& id, const std::function<bool(const SessionPtr&)>& over,
                        std::function<void(const Status&)> done) {
  if (Status s = workshop_.journal->writable(); !s.ok()) return done(s);
  SessionPtr session;
  Position gone = 0;
  {
    std::unique_lock lock(mutex_);
    waitForMove(lock, id);
    const auto found = sessions_.find(id);
    if (found == sessions_.end() && !kept_.contains(id)) {
      lock.unlock();
      return done(Status(Code::kNotFound, "there is no session \"" + id + "\"", "name"));
    }
    if (found != sessions_.end()) session = found->second;
    if (!over(session)) {
      lock.unlock();
      return done(Status(Code::kAborted, "session \"" + id + "\" is in use again", "name"));
    }
    if (session) sessions_.erase(found);
    moving_.insert(id);
    ++epoch_;  // a later session of the same id is another one for clients that still hold results
  }
  if (session) session->close(Closing::kDeleted);
  {
    // Behind everything that the session gave the journal, and before the id is free again.
    const std::lock_guard lock(mutex_);
    gone = workshop_.journal->remove(id);
    kept_.erase(id);
    moving_.erase(id);
    if (workshop_.access) workshop_.access->forget(id);
  }
  moved_.notify_all();
  workshop_.journal->whenKept(gone, std::move(done));
}

std::vector<SessionPtr> Registry::all() const {
  const std::lock_guard lock(mutex_);
  std::vector<SessionPtr> out;
  for (const auto& [id, session] : sessions_) out.push_back(session);
  return out;
}

std::size_t Registry::keptCount() const {
  const std::lock_guard lock(mutex_);
  return kept_.size();
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
    const std::lock_guard lock(mutex_);
    for (const auto& [id, session] : kept_) {
      if (!out.contains(id)) kept.push_back(id);
    }
  }
  for (const std::string& id : kept) {
    if (const Expected<SessionSummary> summary = workshop_.journal->summary(id)) out[id] = *summary;
  }
  std::vector<SessionSummary> list;
  for (auto& [id, summary] : out) list.push_back(std::move(summary));
  return list;
}

Limits Registry::limits() const {
  const std::lock_guard lock(mutex_);
  return workshop_.limits;
}

void Registry::setLimits(const Limits& limits) {
  const std::lock_guard lock(mutex_);
  workshop_.limits = limits;
  for (const auto& [id, session] : sessions_) session->setLimits(limits);
}

Status Registry::freeze() {
  {
    const std::lock_guard lock(mutex_);
    draining_ = true;
  }
  for (const SessionPtr& session : all()) session->freeze(Closing::kDraining);
  return workshop_.journal->flush();
}

void Registry::drain() {
  (void)freeze();
  for (const SessionPtr& session : all()) session->close(Closing::kDraining);
}

void Registry::sweepLater() {
  workshop_.timers->at(Clock::now() + kSweepInterval, [this, life = life_] {
    const std::lock_guard lock(life->mutex);
    if (life->ended) return;
    sweep();
    workshop_.counters->lastSweep = Clock::now();
    sweepLater();
  });
}

void Registry::sweep() {
  const auto now = std::chrono::system_clock::now();
  for (const SessionPtr& session : all()) {
    session->dropUnusedBlobs();
    session->dropSilentMembers(Clock::now());
  }
  retire(now);
  forgetKept(now);
  const std::lock_guard lock(mutex_);
  std::erase_if(requests_, [now](const auto& entry) { return now - entry.second.when > kRequestMemory; });
}

void Registry::retire(std::chrono::system_clock::time_point now) {
  std::vector<std::string> putAway;
  for (const SessionPtr& session : all()) {
    const std::string& id = session->id();
    if (session->durability() == Durability::kMemory) {
      if (session->expired(now)) {
        endUnused(id, Incident::kExpired, [now](const SessionPtr& it) { return it && it->expired(now); });
      }
      continue;
    }
    const std::lock_guard lock(mutex_);  // nobody finds the session while it is decided whether it goes
    auto used = session->useToKeep(now);
    if (const auto last = session->retire(now)) {
      used = last;
      sessions_.erase(id);
      putAway.push_back(id);
    }
    const auto kept = kept_.find(id);
    if (!used || kept == kept_.end()) continue;
    kept->second.lastUsed = *used;
    kept->second.ttl = session->summary().ttl;
    (void)workshop_.journal->touch(id, *used);
  }
  for (const std::string& id : putAway) tell(Incident::kPutAway, id);
}

void Registry::tell(Incident incident, const std::string& id) const {
  if (workshop_.tell) workshop_.tell(incident, id, {});
}

/// Unless somebody uses it again. What is told is told when it is gone.
void Registry::endUnused(const std::string& id, Incident incident, const std::function<bool(const SessionPtr&)>& over) {
  removeIf(id, over, [tell = workshop_.tell, incident, id](const Status& gone) {
    if (gone.ok() && tell) tell(incident, id, {});
  });
}

void Registry::forgetKept(std::chrono::system_clock::time_point now) {
  if (!workshop_.journal->writable().ok()) return;
  const auto overdue = [this, now](const KeptSession& kept) {
    return kept.ttl.count() > 0 && now - kept.lastUsed > kept.ttl + retain_;
  };
  std::vector<std::string> over;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, kept] : kept_) {
      if (!sessions_.contains(id) && !moving_.contains(id) && overdue(kept)) over.push_back(id);
    }
  }
  for (const std::string& id : over) {
    endUnused(id, Incident::kForgotten,
              [&](const SessionPtr& session) { return session == nullptr && overdue(kept_.at(id)); });
  }
}

}  // namespace lpv
