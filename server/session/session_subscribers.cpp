// Who watches a session, what each has been sent and what it may be sent next: one credit each, two over a long line
// (PROTOCOL.md, Results).

#include <utility>

#include "session/session.h"

namespace lpv {

Expected<std::shared_ptr<Subscriber>> Session::subscribe(const Subscription& subscription,
                                                         const std::shared_ptr<ResultSink>& sink) {
  const MutexLock lock(mutex_);
  if (closed_) return closedStatus("session");
  if (std::ssize(subscribers_) >= limits_.maxSubscribersPerSession) {
    return exhausted("max_subscribers_per_session", "max_subscribers_per_session: allowed are " +
                                                        std::to_string(limits_.maxSubscribersPerSession) +
                                                        " result streams");
  }
  auto subscriber = std::make_shared<Subscriber>();
  subscriber->key = nextKey_++;
  subscriber->id = "s-" + std::to_string(subscriber->key) + "-" + randomHex(4);
  subscriber->subscription = subscription;
  subscriber->sink = sink;
  if (subscription.frame && subscription.adaptRate > 0.0) subscriber->adapter.emplace(subscription.adaptRate);
  subscribers_[subscriber->id] = subscriber;
  scheduleTick();
  return subscriber;
}

void Session::unsubscribe(const std::shared_ptr<Subscriber>& subscriber) {
  const MutexLock lock(mutex_);
  subscribers_.erase(subscriber->id);
  members_.markActive(subscriber->subscription.clientId, Clock::now());
  lastUsed_ = std::chrono::system_clock::now();
  services_.engine->forgetView(key_, subscriber->key);
}

std::shared_ptr<Subscriber> Session::findSubscriber(const std::string& id) const {
  const MutexLock lock(mutex_);
  const auto found = subscribers_.find(id);
  return found == subscribers_.end() ? nullptr : found->second;
}

void Session::acknowledge(const std::shared_ptr<Subscriber>& subscriber, std::uint64_t resultId) {
  std::vector<Delivery> ready;
  {
    const MutexLock lock(mutex_);
    if (!returnCredits(*subscriber, resultId)) return;
    std::optional<Result> ahead = takePrefetch(*subscriber);
    if (ahead) ready.push_back({subscriber, std::move(*ahead), Delivery::kOfferPrepared});
    scheduleTick();
  }
  deliver(std::move(ready));
}

/// The credits of `resultId` and of everything before it; false where none of them is out.
bool Session::returnCredits(Subscriber& subscriber, std::uint64_t resultId) {
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
  services_.counters->acknowledgeLag.observe(seconds);
  if (subscriber.adapter) subscriber.adapter->acknowledged(seconds);
  return true;
}

void Session::resend(const std::shared_ptr<Subscriber>& subscriber) {
  const MutexLock lock(mutex_);
  subscriber->shownAny = false;
  subscriber->baseId = 0;
  subscriber->basesAfter = subscriber->lastSent;
  scheduleTick();
}

Status Session::updateSubscription(const std::shared_ptr<Subscriber>& subscriber, const FrameSettings& subscription,
                                   std::optional<double> maxRate) {
  const MutexLock lock(mutex_);
  if (maxRate) subscriber->subscription.maxRate = *maxRate;
  if (!subscriber->subscription.frame) return {};
  FrameSettings next = subscription;
  if (next.cameraSequence < subscriber->subscription.frame->cameraSequence) {
    next.camera = subscriber->subscription.frame->camera;
    next.cameraSequence = subscriber->subscription.frame->cameraSequence;
  }
  subscriber->subscription.frame = next;
  subscriber->settingsChanged = true;
  scheduleTick();
  return {};
}

Subscription Session::subscriptionOf(const std::shared_ptr<Subscriber>& subscriber) const {
  const MutexLock lock(mutex_);
  return subscriber->subscription;
}

/// Newer state, or a changed subscription, that the subscriber has not been sent.
bool Session::wants(const Subscriber& subscriber) const {
  return !subscriber.shownAny || subscriber.shownRevision < document_.revision() || subscriber.settingsChanged;
}

bool Session::hasCredit(const Subscriber& subscriber) const {
  if (subscriber.inFlight.empty()) return true;
  return subscriber.subscription.twoCredits && subscriber.inFlight.size() == 1 && longTrip(subscriber);
}

/// Its round trip lasts for more than one of its intervals.
bool Session::longTrip(const Subscriber& subscriber) const {
  const double rate = subscriber.subscription.maxRate > 0.0 ? subscriber.subscription.maxRate : limits_.maxTickRate;
  return subscriber.roundTrip.mean() > 1.0 / rate;
}

}  // namespace lpv
