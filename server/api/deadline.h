#pragma once

#include <atomic>
#include <functional>
#include <memory>

#include "session/timers.h"

namespace lpv::api {

/// A call in the future that can be put off or taken back. Thread-safe.
class Deadline {
 public:
  explicit Deadline(Timers& timers) : timers_(timers) {}
  ~Deadline() { stop(); }
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;

  void restart(Clock::duration after, std::function<void()> call) {
    const std::uint64_t mine = ++*generation_;
    timers_.at(Clock::now() + after, [generation = generation_, mine, call = std::move(call)] {
      if (*generation == mine) call();
    });
  }
  void stop() { ++*generation_; }

 private:
  Timers& timers_;
  std::shared_ptr<std::atomic<std::uint64_t>> generation_ = std::make_shared<std::atomic<std::uint64_t>>(0);
};

}  // namespace lpv::api
