#pragma once
// Who waits for a session's results, what the next tick makes for them, and who gets what it made (PROTOCOL.md,
// Results): one credit per subscriber, the newest result wins, nothing is made that nobody waits for.

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "session/delivery/default_view_chooser.h"
#include "session/delivery/readers.h"
#include "session/delivery/self_check_schedule.h"
#include "session/services.h"

namespace lpv {

/// The results of one session: plans ticks for its readers, has the engine make them one at a time, and hands out what
/// they made. Thread-safe.
///
/// Its lock is acquired before the session's, never while that is held: functions here read the session through
/// SceneSource, and the session calls them without its lock.
class Delivery {
 public:
  /// `source` is the session and outlives this; `services` outlive both.
  Delivery(SceneSource& source, std::string sessionId, SessionKey key, std::uint64_t epoch,
           const SessionServices& services);

  /// From now on.
  void setLimits(const Limits& limits) LPV_EXCLUDES(mutex_);
  /// There may be something new to make: starts a tick where one is due.
  void sceneChanged() { tickIfDue(); }

  /// RESOURCE_EXHAUSTED, max_subscribers_per_session; or why the session accepts nothing.
  Expected<SubscriberPtr> subscribe(const Subscription& subscription, const std::shared_ptr<ResultSink>& sink)
      LPV_EXCLUDES(mutex_);
  void unsubscribe(const SubscriberPtr& subscriber) LPV_EXCLUDES(mutex_);
  /// Null where there is none.
  SubscriberPtr findSubscriber(const std::string& id) const LPV_EXCLUDES(mutex_);
  /// The subscriber has applied `resultId` and everything before it.
  void acknowledge(const SubscriberPtr& subscriber, std::uint64_t resultId) LPV_EXCLUDES(mutex_);
  /// The subscriber has lost what it was sent: it is owed the current result again, whole.
  void resend(const SubscriberPtr& subscriber) LPV_EXCLUDES(mutex_);
  /// Replaces a frame subscriber's subscription; an older camera sequence keeps the camera that is there.
  Status updateSubscription(const SubscriberPtr& subscriber, const FrameSettings& subscription,
                            std::optional<double> maxRate) LPV_EXCLUDES(mutex_);
  /// A copy of what the subscriber wants now.
  Subscription subscriptionOf(const SubscriberPtr& subscriber) const LPV_EXCLUDES(mutex_);

  /// Answers from a result at or after call.minRevision; forget() takes the call back.
  std::shared_ptr<WaitingCall> ask(WaitingCall call) LPV_EXCLUDES(mutex_);
  void forget(const std::shared_ptr<WaitingCall>& call) LPV_EXCLUDES(mutex_);

  /// NOT_FOUND for the name of a camera that is not there.
  Status checkCamera(const CameraChoice& choice) const;
  /// The camera that a choice means now, for pictures of that size. NOT_FOUND for an unknown name. May take as long as
  /// a DefaultView takes.
  Expected<Camera> cameraFor(const CameraChoice& choice, const glm::ivec2& size) const;

  std::size_t subscriberCount() const LPV_EXCLUDES(mutex_);
  /// Members with a stream of results.
  std::set<std::string> clients() const LPV_EXCLUDES(mutex_);
  /// What the last self-check found.
  std::optional<MeasuredError> measured() const { return checks_.measured(); }
  /// On the GPU at the end of the last tick; nothing before the first.
  std::optional<MemoryUse> memory() const LPV_EXCLUDES(mutex_);
  /// Somebody subscribes or waits.
  bool busy() const LPV_EXCLUDES(mutex_);
  /// Calls `act` where nobody does, and lets nobody begin meanwhile.
  void ifIdle(const std::function<void()>& act) LPV_EXCLUDES(mutex_);
  /// Ends every stream, and every call with `gone`. The session accepts nothing any more.
  void close(Closing why, const Status& gone) LPV_EXCLUDES(mutex_);

 private:
  // Planning.
  void tickIfDue() LPV_EXCLUDES(mutex_);
  void makeWay(Clock::time_point now) LPV_REQUIRES(mutex_);
  std::optional<TickPlan> planTick(Clock::time_point now) LPV_REQUIRES(mutex_);
  bool hasView(const CameraChoice& choice, std::uint64_t minRevision) LPV_REQUIRES(mutex_);
  void viewChosen() LPV_EXCLUDES(mutex_);
  Expected<AnswerHoldPtr> takeRoom(const FrameSettings& settings) LPV_REQUIRES(mutex_);
  void wakeAt(Clock::time_point when) LPV_REQUIRES(mutex_);
  void start(TickPlan plan) LPV_EXCLUDES(mutex_);
  TickRequest requestOf(TickPlan& plan) const;
  FrameRequest frameRequest(const FrameSettings& settings, const Scene& scene) const;

  // Delivering.
  void tickDone(const TickPlan& plan, Expected<TickResult> result) LPV_EXCLUDES(mutex_);
  void fail(const TickPlan& plan, const Status& status) LPV_EXCLUDES(mutex_);
  void madeWay() LPV_EXCLUDES(mutex_);
  void answer(std::vector<Answer> answers);
  void deliver(std::vector<Offer> offers) LPV_EXCLUDES(mutex_);
  void encodingTook(Clock::duration time) LPV_EXCLUDES(mutex_);

  Pace pace() const LPV_REQUIRES(mutex_) { return {limits_.maxTickRate, tickSeconds_ + encodeSeconds_, tickSeconds_}; }

  SceneSource& source_;
  const std::string sessionId_;
  const SessionKey key_;
  const std::uint64_t epoch_;
  const SessionServices services_;  ///< with the limits of the beginning
  DefaultViewChooser views_;
  SelfCheckSchedule checks_;

  mutable Mutex mutex_;
  Limits limits_ LPV_GUARDED_BY(mutex_);
  Readers readers_ LPV_GUARDED_BY(mutex_);
  bool tickUnderWay_ LPV_GUARDED_BY(mutex_) = false;
  std::optional<TickPlan> sharpening_ LPV_GUARDED_BY(mutex_);  ///< the tick under way, until it has to make way
  std::optional<MemoryUse> memory_ LPV_GUARDED_BY(mutex_);
  Pacer pacer_ LPV_GUARDED_BY(mutex_){Pacer::Slack::kAnInterval};  ///< of ticks
  std::optional<Clock::time_point> wakesAt_ LPV_GUARDED_BY(mutex_);  ///< the timer's call that is pending
  double tickSeconds_ LPV_GUARDED_BY(mutex_) = 0.0;  ///< from a tick's plan to its results, smoothed
  double encodeSeconds_ LPV_GUARDED_BY(mutex_) = 0.0;  ///< of a volume, smoothed
};

}  // namespace lpv
