#pragma once
// The mutex of this code base, with annotations of which lock guards what. Clang checks them at compile time
// (-Wthread-safety; tests/lint/thread_safety runs it over server/); GCC sees empty macros.
// https://clang.llvm.org/docs/ThreadSafetyAnalysis.html

#include <chrono>
#include <condition_variable>
#include <mutex>

#if defined(__clang__)
#define LPV_THREAD_ANNOTATION(attribute) __attribute__((attribute))
#else
#define LPV_THREAD_ANNOTATION(attribute)
#endif

/// On a class: a lock.
#define LPV_CAPABILITY(name) LPV_THREAD_ANNOTATION(capability(name))
/// On a class: acquires a lock in its constructor, releases it in its destructor.
#define LPV_SCOPED_CAPABILITY LPV_THREAD_ANNOTATION(scoped_lockable)
/// On a data member: read and written only while the mutex is held.
#define LPV_GUARDED_BY(mutex) LPV_THREAD_ANNOTATION(guarded_by(mutex))
/// On a pointer: what it points to is guarded, the pointer is not.
#define LPV_PT_GUARDED_BY(mutex) LPV_THREAD_ANNOTATION(pt_guarded_by(mutex))
/// On a function: the caller holds the mutex.
#define LPV_REQUIRES(...) LPV_THREAD_ANNOTATION(requires_capability(__VA_ARGS__))
/// On a function: the caller does not hold the mutex, because the function acquires it.
#define LPV_EXCLUDES(...) LPV_THREAD_ANNOTATION(locks_excluded(__VA_ARGS__))
/// On a function: holds the mutex when it returns; without arguments, the object itself is the lock.
#define LPV_ACQUIRE(...) LPV_THREAD_ANNOTATION(acquire_capability(__VA_ARGS__))
/// On a function: has released the mutex when it returns.
#define LPV_RELEASE(...) LPV_THREAD_ANNOTATION(release_capability(__VA_ARGS__))
/// On a mutex: acquired after the other one by a thread that holds both.
#define LPV_ACQUIRED_AFTER(...) LPV_THREAD_ANNOTATION(acquired_after(__VA_ARGS__))
/// On a function that returns a reference to a mutex: names the mutex.
#define LPV_RETURN_CAPABILITY(mutex) LPV_THREAD_ANNOTATION(lock_returned(mutex))
/// On a function: tells the analysis that the mutex is held, where it cannot see that; checks nothing at run time.
#define LPV_ASSERT_HELD(...) LPV_THREAD_ANNOTATION(assert_capability(__VA_ARGS__))

namespace lpv {

/// A mutex that is not recursive. Acquired through MutexLock.
class LPV_CAPABILITY("mutex") Mutex {
 public:
  Mutex() = default;
  Mutex(const Mutex&) = delete;
  Mutex& operator=(const Mutex&) = delete;

  /// Tells the analysis that the calling thread holds this mutex: for callbacks that another class calls with it held.
  void assertHeld() const LPV_ASSERT_HELD(this) {}

 private:
  friend class MutexLock;
  std::mutex mutex_;
};

/// Holds a mutex from construction to destruction, with pauses between unlock() and lock().
class LPV_SCOPED_CAPABILITY MutexLock {
 public:
  explicit MutexLock(Mutex& mutex) LPV_ACQUIRE(mutex) : lock_(mutex.mutex_) {}
  ~MutexLock() LPV_RELEASE() {}
  MutexLock(const MutexLock&) = delete;
  MutexLock& operator=(const MutexLock&) = delete;

  void unlock() LPV_RELEASE() { lock_.unlock(); }
  void lock() LPV_ACQUIRE() { lock_.lock(); }

 private:
  friend class ConditionVariable;
  std::unique_lock<std::mutex> lock_;
};

/// A condition variable. Waits have no predicate: the analysis does not look into lambdas, so callers loop,
/// `while (!condition) changed.wait(lock);`, which also takes care of spurious wake-ups.
class ConditionVariable {
 public:
  /// Releases the lock while it waits and holds it again when it returns.
  void wait(MutexLock& lock) { changed_.wait(lock.lock_); }
  /// The same; false when `deadline` has passed.
  template <typename AnyClock, typename Duration>
  bool waitUntil(MutexLock& lock, const std::chrono::time_point<AnyClock, Duration>& deadline) {
    return changed_.wait_until(lock.lock_, deadline) == std::cv_status::no_timeout;
  }
  void notifyOne() { changed_.notify_one(); }
  void notifyAll() { changed_.notify_all(); }

 private:
  std::condition_variable changed_;
};

}  // namespace lpv
