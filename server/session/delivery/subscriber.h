#pragma once
// One reader of results: what it has been sent, what it has acknowledged, and when it may be sent more. It has one
// credit, or two over a long line (PROTOCOL.md, Results).
//
// Results are made ahead of a credit, and wait for it: one for each credit at most.
// - Volumes for readers behind a long line. Between an acknowledgement and the next result lie a tick and its encoding;
//   where the round trip is known well enough, they begin so much before the acknowledgement is expected.
// - Whatever a reader wants whose acknowledgement is expected before a tick ends that begins for others: without that,
//   readers whose acknowledgements come while the other's tick runs take turns with ticks of their own.

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "base/timers.h"
#include "session/delivery/frame_adapter.h"
#include "session/delivery/pacer.h"
#include "session/delivery/result.h"
#include "session/delivery/round_trip.h"
#include "session/delivery/subscription.h"

namespace lpv {

/// How fast a session makes results.
struct Pace {
  double tickRate = 1.0;  ///< ticks per second at most
  double makingSeconds = 0.0;  ///< from a tick's plan to the encoded volume, smoothed
  double tickSeconds = 0.0;  ///< of a tick, smoothed
};

/// `rate` per second as the time between two.
inline Clock::duration intervalOf(double rate) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / rate));
}

/// A result on its way to a subscriber.
struct Sent {
  std::uint64_t resultId = 0;
  Clock::time_point at{};
  bool sharp = false;  ///< says nothing about how soon other frames come
};

/// A result that was made for a credit that is about to come back.
struct Prefetch {
  Result result;
  Clock::time_point at{};
};

/// Not thread-safe, but for key, id, sink and taken: the lock of its Delivery guards it.
struct Subscriber {
  static constexpr Clock::time_point kNever = Clock::time_point::max();

  std::uint64_t key = 0;
  std::string id;
  std::weak_ptr<ResultSink> sink;
  /// Newest result that the receiver has begun to take; nobody has seen a later one.
  std::atomic<std::uint64_t> taken{0};

  Subscription subscription;
  std::deque<Sent> inFlight;  ///< sent and not acknowledged, oldest first
  std::uint64_t lastSent = 0;  ///< result id
  std::uint64_t baseId = 0;  ///< newest result acknowledged ...
  std::uint64_t basesAfter = 0;  ///< ... among those after this one; what came before is lost
  std::uint64_t shownRevision = 0;  ///< of the last result sent
  bool shownAny = false;
  bool rough = false;  ///< the last result sent is a frame that was made quickly
  Clock::time_point sentAt{};  ///< when that was
  bool settingsChanged = false;  ///< camera, size or exposure since the last frame asked for
  Pacer pacer{Pacer::Slack::kNone};  ///< of results, where it has a rate of its own
  RoundTrip roundTrip;
  std::optional<Prefetch> prefetch;
  std::uint64_t prefetchFor = 0;  ///< the result whose acknowledgement one was last made ahead of
  std::optional<FrameAdapter> adapter;  ///< where the subscription has a rate to adapt to

  /// The last result sent, if any, is older than `revision`.
  bool lacks(std::uint64_t revision) const { return !shownAny || shownRevision < revision; }
  /// Newer state, or a changed subscription, that the subscriber has not been sent.
  bool wants(std::uint64_t revision) const { return lacks(revision) || settingsChanged; }
  bool hasCredit(const Pace& pace) const;
  /// When a tick for the subscriber may begin; kNever where there is nothing to make, or no telling when.
  Clock::time_point dueAt(std::uint64_t revision, const Pace& pace) const;

  /// When its last frame may be made again, as calls get it, in a tick that makes nothing else; kNever where it is not
  /// wanted so, or there is something newer to make first.
  Clock::time_point sharpenAt(std::uint64_t revision) const;

  /// Whether a tick that begins now for others serves this one, too: its credit is out, and expected back before the
  /// tick ends.
  bool sharesTick(std::uint64_t revision, const Pace& pace, Clock::time_point now) const;

  /// Size and quality of the next frame.
  FrameShape frameShape() const;

  /// `result` is given to the sink now.
  void markSent(const Result& result, Clock::time_point now);
  /// Returns the credits of `resultId` and of everything before it. Seconds since that result was sent; null where none
  /// of these credits is out.
  std::optional<double> acknowledge(std::uint64_t resultId, Clock::time_point now);
  /// What was sent is lost: the next result is a whole one.
  void resend();

  /// Whether a result may be kept for the credit that comes back next: one for each, a volume as a delta to what its
  /// acknowledgement will name, unless that is lost.
  bool canStorePrefetch(const Pace& pace) const;
  /// Whether it is worth while to make a volume for this reader alone, and to encode it, before its credit is back:
  /// where a round trip lasts for more than a tick's interval, as a second credit asks for, and strays by less than
  /// there is to gain. Else it may get a newer one instead.
  bool worthAhead(const Pace& pace) const { return longTrip(pace) && roundTrip.deviation() < pace.makingSeconds; }
  /// Keeps a result for that credit; returns it as what it will be sent as.
  Result storePrefetch(Result result, Clock::time_point now);
  /// Drops a kept result that has waited for longer than a tick's interval while the scene went on: the reader gets a
  /// newer one, and whoever never acknowledges does not hold any.
  void dropStalePrefetch(std::uint64_t revision, const Pace& pace, Clock::time_point now);
  /// Takes what was kept for the credit that has just come back, and marks it as sent; null where it is old, or a delta
  /// to what the reader does not hold.
  std::optional<Result> takePrefetch(std::uint64_t revision, const Pace& pace, Clock::time_point now);

 private:
  void dropPrefetch();
  bool longTrip(const Pace& pace) const;
  Clock::time_point prefetchDueAt(const Pace& pace) const;
};
using SubscriberPtr = std::shared_ptr<Subscriber>;

}  // namespace lpv
