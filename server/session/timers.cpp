#include "session/timers.h"

namespace lpv {

Timers::Timers() : thread_([this] { run(); }) {}

void Timers::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
  std::multimap<Clock::time_point, std::function<void()>> dropped;
  const std::lock_guard lock(mutex_);
  dropped.swap(calls_);
}

void Timers::at(Clock::time_point when, std::function<void()> call) {
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return;
    calls_.emplace(when, std::move(call));
  }
  wake_.notify_all();
}

void Timers::run() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    if (calls_.empty()) {
      wake_.wait(lock);
      continue;
    }
    const auto first = calls_.begin();
    if (Clock::now() < first->first) {
      const Clock::time_point when = first->first;
      wake_.wait_until(lock, when);
      continue;
    }
    std::function<void()> call = std::move(first->second);
    calls_.erase(first);
    lock.unlock();
    call();
    call = nullptr;
    lock.lock();
  }
}

}  // namespace lpv
