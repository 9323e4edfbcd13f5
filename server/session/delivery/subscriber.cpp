#include "session/delivery/subscriber.h"

#include <algorithm>
#include <utility>

namespace lpv {
namespace {

constexpr std::chrono::milliseconds kAtRest{250};  // without a newer frame

Clock::duration durationOf(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

bool Subscriber::hasCredit(const Pace& pace) const {
  if (inFlight.empty()) return true;
  return subscription.twoCredits && inFlight.size() == 1 && longTrip(pace);
}

/// Its round trip lasts for more than one of its intervals.
bool Subscriber::longTrip(const Pace& pace) const {
  const double rate = subscription.maxRate > 0.0 ? subscription.maxRate : pace.tickRate;
  return roundTrip.mean() > 1.0 / rate;
}

Clock::time_point Subscriber::dueAt(std::uint64_t revision, const Pace& pace) const {
  if (!wants(revision)) return kNever;
  return std::max(pacer.next(), hasCredit(pace) ? Clock::time_point::min() : prefetchDueAt(pace));
}

/// dueAt() of a subscriber whose credit is out.
Clock::time_point Subscriber::prefetchDueAt(const Pace& pace) const {
  if (!subscription.volume || !canStorePrefetch(pace) || !worthAhead(pace)) return kNever;
  return inFlight.front().at + durationOf(roundTrip.mean() - roundTrip.deviation() - pace.makingSeconds);
}

Clock::time_point Subscriber::sharpenAt(std::uint64_t revision) const {
  const bool wanted = subscription.frame && subscription.frame->sharpen && rough;
  if (!wanted || wants(revision) || !inFlight.empty()) return kNever;
  return std::max(pacer.next(), sentAt + kAtRest);
}

bool Subscriber::sharesTick(std::uint64_t revision, const Pace& pace, Clock::time_point now) const {
  if (!wants(revision) || !canStorePrefetch(pace) || roundTrip.mean() == 0.0 || now < pacer.next()) return false;
  const Clock::time_point back = inFlight.front().at + durationOf(roundTrip.mean() + roundTrip.deviation());
  return back <= now + durationOf(pace.tickSeconds);
}

FrameShape Subscriber::frameShape() const {
  const FrameShape wanted{subscription.frame->size, subscription.frame->quality};
  return adapter ? adapter->shapeFor(wanted) : wanted;
}

void Subscriber::markSent(const Result& result, Clock::time_point now) {
  prefetch.reset();
  inFlight.push_back({result.meta.resultId, now, result.sharp});
  sentAt = now;
  rough = result.frame && !result.sharp;
  lastSent = result.meta.resultId;
  shownRevision = result.meta.revision;
  shownAny = true;
  if (subscription.maxRate > 0.0) pacer.begin(now, intervalOf(subscription.maxRate));
}

std::optional<double> Subscriber::acknowledge(std::uint64_t resultId, Clock::time_point now) {
  if (inFlight.empty() || resultId < inFlight.front().resultId || resultId > inFlight.back().resultId) {
    return std::nullopt;
  }
  Sent last;
  while (!inFlight.empty() && inFlight.front().resultId <= resultId) {
    last = inFlight.front();
    inFlight.pop_front();
  }
  if (resultId > basesAfter) baseId = resultId;
  const double seconds = std::chrono::duration<double>(now - last.at).count();
  if (last.sharp) return seconds;
  roundTrip.measured(seconds);
  if (adapter) adapter->acknowledged(seconds);
  return seconds;
}

void Subscriber::resend() {
  shownAny = false;
  baseId = 0;
  basesAfter = lastSent;
}

bool Subscriber::canStorePrefetch(const Pace& pace) const {
  if (hasCredit(pace)) return false;
  const std::uint64_t base = inFlight.front().resultId;
  return base != prefetchFor && base > basesAfter;
}

Result Subscriber::storePrefetch(Result result, Clock::time_point now) {
  result.baseId = prefetchFor = inFlight.front().resultId;
  prefetch = {result, now};
  return result;
}

void Subscriber::dropStalePrefetch(std::uint64_t revision, const Pace& pace, Clock::time_point now) {
  if (!prefetch || prefetch->result.meta.revision == revision) return;
  if (now - prefetch->at > intervalOf(pace.tickRate)) dropPrefetch();
}

/// A frame may have been all that shows the newest camera.
void Subscriber::dropPrefetch() {
  settingsChanged = settingsChanged || subscription.frame;
  prefetch.reset();
}

std::optional<Result> Subscriber::takePrefetch(std::uint64_t revision, const Pace& pace, Clock::time_point now) {
  dropStalePrefetch(revision, pace, now);
  if (!prefetch) return std::nullopt;
  const Result kept = prefetch->result;
  const bool newer = kept.meta.revision > shownRevision || (kept.frame && kept.meta.revision == shownRevision);
  if (!hasCredit(pace) || now < pacer.next() || kept.baseId != baseId || !newer) {
    dropPrefetch();
    return std::nullopt;
  }
  markSent(kept, now);
  return kept;
}

}  // namespace lpv
