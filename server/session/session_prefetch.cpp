// Volumes for readers behind a long line. Between an acknowledgement and the next result lie a tick and its encoding;
// where the round trip is known well enough, they begin so much before the acknowledgement is expected, and what they
// make waits for it. One result ahead of each credit at most: the credit itself is as it was.

#include <algorithm>
#include <utility>

#include "session/session.h"

namespace lpv {
namespace {

constexpr double kSmoothing = 0.2;  // weight of a new time in the running mean

Clock::duration durationOf(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

void smooth(double& mean, Clock::duration measured) {
  const double seconds = std::chrono::duration<double>(measured).count();
  mean += (mean == 0.0 ? 1.0 : kSmoothing) * (seconds - mean);
}

}  // namespace

/// When a tick for the subscriber may begin; kNever where there is nothing to make, or no telling when.
Clock::time_point Session::dueAt(const Subscriber& subscriber) const {
  if (!wants(subscriber)) return kNever;
  return std::max(subscriber.notBefore, hasCredit(subscriber) ? Clock::time_point::min() : prefetchDueAt(subscriber));
}

/// The same for one whose credit is out. Only where a round trip lasts for more than a tick's interval, as a second
/// credit asks for, and strays by less than there is to gain.
Clock::time_point Session::prefetchDueAt(const Subscriber& subscriber) const {
  const RoundTrip& trip = subscriber.roundTrip;
  const double making = tickSeconds_ + encodeSeconds_;
  if (!canStorePrefetch(subscriber) || !longTrip(subscriber) || trip.deviation() >= making) return kNever;
  return subscriber.inFlight.front().at + durationOf(trip.mean() - trip.deviation() - making);
}

/// One for each credit, as a delta to what its acknowledgement will name, unless that is lost.
bool Session::canStorePrefetch(const Subscriber& subscriber) const {
  if (!subscriber.subscription.volume || hasCredit(subscriber)) return false;
  const std::uint64_t base = subscriber.inFlight.front().resultId;
  return base != subscriber.prefetchFor && base > subscriber.basesAfter;
}

/// Keeps a volume for a subscriber whose credit comes back soon, as the delta that it will be.
Result Session::storePrefetch(Subscriber& subscriber, Result result) {
  result.baseId = subscriber.prefetchFor = subscriber.inFlight.front().resultId;
  subscriber.prefetch = {result, Clock::now()};
  return result;
}

/// The scene went on, and it has waited for longer than a tick's interval: the reader gets a newer one. Whoever never
/// acknowledges must not hold a volume.
void Session::dropStalePrefetch(Subscriber& subscriber, Clock::time_point now) {
  if (!subscriber.prefetch || subscriber.prefetch->result.meta.revision == document_.revision()) return;
  if (now - subscriber.prefetch->at > durationOf(1.0 / limits_.maxTickRate)) subscriber.prefetch.reset();
}

/// What was kept for the credit that has just come back, unless it is old, or a delta to what the reader does not hold.
std::optional<Result> Session::takePrefetch(Subscriber& subscriber) {
  const Clock::time_point now = Clock::now();
  dropStalePrefetch(subscriber, now);
  const std::optional<Prefetch> kept = std::exchange(subscriber.prefetch, std::nullopt);
  if (!kept || closed_ || !hasCredit(subscriber) || now < subscriber.notBefore) return std::nullopt;
  if (kept->result.baseId != subscriber.baseId || kept->result.meta.revision <= subscriber.shownRevision) {
    return std::nullopt;
  }
  markSent(subscriber, kept->result, now);
  return kept->result;
}

void Session::tickTook(Clock::duration time) { smooth(tickSeconds_, time); }

void Session::encodingTook(Clock::duration time) {
  const MutexLock lock(mutex_);
  smooth(encodeSeconds_, time);
}

}  // namespace lpv
