// Subscriptions as streams: the bidirectional form and its server-streaming twin of the same.

#include "api/results/subscription_stream.h"
#include "api/services.h"
#include "base/text.h"
#include "convert/session.h"

namespace lpv::api {
namespace {

/// A stream of results that begins once its subscription has arrived. Traits say how messages carry what.
template <typename Traits>
class ResultStream final : public StreamOf<ResultStream<Traits>, typename Traits::Request, typename Traits::Response> {
 public:
  explicit ResultStream(const Context& context) : context_(context) {}

  void receive(typename Traits::Request request) override {
    if (this->hasEnded()) return;
    if (const auto live = current()) {
      const pb::SubscriberUpdate* update = Traits::update(request);
      const Status status =
          update ? live->update(*update) : invalid("subscription", "a subscription comes once, as the first message");
      // A refused camera or size ends nothing a client could still want: it is told, and reopens with a right one.
      if (!status.ok()) this->end(status.within("update"));
      return;
    }
    const typename Traits::Subscription* subscription = Traits::subscription(request);
    if (!subscription) return this->end(invalid("subscription", "the first message has no subscription"));
    auto opened = openSubscription(context_, *subscription, this->wakeWhileAlive());
    if (!opened) return this->end(opened.status().within("subscription"));
    {
      const MutexLock lock(mutex_);
      subscription_ = *opened;
    }
    this->wake();
  }

  void halfClosed() override {
    if (!Traits::kBidirectional) return;
    if (const auto live = current()) return live->close(Closing::kClientClosed);
    this->end(invalid("subscription", "the client closed its side before it sent a subscription"));
  }

  bool next(typename Traits::Response* response) override {
    const std::shared_ptr<typename Traits::Live> live = current();
    if (!live || this->hasEnded()) return false;
    if (live->next(response->mutable_event())) return true;
    response->clear_event();
    if (live->closed()) this->endInNext(live->endStatus());
    return false;
  }

  void release() override {
    if (const auto live = current()) live->stop();
  }

 private:
  std::shared_ptr<typename Traits::Live> current() {
    const MutexLock lock(mutex_);
    return subscription_;
  }

  const Context context_;
  Mutex mutex_;
  std::shared_ptr<typename Traits::Live> subscription_ LPV_GUARDED_BY(mutex_);
};

/// Of a call whose client says one thing, and then only reads.
template <typename Req, typename Resp, typename Sub, typename F>
struct WatchTraits {
  using Request = Req;
  using Response = Resp;
  using Subscription = Sub;
  using Live = F;
  static constexpr bool kBidirectional = false;
  static const Sub* subscription(const Req& request) {
    return request.has_subscription() ? &request.subscription() : nullptr;
  }
  static const pb::SubscriberUpdate* update(const Req&) { return nullptr; }
};

/// Of a call whose client acknowledges, and changes its subscription, on the same stream.
template <typename Req, typename Resp, typename Sub, typename F>
struct BidiTraits : WatchTraits<Req, Resp, Sub, F> {
  static constexpr bool kBidirectional = true;
  static const pb::SubscriberUpdate* update(const Req& request) {
    return request.has_update() ? &request.update() : nullptr;
  }
};

template <typename Traits>
std::shared_ptr<ResultStream<Traits>> make(const Context& context) {
  return std::make_shared<ResultStream<Traits>>(context);
}

}  // namespace

StreamPtr<pb::WatchVolumeRequest, pb::WatchVolumeResponse> watchVolume(const Context& context) {
  return make<WatchTraits<pb::WatchVolumeRequest, pb::WatchVolumeResponse, pb::VolumeSubscription, VolumeSubscription>>(
      context);
}

StreamPtr<pb::StreamVolumeRequest, pb::StreamVolumeResponse> streamVolume(const Context& context) {
  return make<
      BidiTraits<pb::StreamVolumeRequest, pb::StreamVolumeResponse, pb::VolumeSubscription, VolumeSubscription>>(
      context);
}

StreamPtr<pb::WatchFramesRequest, pb::WatchFramesResponse> watchFrames(const Context& context) {
  return make<WatchTraits<pb::WatchFramesRequest, pb::WatchFramesResponse, pb::FrameSubscription, FrameSubscription>>(
      context);
}

StreamPtr<pb::StreamFramesRequest, pb::StreamFramesResponse> streamFrames(const Context& context) {
  return make<BidiTraits<pb::StreamFramesRequest, pb::StreamFramesResponse, pb::FrameSubscription, FrameSubscription>>(
      context);
}

Status updateSubscription(const Context& context, const pb::UpdateSubscriptionRequest& request,
                          pb::UpdateSubscriptionResponse*) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return session.status();
  const std::shared_ptr<Subscriber> subscriber = (*session)->delivery().findSubscriber(request.subscriber());
  if (!subscriber) {
    return Status(Code::kNotFound,
                  "there is no subscriber \"" + truncatedUtf8(request.subscriber()) + "\"; its stream may have ended",
                  "subscriber");
  }
  const ClientIdentity client = fromProto(request.client());
  if (Status s = (*session)->verify(client); !s.ok()) return s;
  if (client.id != (*session)->delivery().subscriptionOf(subscriber).clientId) {
    return Status(Code::kPermissionDenied,
                  "subscriber \"" + truncatedUtf8(request.subscriber()) +
                      "\" was opened with another identity than client; send that of its subscription",
                  "client");
  }
  return applyUpdate(*session, subscriber, request.update(), context.limits).within("update");
}

}  // namespace lpv::api
