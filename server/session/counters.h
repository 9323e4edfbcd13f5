#pragma once
// What the server counts while it runs, for stats and metrics. Any thread, no locks but where a tick has failed.

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "base/mutex.h"
#include "base/status.h"
#include "engine/stage.h"

namespace lpv {

/// Durations by how long they were.
class DurationHistogram {
 public:
  /// Upper ends of the buckets, seconds, included; one more bucket has none.
  static constexpr std::array<double, 15> kBounds = {0.0001, 0.00025, 0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025,
                                                     0.05,   0.1,     0.25,   0.5,   1.0,    2.5,   10.0};
  static constexpr std::size_t kBuckets = kBounds.size() + 1;

  void observe(double seconds);
  /// Of one bucket, not of those below it.
  std::int64_t count(std::size_t bucket) const { return counts_[bucket]; }
  /// Of all that was observed, seconds.
  double sum() const { return sum_; }

 private:
  std::array<std::atomic<std::int64_t>, kBuckets> counts_{};
  std::atomic<double> sum_{0.0};
};

/// Canonical codes in lower case, by their numbers.
inline constexpr std::array kCodeLabels = {
    "ok",        "cancelled",      "unknown",           "invalid_argument",   "deadline_exceeded",
    "not_found", "already_exists", "permission_denied", "resource_exhausted", "failed_precondition",
    "aborted",   "out_of_range",   "unimplemented",     "internal",           "unavailable",
    "data_loss", "unauthenticated"};

/// Labels for why something was refused: kCodeLabels, then the names of base/reason.h in lower case.
inline constexpr std::size_t kReasonCount = kCodeLabels.size() + kReasonNames.size();
extern const std::array<std::string, kReasonCount> kReasons;
/// Where in kReasons: by the status's reason, or by its code where it has none.
std::size_t reasonOf(const Status& status);

/// Refusals by reason.
class ReasonCounter {
 public:
  void add(const Status& status) { ++counts_[reasonOf(status)]; }
  std::int64_t count(std::size_t reason) const { return counts_[reason]; }
  std::int64_t total() const;

 private:
  std::array<std::atomic<std::int64_t>, kReasonCount> counts_{};
};

/// What results are sent as.
enum class SentAs { kVolumeHalf, kVolumeFloat, kVolumeCompact, kFrameJpeg, kFramePng, kFrameExr };
struct SentName {
  const char* kind;
  const char* format;
};
inline constexpr std::array<SentName, 6> kSentNames = {{{"volume", "half"},
                                                        {"volume", "float"},
                                                        {"volume", "compact"},
                                                        {"frame", "jpeg"},
                                                        {"frame", "png"},
                                                        {"frame", "exr"}}};

/// Whether the device still finishes ticks.
class TickWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// A tick is asked for.
  void begun(Clock::time_point now);
  /// It is over, with how it ended. CANCELLED is no failure: the engine stops.
  void ended(Clock::time_point now, const Status& status);

  /// How long no tick has ended although one was asked for; 0 where none is.
  std::chrono::seconds stalledFor(Clock::time_point now) const;
  int failedInARow() const { return failedInARow_; }
  /// What the last one that failed said.
  std::string lastFailure() const;
  /// There is no graphics context, and none to be had: since a tick said so, until one succeeds.
  bool contextLost() const { return contextLost_; }
  const ReasonCounter& failures() const { return failures_; }

 private:
  std::atomic<std::int64_t> underWay_{0};
  std::atomic<Clock::time_point> lastEvent_{Clock::time_point()};
  std::atomic<int> failedInARow_{0};
  std::atomic<bool> contextLost_{false};
  ReasonCounter failures_;
  mutable Mutex mutex_;
  std::string lastFailure_ LPV_GUARDED_BY(mutex_);
};

/// Counters of the whole server.
/// What the door for browsers refuses.
enum class WebRefusal { kHost, kOrigin, kPlaces, kTokenInAddress, kRequest, kFirstMessage, kToken, kMessage, kSize };
inline constexpr std::array kWebRefusals = {
    "host", "origin", "places", "token_in_address", "request", "first_message", "token", "message", "size"};

struct Counters {
  struct Sent {
    std::atomic<std::int64_t> results{0};
    std::atomic<std::int64_t> bytes{0};
  };

  std::atomic<std::int64_t> ticks{0};
  std::atomic<std::int64_t> resultsSent{0};  ///< handed to subscribers' ends
  std::atomic<std::int64_t> resultsCoalesced{0};  ///< passed over: the reader gets a later one instead
  std::array<Sent, kSentNames.size()> sent;  ///< encoded for readers, by SentAs
  std::atomic<std::int64_t> volumesEncoded{0};
  std::atomic<std::int64_t> editsAccepted{0};
  std::atomic<int> sessionFiles{0};  ///< on their way in or out
  std::atomic<int> uploads{0};       ///< of blobs, on their way
  std::atomic<std::int64_t> addressBans{0};  ///< for flooding with calls
  std::atomic<int> webSockets{0};            ///< open ones of browsers
  std::array<std::atomic<std::int64_t>, kWebRefusals.size()> webRefused{};  ///< by WebRefusal
  ReasonCounter editsRejected;
  ReasonCounter callsRefused;  ///< calls that ended with an error before anything was answered

  DurationHistogram tickSeconds;  ///< from asking for a tick to having it, other sessions' turns included
  std::array<DurationHistogram, kStages> stageSeconds;  ///< without other sessions' turns
  DurationHistogram acknowledgeLag;  ///< from giving a subscriber a result to its acknowledgement
  DurationHistogram storeCommitSeconds;
  std::atomic<std::int64_t> certificateFailures{0};  ///< times that changed TLS files were found bad
  std::atomic<std::int64_t> storeFailures{0};  ///< transactions that could not be committed

  TickWatch tickWatch;
  /// When the once-a-second sweep over all sessions was last through.
  std::atomic<TickWatch::Clock::time_point> lastSweep{TickWatch::Clock::now()};

  void countWebRefusal(WebRefusal why) { ++webRefused[std::size_t(why)]; }
  void countSent(SentAs as, std::int64_t bytes);
  std::int64_t resultBytesSent() const;
  /// `stage` as TickReport names it.
  void countStage(Stage stage, double seconds) { stageSeconds[std::size_t(stage)].observe(seconds); }
};

}  // namespace lpv
