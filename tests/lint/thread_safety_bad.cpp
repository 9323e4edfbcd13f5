// Must not compile under tests/lint/thread_safety, which looks for the diagnostics that are announced here. Seen to be
// noticed by the script when the macros were empty for Clang too.

#include "base/mutex.h"

namespace lpv {

class Account {
 public:
  // expect: writing variable 'balance_' requires holding mutex 'mutex_' exclusively
  void deposit(int amount) { balance_ += amount; }

  // expect: calling function 'add' requires holding mutex 'mutex_' exclusively
  void depositTwice(int amount) { add(2 * amount); }

  // expect: acquiring mutex 'mutex_' that is already held
  void depositLocked(int amount) {
    const MutexLock lock(mutex_);
    const MutexLock again(mutex_);
    add(amount);
  }

  // expect: reading variable 'balance_' requires holding mutex 'mutex_'
  int balanceAfter() {
    MutexLock lock(mutex_);
    lock.unlock();
    return balance_;
  }

 private:
  void add(int amount) LPV_REQUIRES(mutex_) { balance_ += amount; }

  Mutex mutex_;
  int balance_ LPV_GUARDED_BY(mutex_) = 0;
};

}  // namespace lpv
