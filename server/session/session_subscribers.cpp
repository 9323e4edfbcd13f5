// Who watches a session, what each has been sent and what it may be sent next: one credit each, two over a long line
// (PROTOCOL.md, Results).

#include <utility>

#include "session/session.h"

namespace lpv {

Expected<std::shared_ptr<Subscriber>> Session::subscribe(const Wish& wish, const std::shared_ptr<ResultSink>& sink) {
  const std::lock_guard lock(mutex_);
  if (closed_) return closedStatus("session");
  if (std::ssize(subscribers_) >= workshop_.limits.maxSubscribersPerSession) {
    return exhausted("max_subscribers_per_session", "max_subscribers_per_session: allowed are " +
                                                        std::to_string(workshop_.limits.maxSubscribersPerSession) +
                                                        " result streams");
  }
  auto subscriber = std::make_shared<Subscriber>();
  subscriber->key = nextKey_++;
  subscriber->id = "s-" + std::to_string(subscriber->key) + "-" + randomHex(4);
  subscriber->wish = wish;
  subscriber->sink = sink;
  if (wish.frame && wish.adaptRate > 0.0) subscriber->adapter.emplace(wish.adaptRate);
  subscribers_[subscriber->id] = subscriber;
  kick();
  return subscriber;
}

void Session::unsubscribe(const std::shared_ptr<Subscriber>& subscriber) {
  const std::lock_guard lock(mutex_);
  subscribers_.erase(subscriber->id);
  clients_.hear(subscriber->wish.clientId, Clock::now());
  lastUsed_ = std::chrono::system_clock::now();
  workshop_.engine->forgetView(key_, subscriber->key);
}

std::shared_ptr<Subscriber> Session::findSubscriber(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = subscribers_.find(id);
  return found == subscribers_.end() ? nullptr : found->second;
}

void Session::acknowledge(const std::shared_ptr<Subscriber>& subscriber, std::uint64_t resultId) {
  std::vector<Delivery> ready;
  {
    const std::lock_guard lock(mutex_);
    if (!takeBack(*subscriber, resultId)) return;
    std::optional<Result> ahead = takeAhead(*subscriber);
    if (ahead) ready.push_back({subscriber, std::move(*ahead), Delivery::kOfferPrepared});
    kick();
  }
  deliver(std::move(ready));
}

/// The credits of `resultId` and of everything before it; false where none of them is out.
bool Session::takeBack(Subscriber& subscriber, std::uint64_t resultId) {
  std::deque<Sent>& inFlight = subscriber.inFlight;
  if (inFlight.empty() || resultId < inFlight.front().resultId || resultId > inFlight.back().resultId) return false;
  Clock::time_point sentAt;
  while (!inFlight.empty() && inFlight.front().resultId <= resultId) {
    sentAt = inFlight.front().at;
    inFlight.pop_front();
  }
  if (resultId > subscriber.basesAfter) subscriber.baseId = resultId;
  const double seconds = std::chrono::duration<double>(Clock::now() - sentAt).count();
  subscriber.roundTrip.measured(seconds);
  workshop_.counters->acknowledgeLag.observe(seconds);
  if (subscriber.adapter) subscriber.adapter->acknowledged(seconds);
  return true;
}

void Session::resend(const std::shared_ptr<Subscriber>& subscriber) {
  const std::lock_guard lock(mutex_);
  subscriber->shownAny = false;
  subscriber->baseId = 0;
  subscriber->basesAfter = subscriber->lastSent;
  kick();
}

Status Session::rewish(const std::shared_ptr<Subscriber>& subscriber, const FrameWish& wish,
                       std::optional<double> maxRate) {
  const std::lock_guard lock(mutex_);
  if (maxRate) subscriber->wish.maxRate = *maxRate;
  if (!subscriber->wish.frame) return {};
  FrameWish next = wish;
  if (next.cameraSequence < subscriber->wish.frame->cameraSequence) {
    next.camera = subscriber->wish.frame->camera;
    next.cameraSequence = subscriber->wish.frame->cameraSequence;
  }
  subscriber->wish.frame = next;
  subscriber->wishChanged = true;
  kick();
  return {};
}

Wish Session::wishOf(const std::shared_ptr<Subscriber>& subscriber) const {
  const std::lock_guard lock(mutex_);
  return subscriber->wish;
}

/// Newer state, or a changed wish, that the subscriber has not been sent.
bool Session::wants(const Subscriber& subscriber) const {
  return !subscriber.shownAny || subscriber.shownRevision < document_.revision() || subscriber.wishChanged;
}

bool Session::hasCredit(const Subscriber& subscriber) const {
  if (subscriber.inFlight.empty()) return true;
  return subscriber.wish.twoCredits && subscriber.inFlight.size() == 1 && longTrip(subscriber);
}

/// Its round trip lasts for more than one of its intervals.
bool Session::longTrip(const Subscriber& subscriber) const {
  const double rate = subscriber.wish.maxRate > 0.0 ? subscriber.wish.maxRate : workshop_.limits.maxTickRate;
  return subscriber.roundTrip.mean() > 1.0 / rate;
}

}  // namespace lpv
