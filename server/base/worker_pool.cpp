#include "base/worker_pool.h"

#include <sys/resource.h>

namespace lpv {

namespace {

/// Whose thread this is.
thread_local const WorkerPool* workplace = nullptr;

}  // namespace

WorkerPool::WorkerPool(unsigned threads, int nice) : size_(threads), nice_(nice) {
  for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
}

void WorkerPool::stop() {
  {
    const MutexLock lock(mutex_);
    stopping_ = true;
  }
  wake_.notifyAll();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
  const MutexLock lock(mutex_);
  jobs_.clear();
}

void WorkerPool::post(std::function<void()> job) {
  {
    const MutexLock lock(mutex_);
    if (!stopping_) jobs_.push_back(std::move(job));
  }
  wake_.notifyOne();
}

void WorkerPool::runQueued() {
  MutexLock lock(mutex_);
  while (!jobs_.empty()) {
    std::function<void()> job = std::move(jobs_.front());
    jobs_.pop_front();
    lock.unlock();
    job();
    job = nullptr;
    lock.lock();
  }
}

void WorkerPool::blockingSection(const std::function<void()>& wait) {
  if (workplace != this) return wait();
  {
    const MutexLock lock(mutex_);
    --running_;
    if (idle_ == 0 && !stopping_ && threads_.size() < size_ + kMaxCompensatingThreads)
      threads_.emplace_back([this] { run(); });
  }
  wake_.notifyOne();
  wait();
  const MutexLock lock(mutex_);
  ++running_;  // for a moment one job more than usual runs
}

void WorkerPool::run() {
  workplace = this;
  if (nice_ != 0) (void)setpriority(PRIO_PROCESS, 0, nice_);  // on Linux, of this thread alone
  MutexLock lock(mutex_);
  while (true) {
    ++idle_;
    while (!stopping_ && (jobs_.empty() || running_ >= size_)) wake_.wait(lock);
    --idle_;
    if (jobs_.empty()) return;
    std::function<void()> job = std::move(jobs_.front());
    jobs_.pop_front();
    ++running_;
    lock.unlock();
    job();
    job = nullptr;  // what the job holds is released outside the lock
    lock.lock();
    --running_;
  }
}

}  // namespace lpv
