// How a session decides what its next tick makes, and for whom: one credit per subscriber, newest wins, nothing is
// made that nobody waits for (PROTOCOL.md, Results).

#include <algorithm>
#include <utility>

#include "session/delivery/self_check.h"
#include "session/session.h"

namespace lpv {
namespace {

constexpr std::chrono::milliseconds kRetryAfterFailure{1000};  // a failed tick is not repeated at once

/// Of the frames that calls wait for, pixels that one tick makes: its targets are held until it ends. The others wait.
constexpr std::int64_t kMostCallPixels = std::int64_t(4096) * 4096;

std::int64_t pixelsOf(const FrameSettings& subscription) {
  return std::int64_t(subscription.size.x) * subscription.size.y;
}

Clock::duration interval(double rate) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / rate));
}

/// On the GL thread.
void countTick(Counters& counters, Clock::time_point begun, const Expected<TickResult>& result) {
  const Clock::time_point now = Clock::now();
  counters.tickWatch.ended(now, result.status());
  if (!result) return;
  counters.tickSeconds.observe(std::chrono::duration<double>(now - begun).count());
  for (const StageTime& stage : result->report.stages) counters.countStage(stage.stage, stage.seconds);
}

int qualityFor(const Subscriber& subscriber) {
  const FrameSettings& subscription = *subscriber.subscription.frame;
  return subscriber.adapter ? subscriber.adapter->shapeFor({subscription.size, subscription.quality}).quality
                            : subscription.quality;
}

std::int64_t nowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

std::shared_ptr<WaitingCall> Session::ask(WaitingCall call) {
  auto waiting = std::make_shared<WaitingCall>(std::move(call));
  const MutexLock lock(mutex_);
  if (closed_) {
    services_.pool->post([waiting, gone = closedStatus("session")] { waiting->done(gone); });
    return waiting;
  }
  lastUsed_ = std::chrono::system_clock::now();
  calls_.push_back(waiting);
  scheduleTick();
  return waiting;
}

void Session::forget(const std::shared_ptr<WaitingCall>& call) {
  const MutexLock lock(mutex_);
  calls_.remove(call);
}

void Session::scheduleTickAt(Clock::time_point when) {
  if (tickScheduledAt_ && *tickScheduledAt_ <= when) return;
  tickScheduledAt_ = when;
  services_.timers->at(when, [weak = weak_from_this()] {
    const SessionPtr self = weak.lock();
    if (!self) return;
    const MutexLock lock(self->mutex_);
    self->tickScheduledAt_.reset();
    self->scheduleTick();
  });
}

/// Starts a tick where one is due. Called with the lock held, after everything that may make one due.
void Session::scheduleTick() {
  if (tickUnderWay_ || closed_) return;
  std::optional<TickPlan> plan = planTick(Clock::now());
  if (!plan) return;
  tickUnderWay_ = true;
  const Clock::time_point now = Clock::now();
  plan->begun = now;
  nextTick_ = now + interval(limits_.maxTickRate);
  services_.counters->tickWatch.begun(now);
  TickRequest request = plan->request;
  services_.engine->submit(
      std::move(request), [weak = weak_from_this(), pool = services_.pool, counters = services_.counters, now,
                           shared = std::make_shared<const TickPlan>(std::move(*plan))](Expected<TickResult> result) {
        countTick(*counters, now, result);
        pool->post([weak, shared, moved = std::make_shared<Expected<TickResult>>(std::move(result))] {
          if (const SessionPtr self = weak.lock()) self->tickDone(*shared, std::move(*moved));
        });
      });
}

std::optional<Session::TickPlan> Session::planTick(Clock::time_point now) {
  TickPlan plan;
  Clock::time_point next = kNever;
  if (now < nextTick_) {
    for (const auto& [id, subscriber] : subscribers_) next = std::min(next, dueAt(*subscriber));
    if (!calls_.empty()) next = now;
    if (next != kNever) scheduleTickAt(std::max(next, nextTick_));
    return std::nullopt;
  }
  planSubscribers(plan, now, next);
  planCalls(plan);
  const TickRequest& request = plan.request;
  if (!request.transported && !request.injected && request.frames.empty()) {
    if (next != kNever) scheduleTickAt(next);
    return std::nullopt;
  }
  plan.request.session = key_;
  plan.request.scene = document_.snapshot();
  if (limits_.selfCheck.count() > 0 && now >= nextUnaskedCheck_) {
    nextUnaskedCheck_ = now + kUnaskedChecks * limits_.selfCheck;
    if (canSelfCheck(*plan.request.scene)) plan.request.transported = true;
  }
  plan.epoch = epoch_;
  plan.lookup = document_.options().lookup;
  plan.clientSequences = members_.sequencesSince(0);
  return plan;
}

void Session::planSubscribers(TickPlan& plan, Clock::time_point now, Clock::time_point& next) {
  for (const auto& [id, subscriber] : subscribers_) {
    if (const Clock::time_point due = dueAt(*subscriber); now < due) {
      next = std::min(next, due);
      continue;
    }
    if (subscriber->subscription.frame && !hasView(*subscriber->subscription.frame, 0)) continue;
    if (subscriber->subscription.volume) {
      addVolume(plan.request, *subscriber->subscription.volume);
      if (!hasCredit(*subscriber)) plan.prefetchFor.push_back(subscriber);
    } else {
      plan.request.frames.push_back(frameRequest(*subscriber));
      plan.frameReaders.emplace_back(subscriber, subscriber->subscription.frame->cameraSequence);
      subscriber->settingsChanged = false;
    }
  }
}

void Session::planCalls(TickPlan& plan) {
  std::int64_t framePixels = 0;
  for (auto it = calls_.begin(); it != calls_.end();) {
    const std::shared_ptr<WaitingCall> call = *it;
    const bool early = call->minRevision > document_.revision();
    const bool full = call->frame && framePixels > 0 && framePixels + pixelsOf(*call->frame) > kMostCallPixels;
    if (early || full || (call->frame && !hasView(*call->frame, call->minRevision))) {
      ++it;
      continue;
    }
    it = calls_.erase(it);
    if (call->frame) {
      plan.request.frames.push_back(frameRequest(*call->frame, 0));
      plan.frameCalls.push_back(call);
      framePixels += pixelsOf(*call->frame);
    } else if (const std::optional<Result> cached = cachedVolume(*call->volume, call->minRevision)) {
      services_.pool->post([call, result = *cached] { call->done(result); });
    } else {
      addVolume(plan.request, *call->volume);
      plan.volumeCalls.push_back(call);
    }
  }
}

void Session::addVolume(TickRequest& request, VolumeStage stage) {
  (stage == VolumeStage::kInjected ? request.injected : request.transported) = true;
}

std::optional<Result> Session::cachedVolume(VolumeStage stage, std::uint64_t minRevision) const {
  const auto found = latest_.find(stage);
  if (found == latest_.end() || found->second.meta.revision < minRevision) return std::nullopt;
  return found->second;
}

void Session::tickDone(const TickPlan& plan, Expected<TickResult> result) {
  if (!result) {
    fail(plan, result.status());
    return;
  }
  ++services_.counters->ticks;
  std::vector<Delivery> deliveries;
  {
    const MutexLock lock(mutex_);
    tickUnderWay_ = false;
    tickTook(Clock::now() - plan.begun);
    deliveries = planDeliveries(plan, *result);
  }
  deliver(std::move(deliveries));
  const MutexLock lock(mutex_);
  scheduleTick();
}

/// Gives each result its name and picks who gets it.
std::vector<Session::Delivery> Session::planDeliveries(const TickPlan& plan, TickResult& tick) {
  ResultMeta meta;
  meta.epoch = plan.epoch;
  meta.revision = tick.revision;
  meta.completedNs = nowNs();
  meta.report = std::make_shared<const TickReport>(std::move(tick.report));
  meta.lookup = plan.lookup;
  std::vector<Delivery> out;
  if (tick.transported) planVolumeDeliveries(plan, meta, VolumeStage::kTransported, tick.transported, &out);
  if (tick.injected) planVolumeDeliveries(plan, meta, VolumeStage::kInjected, tick.injected, &out);
  planFrameDeliveries(plan, meta, tick.frames, &out);
  countCoalesced(tick.revision, Clock::now());
  if (tick.transported) checkLater(plan.request.scene, tick.transported);
  return out;
}

/// Now and then, on a worker, one at a time.
void Session::checkLater(const ScenePtr& scene, const VolumePtr& volume) {
  const Clock::time_point now = Clock::now();
  const std::chrono::seconds interval = limits_.selfCheck;
  if (interval.count() == 0 || checking_ || now < nextCheck_) return;
  checking_ = true;
  nextCheck_ = now + interval;
  nextUnaskedCheck_ = now + kUnaskedChecks * interval;
  services_.pool->post([self = shared_from_this(), scene, volume] {
    const std::optional<double> error = selfCheck(*scene, *volume, std::uint32_t(scene->revision));
    const MutexLock lock(self->mutex_);
    self->checking_ = false;
    self->measured_ = error ? std::optional(MeasuredError{*error, scene->revision}) : std::nullopt;
  });
}

/// A volume goes to every reader with credit that lacks it, also to those that came or got their credit back while the
/// tick ran, and to the calls that waited; it is kept for readers whose credit is about to come back.
void Session::planVolumeDeliveries(const TickPlan& plan, ResultMeta meta, VolumeStage stage, const VolumePtr& volume,
                                   std::vector<Delivery>* out) {
  const Clock::time_point now = Clock::now();
  meta.resultId = nextResult_++;
  const Result& latest = latest_[stage] = {meta, volume, nullptr, 0, 0, 0};
  for (const auto& [id, subscriber] : subscribers_) {
    dropStalePrefetch(*subscriber, now);
    const bool lacks = !subscriber->shownAny || subscriber->shownRevision < meta.revision;
    const bool due = now >= dueAt(*subscriber) || (plan.prefetchesFor(*subscriber) && canStorePrefetch(*subscriber));
    if (subscriber->subscription.volume != stage || !lacks || !due) continue;
    Result result = latest;
    result.meta.clientSequence = plan.sequenceOf(subscriber->subscription.clientId);
    if (!hasCredit(*subscriber)) {
      out->push_back({subscriber, storePrefetch(*subscriber, std::move(result)), Delivery::kPrepare});
      continue;
    }
    result.baseId = subscriber->baseId;
    markSent(*subscriber, result, now);
    out->push_back({subscriber, std::move(result)});
  }
  for (const auto& call : plan.volumeCalls) {
    if (call->volume == stage) services_.pool->post([call, latest] { call->done(latest); });
  }
}

/// The frames of a tick are its subscribers', in the order planned, then its calls'.
void Session::planFrameDeliveries(const TickPlan& plan, ResultMeta meta, const std::vector<FramePtr>& frames,
                                  std::vector<Delivery>* out) {
  const Clock::time_point now = Clock::now();
  auto frame = frames.begin();
  for (const auto& [subscriber, cameraSequence] : plan.frameReaders) {
    meta.resultId = nextResult_++;
    meta.clientSequence = plan.sequenceOf(subscriber->subscription.clientId);
    Result result{meta, nullptr, *frame++, cameraSequence, qualityFor(*subscriber), 0};
    if (!subscribers_.contains(subscriber->id)) continue;
    markSent(*subscriber, result, now);
    out->push_back({subscriber, std::move(result)});
  }
  for (const auto& call : plan.frameCalls) {
    meta.resultId = nextResult_++;
    meta.clientSequence = 0;
    services_.pool->post(
        [call, result = Result{meta, nullptr, *frame++, 0, call->frame->quality, 0}] { call->done(result); });
  }
}

/// Readers whom the tick passed by, because they have not acknowledged what they were sent, or want fewer a second.
void Session::countCoalesced(std::uint64_t revision, Clock::time_point now) {
  for (const auto& [id, subscriber] : subscribers_) {
    const bool lacks = !subscriber->shownAny || subscriber->shownRevision < revision;
    if (lacks && !subscriber->prefetch && now < dueAt(*subscriber)) ++services_.counters->resultsCoalesced;
  }
}

void Session::markSent(Subscriber& subscriber, const Result& result, Clock::time_point now) {
  subscriber.prefetch.reset();
  subscriber.inFlight.push_back({result.meta.resultId, now});
  subscriber.lastSent = result.meta.resultId;
  subscriber.shownRevision = result.meta.revision;
  subscriber.shownAny = true;
  if (subscriber.subscription.maxRate > 0.0) subscriber.notBefore = now + interval(subscriber.subscription.maxRate);
}

void Session::fail(const TickPlan& plan, const Status& status) {
  if (services_.onEvent && status.code() != Code::kCancelled)
    services_.onEvent(SessionEvent::kTickFailed, id_, status.message());
  for (const auto& call : plan.volumeCalls) call->done(status);
  for (const auto& call : plan.frameCalls) call->done(status);
  const MutexLock lock(mutex_);
  for (const auto& [subscriber, cameraSequence] : plan.frameReaders) subscriber->settingsChanged = true;
  tickUnderWay_ = false;
  nextTick_ = Clock::now() + kRetryAfterFailure;
  scheduleTick();
}

/// Each on a worker of its own: encoding one reader's frame keeps no other reader waiting. The first is timed: it
/// encodes the volume that others share.
void Session::deliver(std::vector<Delivery> deliveries) {
  for (std::size_t i = 0; i < deliveries.size(); ++i) {
    if (deliveries[i].how != Delivery::kPrepare) ++services_.counters->resultsSent;
    const bool timed = i == 0 && deliveries[i].how != Delivery::kOfferPrepared && deliveries[i].result.volume;
    services_.pool->post([weak = weak_from_this(), timed, delivery = std::move(deliveries[i])] {
      const std::shared_ptr<ResultSink> sink = delivery.subscriber->sink.lock();
      if (!sink) return;
      const Clock::time_point begun = Clock::now();
      delivery.how == Delivery::kPrepare ? sink->prepare(delivery.result) : sink->offer(delivery.result);
      const SessionPtr self = timed ? weak.lock() : nullptr;
      if (self) self->encodingTook(Clock::now() - begun);
    });
  }
}

}  // namespace lpv
