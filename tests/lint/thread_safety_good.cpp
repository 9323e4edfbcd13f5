// What thread_safety_bad.cpp does, with the lock held: compiles under tests/lint/thread_safety.

#include "base/mutex.h"

namespace lpv {

class Account {
 public:
  void deposit(int amount) {
    const MutexLock lock(mutex_);
    balance_ += amount;
    changed_.notifyAll();
  }

  void depositTwice(int amount) {
    const MutexLock lock(mutex_);
    add(2 * amount);
  }

  int waitForMore(int least) {
    MutexLock lock(mutex_);
    while (balance_ < least) changed_.wait(lock);
    return balance_;
  }

  int balanceAfter() {
    MutexLock lock(mutex_);
    lock.unlock();
    lock.lock();
    return balance_;
  }

 private:
  void add(int amount) LPV_REQUIRES(mutex_) { balance_ += amount; }

  Mutex mutex_;
  ConditionVariable changed_;
  int balance_ LPV_GUARDED_BY(mutex_) = 0;
};

}  // namespace lpv
