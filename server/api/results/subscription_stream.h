#pragma once
// The sending end of a subscriber: results as events, heartbeats in between, a notice at the end. One credit means
// that at most two results can be here; what the client has not taken is never more than that.

#include <deque>
#include <functional>
#include <memory>

#include "api/call/context.h"
#include "api/results/heartbeat.h"
#include "api/results/result_caches.h"
#include "api/results/subscription.h"
#include "base/mutex.h"

namespace lpv::api {

/// What volume and frame subscriptions share. Event is VolumeEvent or FrameEvent.
template <typename Event>
class SubscriptionStream : public ResultSink, public std::enable_shared_from_this<SubscriptionStream<Event>> {
 public:
  SubscriptionStream(const Context& context, SessionPtr session)
      : context_(context), session_(std::move(session)), heartbeat_(*context.timers) {}

  /// Subscribes and starts the heartbeat; `wake` is called when next() may have something.
  Status start(const Subscription& subscription, std::function<void()> wake);
  /// The next event; false where there is none.
  bool next(Event* event);
  /// True after the closing notice has been taken.
  bool closed() const { return heartbeat_.over(); }
  Status endStatus() const { return heartbeat_.endStatus(); }
  Status update(const pb::SubscriberUpdate& update);
  void stop();

  void close(Closing why) override { heartbeat_.close(why); }
  const SessionPtr& session() const { return session_; }

 protected:
  /// Adds the messages of a finished result, unless a later one was encoded before it.
  void push(std::uint64_t resultId, std::function<bool(Event*)> parts, SentAs as, std::int64_t bytes);
  const Context context_;

 private:
  SessionPtr session_;
  std::shared_ptr<Subscriber> subscriber_ LPV_GUARDED_BY(mutex_);
  HeartbeatEmitter heartbeat_;
  Mutex mutex_;
  std::function<void()> wake_ LPV_GUARDED_BY(mutex_);
  struct Queued {
    std::uint64_t id;
    std::function<bool(Event*)> parts;
  };
  std::deque<Queued> results_ LPV_GUARDED_BY(mutex_);
  std::uint64_t newest_ LPV_GUARDED_BY(mutex_) = 0;  ///< result id
  bool subscribedSent_ LPV_GUARDED_BY(mutex_) = false;
};

class VolumeSubscription final : public SubscriptionStream<pb::VolumeEvent> {
 public:
  VolumeSubscription(const Context& context, SessionPtr session, const VolumeEncodingRequest& order)
      : SubscriptionStream(context, std::move(session)),
        order_(order),
        chain_(context.caches->chains.get(this->session(), order, *context.counters)) {}
  void offer(const Result& result) override;
  void prepare(const Result& result) override { (void)chain_->encode(result, order_); }

 private:
  VolumeEncodingRequest order_;
  std::shared_ptr<DeltaChain> chain_;
};

class FrameSubscription final : public SubscriptionStream<pb::FrameEvent> {
 public:
  FrameSubscription(const Context& context, SessionPtr session, pb::FrameFormat format)
      : SubscriptionStream(context, std::move(session)), format_(format) {}
  void offer(const Result& result) override;

 private:
  pb::FrameFormat format_;
};

/// The started stream of what a subscription asks for; errors by field.
Expected<std::shared_ptr<VolumeSubscription>> openSubscription(const Context& context,
                                                               const pb::VolumeSubscription& subscription,
                                                               std::function<void()> wake);
Expected<std::shared_ptr<FrameSubscription>> openSubscription(const Context& context,
                                                              const pb::FrameSubscription& subscription,
                                                              std::function<void()> wake);

/// An update's effect on a live subscriber.
Status applyUpdate(const SessionPtr& session, const std::shared_ptr<Subscriber>& subscriber,
                   const pb::SubscriberUpdate& update, const Limits& limits);

}  // namespace lpv::api
