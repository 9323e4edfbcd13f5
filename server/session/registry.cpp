#include "session/registry.h"

#include <algorithm>

namespace lpv {
namespace {

constexpr std::chrono::seconds kSweepInterval{1};
constexpr std::chrono::hours kRequestMemory{1};
constexpr std::size_t kMaxRequestIdBytes = 128;

Status checkId(const std::string& id) {
  const auto plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; };
  if (id.size() <= 63 && std::all_of(id.begin(), id.end(), plain) && id[0] >= 'a' && id[0] <= 'z') return {};
  return invalid("session_id",
                 "session_id is \"" + id.substr(0, 80) + "\", allowed are 1 to 63 of a-z, 0-9 and '-', first a letter");
}

}  // namespace

Registry::Registry(const Workshop& workshop)
    : workshop_(workshop),
      // Higher than any epoch of an earlier run on this machine: clients never mistake old results for new ones.
      epoch_(std::uint64_t(
          std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch())
              .count())) {
  sweepLater();
}

Registry::~Registry() {
  const std::lock_guard lock(mutex_);
  *alive_ = false;
}

Status Registry::checkNew(const std::string& wantedId) const {
  if (draining_) return Status(Code::kUnavailable, "draining: this server takes no new sessions; ask another");
  if (!wantedId.empty()) {
    if (Status s = checkId(wantedId); !s.ok()) return s;
    if (sessions_.contains(wantedId)) {
      return Status(Code::kAlreadyExists, "session \"" + wantedId + "\" exists; choose another id or leave it empty",
                    "session_id");
    }
  }
  if (std::ssize(sessions_) < workshop_.limits.maxSessions) return {};
  return exhausted("max_sessions", "max_sessions: this server has " + std::to_string(sessions_.size()) +
                                       " sessions, allowed are " + std::to_string(workshop_.limits.maxSessions));
}

Expected<SessionPtr> Registry::create(const std::string& wantedId, const SessionOptions& options,
                                      const SessionManners& manners, const std::string& requestId) {
  if (Status s = checkOptions(options); !s.ok()) return s.within("settings");
  if (const Expected<Grid> grid = gridFor(options, Bounds()); !grid) return grid.status().within("settings.grid");
  if (requestId.size() > kMaxRequestIdBytes) {
    return invalid("request_id", "request_id has " + std::to_string(requestId.size()) + " bytes, allowed are 128");
  }
  const std::lock_guard lock(mutex_);
  if (const auto repeated = requests_.find(requestId); !requestId.empty() && repeated != requests_.end()) {
    if (const auto found = sessions_.find(repeated->second.session); found != sessions_.end()) return found->second;
  }
  if (Status s = checkNew(wantedId); !s.ok()) return s;
  const std::string id = wantedId.empty() ? std::string("s").append(randomHex(6)) : wantedId;
  auto session = std::make_shared<Session>(id, nextKey_++, epoch_, options, manners, workshop_);
  sessions_[id] = session;
  if (!requestId.empty()) requests_[requestId] = {id, Clock::now()};
  return session;
}

Expected<SessionPtr> Registry::find(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  if (found != sessions_.end()) {
    found->second->touch();
    return found->second;
  }
  return Status(Code::kNotFound, "there is no session \"" + id.substr(0, 80) + "\" on this server; it may have expired",
                "session");
}

Status Registry::remove(const std::string& id) {
  SessionPtr session;
  {
    const std::lock_guard lock(mutex_);
    const auto found = sessions_.find(id);
    if (found == sessions_.end()) return Status(Code::kNotFound, "there is no session \"" + id + "\"", "name");
    session = found->second;
    sessions_.erase(found);
    ++epoch_;  // a later session of the same id is another one for clients that still hold results
  }
  session->close(Closing::kDeleted);
  return {};
}

std::vector<SessionPtr> Registry::all() const {
  const std::lock_guard lock(mutex_);
  std::vector<SessionPtr> out;
  for (const auto& [id, session] : sessions_) out.push_back(session);
  return out;
}

void Registry::drain() {
  {
    const std::lock_guard lock(mutex_);
    draining_ = true;
  }
  for (const SessionPtr& session : all()) session->close(Closing::kDraining);
}

void Registry::sweepLater() {
  workshop_.timers->at(Clock::now() + kSweepInterval, [this, alive = std::weak_ptr<bool>(alive_)] {
    if (!alive.expired()) sweep();
  });
}

/// Once a second: expired sessions go, unused blobs go, old request ids are forgotten.
void Registry::sweep() {
  const auto now = std::chrono::system_clock::now();
  for (const SessionPtr& session : all()) {
    session->dropUnusedBlobs();
    if (session->expired(now)) (void)remove(session->id()).ok();
  }
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(requests_, [](const auto& entry) { return Clock::now() - entry.second.when > kRequestMemory; });
  }
  sweepLater();
}

}  // namespace lpv
