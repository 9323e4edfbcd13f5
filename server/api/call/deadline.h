#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <utility>

#include "base/mutex.h"
#include "base/timers.h"

namespace lpv::api {

/// A call in the future that can be put off or taken back; then nothing of it stays until its time would have come.
/// Thread-safe.
class Deadline {
 public:
  explicit Deadline(Timers& timers) : timers_(timers) {}
  ~Deadline() { stop(); }
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  void restart(Clock::duration after, std::function<void()> call) {
    Timers::Key old;
    {
      const MutexLock lock(mutex_);
      const std::uint64_t mine = ++*generation_;
      old = std::exchange(timer_,
                          timers_.at(Clock::now() + after, [generation = generation_, mine, call = std::move(call)] {
                            if (*generation == mine) call();
                          }));
    }
    timers_.cancel(old);
  }
  void stop() {
    Timers::Key old;
    {
      const MutexLock lock(mutex_);
      ++*generation_;
      old = std::exchange(timer_, {});
    }
    timers_.cancel(old);
  }

 private:
  Timers& timers_;
  Mutex mutex_;
  Timers::Key timer_ LPV_GUARDED_BY(mutex_);
  /// For a call that has begun already.
  std::shared_ptr<std::atomic<std::uint64_t>> generation_ = std::make_shared<std::atomic<std::uint64_t>>(0);
};

}  // namespace lpv::api
