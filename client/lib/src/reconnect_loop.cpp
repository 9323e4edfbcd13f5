#include "reconnect_loop.h"

#include <algorithm>
#include <random>
#include <utility>

namespace lpv::client {
namespace {

using namespace std::chrono_literals;

constexpr auto kSilence = 3s;
constexpr auto kShortestPause = 100ms;
constexpr auto kLongestPause = 2000ms;

std::chrono::milliseconds jitter(int failures) {
  thread_local std::mt19937 generator{std::random_device{}()};
  const auto longest =
      std::min<std::chrono::milliseconds>(kLongestPause, kShortestPause * (2 << std::min(failures, 6)));
  return std::chrono::milliseconds(
      std::uniform_int_distribution<std::int64_t>(kShortestPause / 1ms, longest / 1ms)(generator));
}

}  // namespace

ReconnectLoop::ReconnectLoop(std::shared_ptr<Connection> connection, Behaviour behaviour)
    : connection_(std::move(connection)), behaviour_(std::move(behaviour)) {}

void ReconnectLoop::start() {
  watchdog_ = std::thread([this] { guard(); });
  reader_ = std::thread([this] { run(); });
}

void ReconnectLoop::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    if (context_ != nullptr) context_->TryCancel();
  }
  changed_.notify_all();
  if (std::this_thread::get_id() == reader_.get_id()) return;
  if (reader_.joinable()) reader_.join();
  if (watchdog_.joinable()) watchdog_.join();
}

std::uint64_t ReconnectLoop::reopened() const {
  const std::lock_guard lock(mutex_);
  return attempts_ == 0 ? 0 : attempts_ - 1;
}

void ReconnectLoop::watch(bool waiting) {
  const std::lock_guard lock(mutex_);
  waiting_ = waiting;
  waitingSince_ = Clock::now();
  if (waiting) changed_.notify_all();
}

grpc::Status ReconnectLoop::attemptOnce() {
  Call call(*connection_, Call::Stream{});
  {
    const std::lock_guard lock(mutex_);
    if (stopping_) return grpc::Status::CANCELLED;
    context_ = &call.context;
    ++attempts_;
  }
  alive_ = false;
  const grpc::Status status = behaviour_.attempt(call.context);
  const std::lock_guard lock(mutex_);
  context_ = nullptr;
  return status;
}

/// Returns false if stop() ended the pause.
bool ReconnectLoop::pause(int failures) {
  std::unique_lock lock(mutex_);
  return !changed_.wait_for(lock, jitter(failures), [this] { return stopping_; });
}

void ReconnectLoop::run() {
  int failures = 0;
  bool stopped = false;
  grpc::Status status;
  do {
    status = attemptOnce();
    {
      const std::lock_guard lock(mutex_);
      stopped = stopping_;
    }
    if (stopped || connection_->cancelled() || !isRetryable(status)) break;
    failures = alive_ ? 0 : failures + 1;
    if (behaviour_.reopening) behaviour_.reopening(statusFrom(status, connection_->options.address));
    stopped = !pause(failures);
  } while (!stopped);
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
  }
  changed_.notify_all();
  if (!stopped && behaviour_.ended) behaviour_.ended(statusFrom(status, connection_->options.address));
}

void ReconnectLoop::guard() {
  std::unique_lock lock(mutex_);
  while (!stopping_ && !finished_) {
    if (!waiting_ || context_ == nullptr) {
      changed_.wait(lock);
    } else if (Clock::now() < waitingSince_ + kSilence) {
      changed_.wait_until(lock, waitingSince_ + kSilence);
    } else {
      context_->TryCancel();
      waiting_ = false;
    }
  }
}

}  // namespace lpv::client
