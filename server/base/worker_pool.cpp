#include "base/worker_pool.h"

namespace lpv {

namespace {

/// Whose thread this is.
thread_local const WorkerPool* workplace = nullptr;

}  // namespace

WorkerPool::WorkerPool(unsigned threads) : size_(threads) {
  for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
}

void WorkerPool::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
  const std::lock_guard lock(mutex_);
  jobs_.clear();
}

void WorkerPool::post(std::function<void()> job) {
  {
    const std::lock_guard lock(mutex_);
    if (!stopping_) jobs_.push_back(std::move(job));
  }
  wake_.notify_one();
}

void WorkerPool::runQueued() {
  std::unique_lock lock(mutex_);
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
    const std::lock_guard lock(mutex_);
    --running_;
    if (idle_ == 0 && !stopping_ && threads_.size() < size_ + kMaxCompensatingThreads)
      threads_.emplace_back([this] { run(); });
  }
  wake_.notify_one();
  wait();
  const std::lock_guard lock(mutex_);
  ++running_;  // for a moment one job more than usual runs
}

void WorkerPool::run() {
  workplace = this;
  std::unique_lock lock(mutex_);
  while (true) {
    ++idle_;
    wake_.wait(lock, [this] { return stopping_ || (!jobs_.empty() && running_ < size_); });
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
