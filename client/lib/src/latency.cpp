#include "lpv/latency.h"

#include <algorithm>

namespace lpv::client {
namespace {

/// Percentile: the smallest of the sorted values that at least this share of them does not exceed.
double quantile(const std::vector<double>& sorted, double share) {
  const auto rank = std::size_t(share * double(sorted.size()));
  return sorted[std::min(rank, sorted.size() - 1)];
}

}  // namespace

LatencySummary summarize(std::vector<double> seconds) {
  if (seconds.empty()) return {};
  std::sort(seconds.begin(), seconds.end());
  return {seconds.size(), quantile(seconds, 0.5), quantile(seconds, 0.95), quantile(seconds, 0.99), seconds.back()};
}

void LatencyLog::sent(std::uint64_t sequence) {
  const std::lock_guard lock(mutex_);
  waiting_.emplace_back(sequence, Clock::now());
}

void LatencyLog::seen(std::uint64_t sequence) {
  const Clock::time_point now = Clock::now();
  const std::lock_guard lock(mutex_);
  while (!waiting_.empty() && waiting_.front().first <= sequence) {
    seconds_.push_back(std::chrono::duration<double>(now - waiting_.front().second).count());
    waiting_.pop_front();
  }
}

std::vector<double> LatencyLog::seconds() const {
  const std::lock_guard lock(mutex_);
  return seconds_;
}

}  // namespace lpv::client
