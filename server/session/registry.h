#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "session/session.h"

namespace lpv {

/// Of the sessions in memory, all together.
struct SessionTotals {
  std::size_t sessions = 0;
  std::size_t clients = 0;
  std::size_t subscribers = 0;
  std::size_t blobs = 0;
  std::int64_t blobBytes = 0;
  std::optional<double> worstMeasuredError;  ///< unset where none was measured
};

/// All sessions of this server: those in memory, and those that are kept by the journal alone until somebody asks for
/// them. Thread-safe.
class Registry {
 public:
  /// Kept sessions go `retain` after they have expired.
  explicit Registry(const SessionServices& services, std::chrono::seconds retain = std::chrono::hours(24 * 30));
  ~Registry();

  /// Learns which sessions are kept. Once, before the first call; or why they cannot be read.
  Status open();

  /// A new session. `wantedId` may be empty. Repeating `requestId` within an hour returns the first session.
  /// ALREADY_EXISTS, RESOURCE_EXHAUSTED (max_sessions), UNAVAILABLE while draining, or what is wrong with the options.
  Expected<SessionPtr> create(const std::string& wantedId, const LightingSettings& options, const SessionPolicy& policy,
                              const std::string& requestId);
  /// A new session with the content of another; its id, epoch and members are its own.
  Expected<SessionPtr> create(const std::string& wantedId, SavedSession state);
  /// NOT_FOUND where there is none. Counts as use. Brings a kept session back, which takes as long as reading and
  /// parsing its geometry: for worker threads.
  Expected<SessionPtr> find(const std::string& id);
  /// Ends a session. `done` is called once (any thread, no locks): ok when it is gone for good.
  void remove(const std::string& id, std::function<void(const Status&)> done);
  /// Those in memory, in order of id.
  std::vector<SessionPtr> all() const;
  /// Those that the journal keeps, in memory or not; 0 where it keeps nothing.
  std::size_t keptCount() const;
  SessionTotals totals() const;
  /// All of them, in order of id. What cannot be read now is left out.
  std::vector<SessionSummary> summaries();

  /// Calls `kept` when the journal has everything up to `position`, a change of `session`, or with why that is not
  /// known.
  void whenDurable(const std::string& session, Position position, std::function<void(const Status&)> kept) const {
    services_.journal->whenDurable(session, position, std::move(kept));
  }
  Durability durability() const { return services_.journal->durability(); }

  Limits limits() const;
  /// For new and living sessions, from now on.
  void setLimits(const Limits& limits);

  /// Refuses new sessions, and every change to those that are there; streams stay. Returns when what was accepted
  /// before is kept, or why it is not.
  Status quiesce();
  /// Quiesces, and ends every stream with a notice.
  void drain();
  /// Expired sessions go, or go to where they are kept; unused blobs go; old request ids are forgotten. Runs by itself
  /// once a second.
  void sweep();

 private:
  /// What a new session gets: with the limits of now.
  SessionServices servicesNow() const LPV_REQUIRES(mutex_);
  Status checkNew(const std::string& wantedId) const LPV_REQUIRES(mutex_);
  /// As remove(), but ABORTED where `over`, asked with the lock held, says no of the session (null: not in memory).
  void removeIf(const std::string& id, const std::function<bool(const SessionPtr&)>& over,
                std::function<void(const Status&)> done);
  Status checkRoom() const LPV_REQUIRES(mutex_);
  SessionPtr registerNew(const SessionPtr& session, const std::string& requestId) LPV_REQUIRES(mutex_);
  void waitForMove(MutexLock& lock, const std::string& id) LPV_REQUIRES(mutex_);
  Expected<SessionPtr> restore(const std::string& id);
  void evictExpired(std::chrono::system_clock::time_point now);
  void removeIfUnused(const std::string& id, SessionEvent incident, const std::function<bool(const SessionPtr&)>& over);
  void forgetKept(std::chrono::system_clock::time_point now);
  void sweepLater();
  void report(SessionEvent incident, const std::string& id) const;

  const SessionServices services_;  ///< with the limits of the beginning
  const std::chrono::seconds retain_;
  mutable Mutex mutex_;
  Limits limits_ LPV_GUARDED_BY(mutex_);
  ConditionVariable transitionDone_;
  std::map<std::string, SessionPtr> sessions_ LPV_GUARDED_BY(mutex_);
  std::map<std::string, SessionHead> durableSessions_
      LPV_GUARDED_BY(mutex_);  ///< with those in memory; empty where nothing is kept
  std::set<std::string> inTransition_
      LPV_GUARDED_BY(mutex_);  ///< being brought back, or removed: wait for transitionDone_
  struct Requested {
    std::string session;
    std::chrono::system_clock::time_point when;
  };
  std::map<std::string, Requested> requests_ LPV_GUARDED_BY(mutex_);
  SessionKey nextKey_ LPV_GUARDED_BY(mutex_) = 1;
  std::uint64_t epoch_ LPV_GUARDED_BY(mutex_) = 1;
  bool draining_ LPV_GUARDED_BY(mutex_) = false;
  /// What the timer of the next sweep knows of this registry.
  struct SweepGuard {
    Mutex mutex;  ///< held by a sweep
    bool ended LPV_GUARDED_BY(mutex) = false;
  };
  std::shared_ptr<SweepGuard> life_ = std::make_shared<SweepGuard>();
};

}  // namespace lpv
