#pragma once

#include <deque>
#include <functional>
#include <thread>
#include <vector>

#include "base/mutex.h"

namespace lpv {

/// Threads for work that may take milliseconds: parsing, hashing, encoding. Jobs must not throw.
class WorkerPool {
 public:
  /// Without threads, nothing runs but in runQueued(). `nice`: how far the threads step back behind others (nice(2)).
  explicit WorkerPool(unsigned threads, int nice = 0);
  ~WorkerPool() { stop(); }
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  void post(std::function<void()> job);
  /// Runs `wait`, which may take long and needs little of the processor, while another thread works in this one's place
  /// (kMaxCompensatingThreads at most do). Outside a job of this pool: just runs it.
  void blockingSection(const std::function<void()>& wait);
  /// Runs what is queued, and what that posts, on the calling thread: a pool without threads does the same in every
  /// run.
  void runQueued();
  /// Runs what is queued, then joins; what is posted later is dropped.
  void stop();

 private:
  static constexpr unsigned kMaxCompensatingThreads = 16;

  void run();

  const unsigned size_;  ///< jobs that run at once
  const int nice_;
  Mutex mutex_;
  ConditionVariable wake_;
  std::deque<std::function<void()>> jobs_ LPV_GUARDED_BY(mutex_);
  unsigned running_ LPV_GUARDED_BY(mutex_) = 0;  ///< jobs, but those that are blocked
  unsigned idle_ LPV_GUARDED_BY(mutex_) = 0;  ///< threads that wait for a job
  bool stopping_ LPV_GUARDED_BY(mutex_) = false;
  std::vector<std::thread> threads_;
};

}  // namespace lpv
