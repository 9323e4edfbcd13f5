#include "base/timers.h"

namespace lpv {

Timers::Timers() : thread_([this] { run(); }) {}

void Timers::stop() {
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
  }
  wake_.notifyAll();
  if (thread_.joinable()) thread_.join();
  std::map<Key, std::function<void()>> dropped;
  const MutexLock lock(mutex_);
  dropped.swap(calls_);
}

Timers::Key Timers::at(Clock::time_point when, std::function<void()> call) {
  Key key;
  {
    const MutexLock lock(mutex_);
    if (stopping_) return key;
    key = {when, ++last_};
    calls_.emplace(key, std::move(call));
  }
  wake_.notifyAll();
  return key;
}

void Timers::cancel(const Key& key) {
  std::map<Key, std::function<void()>>::node_type dropped;  // let go of without the lock
  const MutexLock lock(mutex_);
  dropped = calls_.extract(key);
}

void Timers::run() {
  MutexLock lock(mutex_);
  while (!stopping_) {
    if (calls_.empty()) {
      wake_.wait(lock);
      continue;
    }
    const auto first = calls_.begin();
    if (Clock::now() < first->first.first) {
      const Clock::time_point when = first->first.first;
      wake_.waitUntil(lock, when);
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
