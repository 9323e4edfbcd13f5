#include "lpv/latency.h"

#include <algorithm>

namespace lpv::client {
namespace {

/// The smallest value that at least this share of the sorted values does not exceed.
double quantile(const std::vector<double>& sorted, double share) {
  const auto rank = std::size_t(share * double(sorted.size()));
  return sorted[std::min(rank, sorted.size() - 1)];
}

}  // namespace

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

LatencySummary LatencyLog::summary() const {
  std::vector<double> sorted = seconds();
  if (sorted.empty()) return {};
  std::sort(sorted.begin(), sorted.end());
  return {sorted.size(), quantile(sorted, 0.5), quantile(sorted, 0.95), quantile(sorted, 0.99), sorted.back()};
}

}  // namespace lpv::client
