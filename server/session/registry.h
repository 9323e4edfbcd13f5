#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "session/session.h"

namespace lpv {

/// All sessions of this server. Thread-safe.
class Registry {
 public:
  explicit Registry(const Workshop& workshop);
  ~Registry();

  /// A new session. `wantedId` may be empty. Repeating `requestId` within an hour returns the first session.
  /// ALREADY_EXISTS, RESOURCE_EXHAUSTED (max_sessions), UNAVAILABLE while draining, or what is wrong with the options.
  Expected<SessionPtr> create(const std::string& wantedId, const SessionOptions& options, const SessionManners& manners,
                              const std::string& requestId);
  /// NOT_FOUND where there is none. Counts as use.
  Expected<SessionPtr> find(const std::string& id);
  Status remove(const std::string& id);
  /// In order of id.
  std::vector<SessionPtr> all() const;

  /// Refuses new sessions and ends every stream with a notice.
  void drain();

 private:
  Status checkNew(const std::string& wantedId) const;
  void sweep();
  void sweepLater();

  const Workshop workshop_;
  mutable std::mutex mutex_;
  std::map<std::string, SessionPtr> sessions_;
  struct Requested {
    std::string session;
    std::chrono::steady_clock::time_point when;
  };
  std::map<std::string, Requested> requests_;
  SessionKey nextKey_ = 1;
  std::uint64_t epoch_ = 1;
  bool draining_ = false;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace lpv
