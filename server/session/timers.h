#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <thread>

namespace lpv {

using Clock = std::chrono::steady_clock;

/// One thread that calls functions at given times. Functions must be short and must not throw.
class Timers {
 public:
  Timers();
  ~Timers() { stop(); }
  Timers(const Timers&) = delete;
  Timers& operator=(const Timers&) = delete;

  /// Drops what is not due and joins; later calls are dropped.
  void stop();
  void at(Clock::time_point when, std::function<void()> call);

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::multimap<Clock::time_point, std::function<void()>> calls_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace lpv
