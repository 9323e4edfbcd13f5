#include "session/delivery/delivery.h"

#include <algorithm>
#include <utility>

#include "session/delivery/self_check.h"

namespace lpv {
namespace {

constexpr std::chrono::milliseconds kRetryAfterFailure{1000};  // a failed tick is not repeated at once
constexpr double kTimeSmoothing = 0.2;                             // weight of a new time in the running mean

double aspectOf(const glm::ivec2& size) { return double(size.x) / size.y; }

void smooth(double& mean, Clock::duration measured) {
  const double seconds = std::chrono::duration<double>(measured).count();
  mean += (mean == 0.0 ? 1.0 : kTimeSmoothing) * (seconds - mean);
}

/// The number of the frame that shows what is wanted, with a view of its own where there is none yet.
std::size_t addShared(const FrameRequest& wanted, std::uint64_t view, std::vector<FrameRequest>& frames) {
  for (std::size_t i = 0; i < frames.size(); ++i) {
    FrameRequest there = frames[i];
    there.view = wanted.view;
    if (there == wanted) return i;
  }
  frames.push_back(wanted);
  frames.back().view = view;
  return frames.size() - 1;
}

/// On the GL thread. Nobody waits for a sharp frame, and it may take longer than what makes a device look stalled: it
/// counts as asked for when it is over.
void countTick(Counters& counters, const TickPlan& plan, const Expected<TickResult>& result) {
  const Clock::time_point now = Clock::now();
  if (plan.sharp) counters.tickWatch.begun(now);
  counters.tickWatch.ended(now, result.status());
  if (!result) return;
  if (!plan.sharp) counters.tickSeconds.observe(std::chrono::duration<double>(now - plan.begun).count());
  for (const StageTime& stage : result->report.stages) counters.countStage(stage.stage, stage.seconds);
}

std::int64_t nowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

Delivery::Delivery(SceneSource& source, std::string sessionId, SessionKey key, std::uint64_t epoch,
                   const SessionServices& services)
    : source_(source),
      sessionId_(std::move(sessionId)),
      key_(key),
      epoch_(epoch),
      services_(services),
      views_(*services.pool),
      checks_(*services.pool, services.limits.selfCheck),
      limits_(services.limits) {}

void Delivery::setLimits(const Limits& limits) {
  {
    const MutexLock lock(mutex_);
    limits_ = limits;
  }
  checks_.setInterval(limits.selfCheck);
  tickIfDue();
}

Expected<SubscriberPtr> Delivery::subscribe(const Subscription& subscription, const std::shared_ptr<ResultSink>& sink) {
  SubscriberPtr subscriber;
  {
    const MutexLock lock(mutex_);
    if (Status s = source_.accepting(); !s.ok()) return s;
    if (std::ssize(readers_.subscribers()) >= limits_.maxSubscribersPerSession) {
      return exhausted(Reason::kMaxSubscribersPerSession, "max_subscribers_per_session",
                       "max_subscribers_per_session: allowed are " + std::to_string(limits_.maxSubscribersPerSession) +
                           " result streams");
    }
    subscriber = readers_.add(subscription, sink);
  }
  tickIfDue();
  return subscriber;
}

void Delivery::unsubscribe(const SubscriberPtr& subscriber) {
  {
    const MutexLock lock(mutex_);
    readers_.remove(*subscriber);
    source_.markUsed(subscriber->subscription.clientId);
    services_.engine->forgetView(key_, subscriber->key);
  }
  tickIfDue();
}

SubscriberPtr Delivery::findSubscriber(const std::string& id) const {
  const MutexLock lock(mutex_);
  return readers_.find(id);
}

void Delivery::acknowledge(const SubscriberPtr& subscriber, std::uint64_t resultId) {
  std::vector<Offer> ready;
  {
    const MutexLock lock(mutex_);
    const Clock::time_point now = Clock::now();
    const std::optional<double> seconds = subscriber->acknowledge(resultId, now);
    if (!seconds) return;
    services_.counters->acknowledgeLag.observe(*seconds);
    std::optional<Result> ahead;
    if (source_.accepting().ok()) ahead = subscriber->takePrefetch(source_.revision(), pace(), now);
    if (ahead) ready.push_back({subscriber, std::move(*ahead), Offer::kOfferPrepared});
  }
  tickIfDue();
  deliver(std::move(ready));
}

void Delivery::resend(const SubscriberPtr& subscriber) {
  {
    const MutexLock lock(mutex_);
    subscriber->resend();
  }
  tickIfDue();
}

Status Delivery::updateSubscription(const SubscriberPtr& subscriber, const FrameSettings& subscription,
                                    std::optional<double> maxRate) {
  {
    const MutexLock lock(mutex_);
    if (maxRate) subscriber->subscription.maxRate = *maxRate;
    std::optional<FrameSettings>& frame = subscriber->subscription.frame;
    if (!frame) return {};
    FrameSettings next = subscription;
    if (next.cameraSequence < frame->cameraSequence) {
      next.camera = frame->camera;
      next.cameraSequence = frame->cameraSequence;
    }
    frame = next;
    subscriber->settingsChanged = true;
  }
  tickIfDue();
  return {};
}

Subscription Delivery::subscriptionOf(const SubscriberPtr& subscriber) const {
  const MutexLock lock(mutex_);
  return subscriber->subscription;
}

std::shared_ptr<WaitingCall> Delivery::ask(WaitingCall call) {
  auto waiting = std::make_shared<WaitingCall>(std::move(call));
  {
    const MutexLock lock(mutex_);
    if (Status gone = source_.accepting(); !gone.ok()) {
      services_.pool->post([waiting, gone] { waiting->done(gone); });
      return waiting;
    }
    source_.markUsed({});
    if (waiting->frame && waiting->minRevision <= source_.revision()) {
      Expected<AnswerHoldPtr> room = takeRoom(*waiting->frame);
      if (!room) {
        services_.pool->post([waiting, why = room.status()] { waiting->done(why); });
        return waiting;
      }
      waiting->hold = std::move(*room);
    }
    readers_.add(waiting);
  }
  tickIfDue();
  return waiting;
}

/// Pixels, and as much again for what they are encoded to, which in formats without loss is a little more at worst.
Expected<AnswerHoldPtr> Delivery::takeRoom(const FrameSettings& settings) {
  constexpr std::int64_t kFileFrame = 64 * 1024;
  const std::int64_t bytesPerPixel = settings.format == PixelFormat::kRgb32F ? 3 * sizeof(float) : 3;
  const std::int64_t bytes = 2 * bytesPerPixel * settings.size.x * settings.size.y + kFileFrame;
  return services_.answers->take(sessionId_, bytes, limits_);
}

void Delivery::forget(const std::shared_ptr<WaitingCall>& call) {
  const MutexLock lock(mutex_);
  readers_.remove(call);
}

Status Delivery::checkCamera(const CameraChoice& choice) const {
  if (choice.name.empty() || choice.camera || source_.camera(choice.name)) return {};
  return {Code::kNotFound, "there is no camera \"" + choice.name + "\" in this session", "camera_name"};
}

Expected<Camera> Delivery::cameraFor(const CameraChoice& choice, const glm::ivec2& size) const {
  if (choice.camera) return *choice.camera;
  if (!choice.name.empty()) {
    if (const std::optional<Camera> camera = source_.camera(choice.name)) return *camera;
    return checkCamera(choice);
  }
  const ScenePtr scene = source_.viewScene();
  if (const std::optional<Camera> camera = views_.cameraOf(scene, aspectOf(size))) return *camera;
  return DefaultView(*scene).camera(aspectOf(size));
}

std::size_t Delivery::subscriberCount() const {
  const MutexLock lock(mutex_);
  return readers_.subscribers().size();
}

std::set<std::string> Delivery::clients() const {
  const MutexLock lock(mutex_);
  return readers_.clients();
}

bool Delivery::busy() const {
  const MutexLock lock(mutex_);
  return !readers_.empty();
}

void Delivery::ifIdle(const std::function<void()>& act) {
  const MutexLock lock(mutex_);
  if (readers_.empty()) act();
}

void Delivery::close(Closing why, const Status& gone) {
  std::vector<std::shared_ptr<ResultSink>> sinks;
  std::list<std::shared_ptr<WaitingCall>> calls;
  {
    const MutexLock lock(mutex_);
    sinks = readers_.sinks();
    calls = readers_.takeCalls();
    if (std::exchange(sharpening_, std::nullopt)) services_.engine->abandon(key_);
  }
  for (const auto& sink : sinks) sink->close(why);
  for (const auto& call : calls) {
    if (call->done) call->done(gone);
  }
}

// Planning.

/// Called after everything that may make a tick due.
void Delivery::tickIfDue() {
  std::optional<TickPlan> plan;
  {
    const MutexLock lock(mutex_);
    if (!source_.accepting().ok()) return;
    const Clock::time_point now = Clock::now();
    if (tickUnderWay_) return makeWay(now);
    plan = planTick(now);
    if (!plan) return;
    tickUnderWay_ = true;
    plan->begun = now;
    if (plan->sharp) {
      sharpening_ = plan;
    } else {
      pacer_.begin(now, intervalOf(limits_.maxTickRate));
    }
  }
  start(std::move(*plan));
}

/// A sharp frame may take seconds: whatever else is wanted comes first.
void Delivery::makeWay(Clock::time_point now) {
  if (!sharpening_) return;
  const std::uint64_t revision = source_.revision();
  const Clock::time_point next = readers_.nextDue({now, revision, pace()});
  if (now < next && readers_.stillWanted(*sharpening_, revision)) {
    if (next != Subscriber::kNever) wakeAt(next);
    return;
  }
  sharpening_.reset();
  services_.engine->abandon(key_);
}

std::optional<TickPlan> Delivery::planTick(Clock::time_point now) {
  const Occasion at{now, source_.revision(), pace()};
  if (now < pacer_.next()) {
    const Clock::time_point next = std::min(readers_.nextDue(at), readers_.nextSharp(at.revision));
    if (next != Subscriber::kNever) wakeAt(std::max(next, pacer_.next()));
    return std::nullopt;
  }
  const Readers::HasView hasView = [this](const CameraChoice& choice, std::uint64_t minRevision) {
    mutex_.assertHeld();
    return this->hasView(choice, minRevision);
  };
  const Readers::TakeRoom takeRoom = [this](const FrameSettings& settings) {
    mutex_.assertHeld();
    return this->takeRoom(settings);
  };
  TickPlan plan;
  const Clock::time_point next = readers_.planSubscribers(at, hasView, &plan);
  answer(readers_.planCalls(at, hasView, takeRoom, &plan));
  if (!plan.empty()) {
    readers_.planSharers(at, hasView, &plan);
    return plan;
  }
  readers_.planSharp(at, hasView, &plan);
  // One that is due and not planned has no view yet, and is planned when it does.
  const Clock::time_point sharp = readers_.nextSharp(at.revision);
  const Clock::time_point wake = plan.sharp || sharp <= now ? next : std::min(next, sharp);
  if (wake != Subscriber::kNever) wakeAt(wake);
  return plan.sharp ? std::optional(std::move(plan)) : std::nullopt;
}

/// Whether a tick knows where to look from; where not yet, one is planned again when it does.
bool Delivery::hasView(const CameraChoice& choice, std::uint64_t minRevision) {
  if (choice.camera || (!choice.name.empty() && source_.camera(choice.name))) return true;
  return views_.ready(source_.viewScene(), minRevision, [this, session = source_.lifetime()] {
    if (const auto alive = session.lock()) viewChosen();
  });
}

void Delivery::viewChosen() {
  {
    const MutexLock lock(mutex_);
    for (const auto& [id, subscriber] : readers_.subscribers()) {
      const std::optional<FrameSettings>& frame = subscriber->subscription.frame;
      if (!frame || frame->camera.camera) continue;
      if (frame->camera.name.empty() || !source_.camera(frame->camera.name)) subscriber->settingsChanged = true;
    }
  }
  tickIfDue();
}

void Delivery::wakeAt(Clock::time_point when) {
  if (wakesAt_ && *wakesAt_ <= when) return;
  wakesAt_ = when;
  services_.timers->at(when, [this, session = source_.lifetime()] {
    const auto alive = session.lock();
    if (!alive) return;
    {
      const MutexLock lock(mutex_);
      wakesAt_.reset();
    }
    tickIfDue();
  });
}

/// Without the lock: what the engine is given is a copy whose size is the scene's.
void Delivery::start(TickPlan plan) {
  plan.moment = source_.moment();
  if (!plan.sharp && checks_.unaskedDue(plan.begun) && canSelfCheck(*plan.moment.scene)) plan.transported = true;
  const bool sharp = plan.sharp;
  if (!sharp) services_.counters->tickWatch.begun(plan.begun);
  TickRequest request = requestOf(plan);
  services_.engine->submit(
      std::move(request), [this, session = source_.lifetime(), pool = services_.pool, counters = services_.counters,
                           shared = std::make_shared<const TickPlan>(std::move(plan))](Expected<TickResult> result) {
        countTick(*counters, *shared, result);
        pool->post([this, session, shared, moved = std::make_shared<Expected<TickResult>>(std::move(result))] {
          if (const auto alive = session.lock()) tickDone(*shared, std::move(*moved));
        });
      });
  if (!sharp) return;
  const MutexLock lock(mutex_);
  if (!sharpening_) services_.engine->abandon(key_);  // it had to make way before the engine knew of it
}

TickRequest Delivery::requestOf(TickPlan& plan) const {
  TickRequest request;
  request.session = key_;
  request.scene = plan.moment.scene;
  request.transported = plan.transported;
  request.injected = plan.injected;
  request.guarded = plan.guarded;
  request.probed = plan.probed;
  for (TickPlan::FrameReader& reader : plan.frameReaders) {
    FrameRequest wanted = frameRequest(reader.settings, *request.scene);
    wanted.reduced = !plan.sharp;
    // A sharp one has no view: what the next frames are made from stays.
    reader.frame = addShared(wanted, plan.sharp ? 0 : reader.subscriber->key, request.frames);
  }
  request.patient = plan.sharp;
  plan.readersFrames = request.frames.size();
  for (const auto& call : plan.frameCalls) request.frames.push_back(frameRequest(*call->frame, *request.scene));
  return request;
}

/// A camera that was deleted since it was chosen by name shows the default view rather than ending the stream.
FrameRequest Delivery::frameRequest(const FrameSettings& settings, const Scene& scene) const {
  FrameRequest request;
  const auto named = scene.cameras.find(settings.camera.name);
  if (settings.camera.camera) {
    request.camera = *settings.camera.camera;
  } else {
    request.camera = named != scene.cameras.end() ? named->second : views_.camera(aspectOf(settings.size));
  }
  request.size = settings.size;
  request.exposure = settings.exposure;
  request.format = settings.format;
  request.quantity = settings.quantity;
  request.samples = settings.samples;
  return request;
}

// Delivering.

void Delivery::tickDone(const TickPlan& plan, Expected<TickResult> result) {
  if (plan.sharp && result.status().code() == Code::kCancelled) return madeWay();
  if (!result) return fail(plan, result.status());
  ++services_.counters->ticks;
  ResultMeta meta;
  meta.epoch = epoch_;
  meta.revision = result->revision;
  meta.completedNs = nowNs();
  meta.report = std::make_shared<const TickReport>(std::move(result->report));
  meta.lookup = plan.moment.lookup;
  Deliveries deliveries;
  {
    const MutexLock lock(mutex_);
    tickUnderWay_ = false;
    sharpening_.reset();
    memory_ = meta.report->memory;
    const Clock::time_point now = Clock::now();
    if (!plan.sharp) smooth(tickSeconds_, now - plan.begun);
    deliveries = readers_.deliverResults(plan, *result, meta, {now, source_.revision(), pace()});
  }
  services_.counters->resultsCoalesced += deliveries.coalesced;
  answer(std::move(deliveries.answers));
  if (result->transported) checks_.offer(plan.moment.scene, result->transported, Clock::now());
  deliver(std::move(deliveries.offers));
  tickIfDue();
}

std::optional<MemoryUse> Delivery::memory() const {
  const MutexLock lock(mutex_);
  return memory_;
}

void Delivery::fail(const TickPlan& plan, const Status& status) {
  if (services_.onEvent && status.code() != Code::kCancelled)
    services_.onEvent(SessionEvent::kTickFailed, sessionId_, status.message());
  for (const auto& call : plan.volumeCalls) call->done(status);
  for (const auto& call : plan.frameCalls) call->done(status);
  {
    const MutexLock lock(mutex_);
    Readers::restore(plan);
    tickUnderWay_ = false;
    sharpening_.reset();
    pacer_.postpone(Clock::now() + kRetryAfterFailure);
  }
  tickIfDue();
}

/// A sharp frame was given up: it is made when everything rests again.
void Delivery::madeWay() {
  {
    const MutexLock lock(mutex_);
    tickUnderWay_ = false;
    sharpening_.reset();
  }
  tickIfDue();
}

void Delivery::answer(std::vector<Answer> answers) {
  for (Answer& each : answers) {
    // The call gets the only reference to pixels: it drops them when they are encoded.
    services_.pool->post(
        [call = std::move(each.call), result = std::move(each.result)]() mutable { call->done(std::move(result)); });
  }
}

/// Each on a worker of its own: encoding one reader's frame keeps no other reader waiting. The first is timed: it
/// encodes the volume that others share.
void Delivery::deliver(std::vector<Offer> offers) {
  for (std::size_t i = 0; i < offers.size(); ++i) {
    if (offers[i].how != Offer::kPrepare) ++services_.counters->resultsSent;
    const bool timed = i == 0 && offers[i].how != Offer::kOfferPrepared && offers[i].result.volume;
    services_.pool->post([this, session = source_.lifetime(), timed, offer = std::move(offers[i])] {
      const std::shared_ptr<ResultSink> sink = offer.subscriber->sink.lock();
      if (!sink) return;
      const Clock::time_point begun = Clock::now();
      offer.how == Offer::kPrepare ? sink->prepare(offer.result) : sink->offer(offer.result);
      const auto alive = timed ? session.lock() : nullptr;
      if (alive) encodingTook(Clock::now() - begun);
    });
  }
}

void Delivery::encodingTook(Clock::duration time) {
  const MutexLock lock(mutex_);
  smooth(encodeSeconds_, time);
}

}  // namespace lpv
