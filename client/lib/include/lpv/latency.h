#pragma once
// Latency from sending an edit to receiving the first result that contains it, by this machine's clock.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <utility>
#include <vector>

namespace lpv::client {

/// Percentiles of the latency over all edits measured, seconds.
struct LatencySummary {
  std::size_t count = 0;
  double p50 = 0.0;
  double p95 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

LatencySummary summarize(std::vector<double> seconds);

/// Matches the times at which edits were sent with the client_sequence that results echo. Thread-safe.
class LatencyLog {
 public:
  /// Records that edit `sequence` is sent now.
  void sent(std::uint64_t sequence);
  /// Records that a result with all edits up to `sequence` arrives now.
  void seen(std::uint64_t sequence);
  LatencySummary summary() const { return summarize(seconds()); }
  /// Latency of each edit seen so far, seconds, in order of sequence.
  std::vector<double> seconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  mutable std::mutex mutex_;
  std::deque<std::pair<std::uint64_t, Clock::time_point>> waiting_;  // rising sequences
  std::vector<double> seconds_;
};

}  // namespace lpv::client
