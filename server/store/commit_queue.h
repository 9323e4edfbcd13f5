#pragma once
// The queue before the tables: group commit, retry, and who is told when.
//
// The rule for acknowledgements. A change is made in memory first and may be seen by readers before it is kept; whoever
// made it is told only when it is. push() takes changes in order and never waits; whenDurable() tells when a change is
// kept. Where the backend cannot be written,
//   - nothing that was taken is given up: the same changes, in the same order, are tried again until they are kept;
//   - everybody who waits is told UNAVAILABLE, naming the place: the outcome is not known yet, and the sequence
//   repeated
//     gets the true one;
//   - available() is not ok until the queue has caught up, and sessions refuse further changes with it, unapplied and
//     unrecorded, so that what is ahead of the disk stays what was in flight at the moment of the failure.
// So what is kept is at any time a prefix of what happened, and everything that was acknowledged is in it. A process
// that dies loses at most what nobody was told; its sequences are applied when they are repeated.
//
// A session that another server has taken is fenced: its changes are dropped from the first one that the backend
// refused, writable() of that session says why, whoever waits for them is told why, and other sessions go on.

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include "base/mutex.h"
#include "store/backend.h"
#include "store/fences.h"

namespace lpv::store {

/// Writes one change; called on the queue's thread within a group, again after a rollback, or never.
using Change = std::function<Written(Backend&)>;
/// Gets ok, or why it is not known whether what was waited for is kept, or why it was fenced.
using Told = std::function<void(const Status&)>;

struct CommitQueueOptions {
  std::chrono::milliseconds retry{250};  ///< before the first attempt after a failure; doubles with each further one
  std::chrono::milliseconds retryAtMost{1000};  ///< the longest pause between attempts
  /// Runs what whenDurable was given, in order; unset: the queue's thread does.
  std::function<void(std::function<void()>)> executor;
  /// Called on the queue's thread after every attempt at a group: how long it took, the wait for the disk included, and
  /// whether it was committed.
  std::function<void(std::chrono::duration<double> took, bool committed)> onCommit;
  /// Called on the queue's thread when writing begins to fail (why) and when it has caught up (ok).
  std::function<void(const Status&)> onChange;
};

/// One thread writes. Everything that was queued while the last commit ran goes into the next group: the disk is waited
/// for once, however many wait. Thread-safe; changes are made in the order they were given.
class CommitQueue {
 public:
  CommitQueue(std::unique_ptr<Backend> backend, CommitQueueOptions options);
  /// Writes what was given, unless the backend cannot be written; callbacks that are due then are not called.
  ~CommitQueue();
  CommitQueue(const CommitQueue&) = delete;
  CommitQueue& operator=(const CommitQueue&) = delete;

  /// Ok, or why nothing can be kept now.
  Status available() const;
  /// Ok, or why changes of this session cannot be kept now: available(), or the session is fenced.
  Status writable(const std::string& session) const;
  /// Changes that were given and are not kept yet.
  std::int64_t queued() const;
  /// Groups committed so far.
  std::int64_t commits() const;

  /// Takes a change of `session`; returns at once.
  Position push(const std::string& session, Change change);
  /// As push, for the change that makes this server the session's owner: it is written though the session is fenced,
  /// and ends that.
  Position takeOver(const std::string& session, Change change);

  /// Calls `told` once: at once where the session's change at `position` is kept or fenced, or the backend is failing;
  /// else on the executor, in the order of positions.
  void whenDurable(const std::string& session, Position position, Told told);
  /// Waits until everything given so far is kept or fenced, or fails to be; needs no executor.
  Status flush();

  lpv::v1::Durability durability() const { return backend_->durability(); }
  /// At least the highest epoch of any session when the backend was opened.
  std::uint64_t highestEpoch() const { return backend_->highestEpoch(); }
  // Reading: waits for the changes given so far; errors are flush()'s or the backend's.
  Expected<std::vector<SessionHead>> heads();
  Expected<std::vector<AccessToken>> tokens();
  Expected<Loaded> load(const std::string& session, bool withContents);

 private:
  struct Entry {
    Position position = 0;
    std::string session;
    bool takesOver = false;
    Change change;
  };
  struct Waiter {
    std::string session;
    Told told;
  };
  struct Notice {
    Told told;
    Status status;
  };

  Position take(const std::string& session, bool takesOver, Change change);
  void run();
  bool nextGroup();
  Status commit(Fences* fences);
  Status make(const Entry& entry, Fences* fences);
  void settle(const Status& status, Fences fences);
  void tell(std::vector<Notice> notices);

  const std::unique_ptr<Backend> backend_;
  const CommitQueueOptions options_;

  mutable Mutex mutex_;
  ConditionVariable wake_;  ///< there is something to write
  ConditionVariable settled_;  ///< a group has ended
  std::deque<Entry> queue_ LPV_GUARDED_BY(mutex_);
  std::multimap<Position, Waiter> waiting_ LPV_GUARDED_BY(mutex_);
  Fences fences_ LPV_GUARDED_BY(mutex_);
  Position given_ LPV_GUARDED_BY(mutex_) = 0;
  Position durablePosition_ LPV_GUARDED_BY(mutex_) = 0;
  Status failure_ LPV_GUARDED_BY(mutex_);
  std::int64_t commits_ LPV_GUARDED_BY(mutex_) = 0;
  bool stopping_ LPV_GUARDED_BY(mutex_) = false;

  // The queue's thread's own.
  std::deque<Entry> group_;  ///< in progress, or the one that failed
  std::chrono::milliseconds pause_;
  std::thread thread_;
};

}  // namespace lpv::store
