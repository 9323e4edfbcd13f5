#include "api/results/subscription_stream.h"

#include <spdlog/spdlog.h>

#include "api/services.h"
#include "convert/session.h"
#include "ops/log_scope.h"

namespace lpv::api {

template <typename Event>
Status SubscriptionStream<Event>::start(const Subscription& subscription, std::function<void()> wake) {
  {
    const MutexLock lock(mutex_);
    wake_ = wake;
  }
  heartbeat_.start(std::move(wake));
  const Expected<std::shared_ptr<Subscriber>> subscriber =
      session_->delivery().subscribe(subscription, this->shared_from_this());
  if (!subscriber) return subscriber.status();
  {
    const MutexLock lock(mutex_);
    subscriber_ = *subscriber;
  }
  return {};
}

template <typename Event>
bool SubscriptionStream<Event>::next(Event* event) {
  const MutexLock lock(mutex_);
  if (!subscriber_ || heartbeat_.over()) return false;
  if (!subscribedSent_) {
    subscribedSent_ = true;
    event->mutable_subscribed()->set_subscriber(subscriber_->id);
    event->mutable_subscribed()->set_epoch(session_->epoch());
    event->mutable_subscribed()->set_revision(session_->revision());
    return true;
  }
  while (!results_.empty()) {
    if (results_.front().parts(event)) {
      subscriber_->taken = results_.front().id;
      heartbeat_.quiet();
      return true;
    }
    results_.pop_front();
  }
  return heartbeat_.next(*session_, event);
}

template <typename Event>
void SubscriptionStream<Event>::push(std::uint64_t resultId, std::function<bool(Event*)> parts, SentAs as,
                                     std::int64_t bytes) {
  std::function<void()> wake;
  {
    const MutexLock lock(mutex_);
    if (resultId < newest_) {  // its credit comes back with the later one's acknowledgement
      ++context_.counters->resultsCoalesced;
      return;
    }
    newest_ = resultId;
    results_.push_back({resultId, std::move(parts)});
    wake = wake_;
  }
  context_.counters->countSent(as, bytes);
  if (wake) wake();
}

template <typename Event>
void SubscriptionStream<Event>::stop() {
  heartbeat_.stop();
  std::shared_ptr<Subscriber> subscriber;
  {
    const MutexLock lock(mutex_);
    wake_ = nullptr;
    subscriber = subscriber_;
  }
  if (subscriber) session_->delivery().unsubscribe(subscriber);
}

template <typename Event>
Status SubscriptionStream<Event>::update(const pb::SubscriberUpdate& update) {
  std::shared_ptr<Subscriber> subscriber;
  {
    const MutexLock lock(mutex_);
    subscriber = subscriber_;
  }
  return applyUpdate(session_, subscriber, update, context_.limits);
}

template class SubscriptionStream<pb::VolumeEvent>;
template class SubscriptionStream<pb::FrameEvent>;

void VolumeSubscription::offer(const Result& result) {
  const auto parts = std::make_shared<VolumeParts>(result, order_, chain_->encode(result, order_));
  push(
      result.meta.resultId,
      [parts](pb::VolumeEvent* event) {
        pb::VolumePart part;
        if (!parts->next(&part)) return false;
        *event->mutable_part() = std::move(part);
        return true;
      },
      sentAs(order_.format), parts->bytes());
}

void FrameSubscription::offer(const Result& result) {
  Expected<FrameFile> file = context_.caches->frames.get(result.frame, format_, result.quality, *context_.pool);
  if (!file) {
    const ops::LogScope scope({session()->id(), {}, {}});
    spdlog::error("frame of revision {} could not be encoded: {}", result.meta.revision, file.status().message());
    close(Closing::kEncodingFailed);
    return;
  }
  const auto parts = std::make_shared<FrameParts>(result, format_, *file);
  push(
      result.meta.resultId,
      [parts](pb::FrameEvent* event) {
        pb::FramePart part;
        if (!parts->next(&part)) return false;
        *event->mutable_part() = std::move(part);
        return true;
      },
      sentAs(format_), parts->bytes());
}

namespace {

Status checkCredits(std::uint32_t credits) {
  if (credits <= 2) return {};
  return invalid("credits", "credits is " + std::to_string(credits) + ", allowed are 1, 2 and 0 (for 1)");
}

}  // namespace

Expected<std::shared_ptr<VolumeSubscription>> openSubscription(const Context& context, const pb::VolumeSubscription& in,
                                                               std::function<void()> wake) {
  const Expected<SessionPtr> session = findSession(context, "session", in.session());
  if (!session) return session.status();
  const ClientIdentity client = fromProto(in.client());
  if (Status s = (*session)->verify(client); !s.ok()) return s;
  if (Status s = checkCredits(in.credits()); !s.ok()) return s;
  const Expected<VolumeEncodingRequest> order = encodingRequestFrom(in);
  if (!order) return order.status();
  Subscription subscription;
  subscription.volume = order->stage;
  subscription.guarded = order->guarded;
  subscription.clientId = client.id;
  subscription.maxRate = in.max_rate();
  subscription.twoCredits = in.credits() == 2;
  auto live = std::make_shared<VolumeSubscription>(context, *session, *order);
  if (Status s = live->start(subscription, std::move(wake)); !s.ok()) return s;
  return live;
}

Expected<std::shared_ptr<FrameSubscription>> openSubscription(const Context& context, const pb::FrameSubscription& in,
                                                              std::function<void()> wake) {
  const Expected<SessionPtr> session = findSession(context, "session", in.session());
  if (!session) return session.status();
  const ClientIdentity client = fromProto(in.client());
  if (Status s = (*session)->verify(client); !s.ok()) return s;
  if (Status s = checkCredits(in.credits()); !s.ok()) return s;
  const Expected<FrameEncodingRequest> order = encodingRequestFrom(in, context.limits);
  if (!order) return order.status();
  if (Status s = (*session)->delivery().checkCamera(order->subscription.camera); !s.ok()) return s;
  Subscription subscription;
  subscription.frame = order->subscription;
  subscription.frame->sharpen = in.sharpen();
  subscription.clientId = client.id;
  subscription.maxRate = in.max_rate();
  subscription.twoCredits = in.credits() == 2;
  if (Status s = checkRate(in.adapt_rate()); !s.ok()) return s.within("adapt_rate");
  if (in.adapt_rate() > 0.0 && order->format != pb::FRAME_FORMAT_JPEG) {
    return invalid("adapt_rate", "adapt_rate is given for a format that has no quality; want JPEG, or leave it out");
  }
  subscription.adaptRate = in.adapt_rate();
  auto live = std::make_shared<FrameSubscription>(context, *session, order->format);
  if (Status s = live->start(subscription, std::move(wake)); !s.ok()) return s;
  return live;
}

Status applyUpdate(const SessionPtr& session, const std::shared_ptr<Subscriber>& subscriber,
                   const pb::SubscriberUpdate& update, const Limits& limits) {
  if (Status s = checkRate(update.max_rate()); !s.ok()) return s;
  if (update.request_key_frame()) session->delivery().resend(subscriber);
  // Who acknowledges what was never taken would have results pile up here.
  const std::uint64_t acknowledged = update.acknowledge().result_id();
  if (update.has_acknowledge() && acknowledged <= subscriber->taken)
    session->delivery().acknowledge(subscriber, acknowledged);
  const bool rewishes = update.has_camera() || update.width() != 0 || update.height() != 0 || update.has_exposure() ||
                        update.max_rate() != 0.0;
  if (!rewishes) return {};
  const Subscription now = session->delivery().subscriptionOf(subscriber);
  FrameSettings subscription;
  if (now.frame) {
    const Expected<FrameSettings> next = updated(*now.frame, update, limits);
    if (!next) return next.status();
    subscription = *next;
  }
  return session->delivery().updateSubscription(
      subscriber, subscription, update.max_rate() != 0.0 ? std::optional(update.max_rate()) : std::nullopt);
}

}  // namespace lpv::api
