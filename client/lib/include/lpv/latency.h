#pragma once
// How long it takes from sending an edit to holding the first result that contains it, by one clock: this machine's.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <utility>
#include <vector>

namespace lpv::client {

/// Seconds, over all edits measured.
struct LatencySummary {
  std::size_t count = 0;
  double p50 = 0.0;
  double p95 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

LatencySummary summarize(std::vector<double> seconds);

/// Joins the times at which edits were sent with the client_sequence that results echo. Safe to share between threads.
class LatencyLog {
 public:
  /// Edit `sequence` is being sent now.
  void sent(std::uint64_t sequence);
  /// A result that contains all edits up to `sequence` is here now.
  void seen(std::uint64_t sequence);
  LatencySummary summary() const { return summarize(seconds()); }
  /// Seconds of each edit seen so far, in order of sequence.
  std::vector<double> seconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  mutable std::mutex mutex_;
  std::deque<std::pair<std::uint64_t, Clock::time_point>> waiting_;  // rising sequences
  std::vector<double> seconds_;
};

}  // namespace lpv::client
