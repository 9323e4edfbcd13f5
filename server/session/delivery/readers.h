#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "session/delivery/tick_plan.h"

namespace lpv {

/// A result and the subscriber that gets it.
struct Offer {
  SubscriberPtr subscriber;
  Result result;
  enum { kOffer, kPrepare, kOfferPrepared } how = kOffer;
};

/// A result, or why there is none, and the call that it answers.
struct Answer {
  std::shared_ptr<WaitingCall> call;
  Expected<Result> result;
};

/// What a tick that has ended brings to the readers.
struct Deliveries {
  std::vector<Offer> offers;
  std::vector<Answer> answers;
  std::int64_t coalesced = 0;  ///< subscribers that the tick passed by: they get a later result instead
};

/// When a plan is made, or its results are delivered.
struct Occasion {
  Clock::time_point now;
  std::uint64_t revision = 0;  ///< of the session
  Pace pace;
};

/// The subscribers and waiting calls of a session, and the rules of who gets which result (PROTOCOL.md, Results). Pure
/// state: no threads, no clock. Not thread-safe: the lock of its Delivery guards it. No subscriber has more results in
/// flight than credits; a call is waiting here, in one plan, or answered.
class Readers {
 public:
  /// Whether a picture through that camera can be made of `minRevision` or later.
  using HasView = std::function<bool(const CameraChoice&, std::uint64_t minRevision)>;

  /// Room for the frame of a call.
  using TakeRoom = std::function<Expected<AnswerHoldPtr>(const FrameSettings&)>;

  SubscriberPtr add(const Subscription& subscription, const std::shared_ptr<ResultSink>& sink);
  void remove(const Subscriber& subscriber) { subscribers_.erase(subscriber.id); }
  /// Null where there is none.
  SubscriberPtr find(const std::string& id) const;
  const std::map<std::string, SubscriberPtr>& subscribers() const { return subscribers_; }
  /// Members with a stream of results.
  std::set<std::string> clients() const;
  /// The receiving ends that are still there.
  std::vector<std::shared_ptr<ResultSink>> sinks() const;

  void add(const std::shared_ptr<WaitingCall>& call) { calls_.push_back(call); }
  void remove(const std::shared_ptr<WaitingCall>& call) { calls_.remove(call); }
  std::list<std::shared_ptr<WaitingCall>> takeCalls() { return std::exchange(calls_, {}); }

  /// Nobody subscribes, no call waits.
  bool empty() const { return subscribers_.empty() && calls_.empty(); }
  /// When the next tick may begin; kNever where nobody needs one.
  Clock::time_point nextDue(const Occasion& at) const;

  /// Adds to the plan what subscribers are due. Returns when the first of the others is due.
  Clock::time_point planSubscribers(const Occasion& at, const HasView& hasView, TickPlan* plan);
  /// Adds to a plan of others what subscribers want whose credit is about to come back.
  void planSharers(const Occasion& at, const HasView& hasView, TickPlan* plan);
  /// Moves calls that can be answered now to the plan, or to the result where a volume is there already, or no room for
  /// a frame.
  std::vector<Answer> planCalls(const Occasion& at, const HasView& hasView, const TakeRoom& takeRoom, TickPlan* plan);

  /// When the first sharp frame may be made; kNever where nobody wants one.
  Clock::time_point nextSharp(std::uint64_t revision) const;
  /// Plans a sharp frame for the reader who has waited longest for one, where it is due, and for all who are due the
  /// same.
  void planSharp(const Occasion& at, const HasView& hasView, TickPlan* plan) const;
  /// Whether a reader of a plan of planSharp() is still there and has nothing newer to get first.
  bool stillWanted(const TickPlan& plan, std::uint64_t revision) const;

  /// Names the results of a tick and picks who gets them. `meta` says what all of them have in common.
  Deliveries deliverResults(const TickPlan& plan, const TickResult& tick, const ResultMeta& meta, const Occasion& at);
  /// The frames of a tick were not made: they are still wanted. A sharp one is not tried again until a newer frame has
  /// been sent.
  static void restore(const TickPlan& plan);

 private:
  static void include(const SubscriberPtr& subscriber, const Occasion& at, const HasView& hasView, TickPlan* plan);
  void deliverVolume(const TickPlan& plan, ResultMeta meta, VolumeStage stage, const VolumePtr& volume,
                     const Occasion& at, Deliveries* out);
  void deliverFrames(const TickPlan& plan, ResultMeta meta, const std::vector<FramePtr>& frames, const Occasion& at,
                     Deliveries* out);
  std::optional<Result> cachedVolume(const WaitingCall& call) const;

  std::map<std::string, SubscriberPtr> subscribers_;
  std::list<std::shared_ptr<WaitingCall>> calls_;
  std::map<VolumeStage, Result> latest_;  ///< newest volume of each stage that was read back
  std::uint64_t nextKey_ = 1;
  std::uint64_t nextResult_ = 1;
};

}  // namespace lpv
