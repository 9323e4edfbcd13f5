#include "session/delivery/readers.h"

#include <algorithm>
#include <utility>

#include "session/members/members.h"

namespace lpv {
namespace {

/// Of the frames that calls wait for, pixels that one tick makes: its targets are held until it ends. The others wait.
constexpr std::int64_t kMostCallPixels = std::int64_t(4096) * 4096;

/// Of each pixel of a sharp frame, at least: as many as calls get that say nothing of them.
constexpr int kSharpSamples = 32;
/// Readers of one view are sent its frames one after the other, and rest one after the other: who is due by then has
/// the frame made with the first.
constexpr std::chrono::milliseconds kTogether{100};

std::int64_t pixelsOf(const FrameSettings& settings) { return std::int64_t(settings.size.x) * settings.size.y; }

Status haveRoom(WaitingCall& call, const Readers::TakeRoom& takeRoom) {
  if (!call.frame || call.hold) return {};
  Expected<AnswerHoldPtr> room = takeRoom(*call.frame);
  if (room) call.hold = std::move(*room);
  return room.status();
}

}  // namespace

SubscriberPtr Readers::add(const Subscription& subscription, const std::shared_ptr<ResultSink>& sink) {
  auto subscriber = std::make_shared<Subscriber>();
  subscriber->key = nextKey_++;
  subscriber->id = "s-" + std::to_string(subscriber->key) + "-" + randomHex(4);
  subscriber->subscription = subscription;
  subscriber->sink = sink;
  if (subscription.frame && subscription.adaptRate > 0.0) subscriber->adapter.emplace(subscription.adaptRate);
  subscribers_[subscriber->id] = subscriber;
  return subscriber;
}

SubscriberPtr Readers::find(const std::string& id) const {
  const auto found = subscribers_.find(id);
  return found == subscribers_.end() ? nullptr : found->second;
}

std::set<std::string> Readers::clients() const {
  std::set<std::string> out;
  for (const auto& [id, subscriber] : subscribers_) out.insert(subscriber->subscription.clientId);
  return out;
}

std::vector<std::shared_ptr<ResultSink>> Readers::sinks() const {
  std::vector<std::shared_ptr<ResultSink>> out;
  for (const auto& [id, subscriber] : subscribers_) {
    if (auto sink = subscriber->sink.lock()) out.push_back(std::move(sink));
  }
  return out;
}

Clock::time_point Readers::nextDue(const Occasion& at) const {
  Clock::time_point next = calls_.empty() ? Subscriber::kNever : at.now;
  for (const auto& [id, subscriber] : subscribers_) next = std::min(next, subscriber->dueAt(at.revision, at.pace));
  return next;
}

Clock::time_point Readers::planSubscribers(const Occasion& at, const HasView& hasView, TickPlan* plan) {
  Clock::time_point next = Subscriber::kNever;
  for (const auto& [id, subscriber] : subscribers_) {
    if (const Clock::time_point due = subscriber->dueAt(at.revision, at.pace); at.now < due) {
      next = std::min(next, due);
      continue;
    }
    include(subscriber, at, hasView, plan);
  }
  return next;
}

void Readers::planSharers(const Occasion& at, const HasView& hasView, TickPlan* plan) {
  for (const auto& [id, subscriber] : subscribers_) {
    if (at.now >= subscriber->dueAt(at.revision, at.pace)) continue;  // has been planned
    if (subscriber->sharesTick(at.revision, at.pace, at.now)) include(subscriber, at, hasView, plan);
  }
}

void Readers::include(const SubscriberPtr& subscriber, const Occasion& at, const HasView& hasView, TickPlan* plan) {
  const Subscription& wanted = subscriber->subscription;
  if (wanted.volume) {
    plan->addVolume(*wanted.volume, wanted.guarded);
  } else if (wanted.frame && hasView(wanted.frame->camera, 0)) {
    FrameSettings settings = *wanted.frame;
    settings.size = subscriber->frameShape().size;
    plan->frameReaders.push_back({subscriber, std::move(settings)});
    subscriber->settingsChanged = false;
  }
  if (!subscriber->hasCredit(at.pace)) plan->prefetchFor.push_back(subscriber);
}

std::vector<Answer> Readers::planCalls(const Occasion& at, const HasView& hasView, const TakeRoom& takeRoom,
                                       TickPlan* plan) {
  std::vector<Answer> answers;
  std::int64_t framePixels = 0;
  for (auto it = calls_.begin(); it != calls_.end();) {
    const std::shared_ptr<WaitingCall> call = *it;
    const bool early = call->minRevision > at.revision;
    const bool full = call->frame && framePixels > 0 && framePixels + pixelsOf(*call->frame) > kMostCallPixels;
    if (early || full || (call->frame && !hasView(call->frame->camera, call->minRevision))) {
      ++it;
      continue;
    }
    it = calls_.erase(it);
    if (const Status room = haveRoom(*call, takeRoom); !room.ok()) {
      answers.push_back({call, room});
    } else if (call->frame) {
      plan->frameCalls.push_back(call);
      framePixels += pixelsOf(*call->frame);
    } else if (const std::optional<Result> cached = cachedVolume(*call)) {
      answers.push_back({call, *cached});
    } else {
      plan->addVolume(*call->volume, call->guarded);
      plan->probed = plan->probed || call->probed;
      plan->volumeCalls.push_back(call);
    }
  }
  return answers;
}

Clock::time_point Readers::nextSharp(std::uint64_t revision) const {
  Clock::time_point next = Subscriber::kNever;
  for (const auto& [id, subscriber] : subscribers_) next = std::min(next, subscriber->sharpenAt(revision));
  return next;
}

void Readers::planSharp(const Occasion& at, const HasView& hasView, TickPlan* plan) const {
  const auto due = [&](const auto& each) { return each.second->sharpenAt(at.revision); };
  const auto first = std::ranges::min_element(subscribers_, {}, due);
  if (first == subscribers_.end() || at.now < due(*first)) return;
  const FrameSettings wanted = *first->second->subscription.frame;
  if (!hasView(wanted.camera, 0)) return;
  plan->sharp = true;
  for (const auto& each : subscribers_) {
    if (at.now + kTogether < due(each) || !each.second->subscription.frame->showsTheSame(wanted)) continue;
    FrameSettings settings = *each.second->subscription.frame;
    settings.samples = std::max(settings.samples, kSharpSamples);
    plan->frameReaders.push_back({each.second, std::move(settings)});
  }
}

bool Readers::stillWanted(const TickPlan& plan, std::uint64_t revision) const {
  return std::ranges::any_of(plan.frameReaders, [&](const TickPlan::FrameReader& reader) {
    const Subscriber& subscriber = *reader.subscriber;
    return subscribers_.contains(subscriber.id) && subscriber.sharpenAt(revision) != Subscriber::kNever;
  });
}

std::optional<Result> Readers::cachedVolume(const WaitingCall& call) const {
  const auto found = latest_.find(*call.volume);
  if (found == latest_.end() || found->second.meta.revision < call.minRevision) return std::nullopt;
  if (call.guarded && found->second.volume->guarded == nullptr) return std::nullopt;
  if (call.probed && !found->second.volume->probed) return std::nullopt;
  return found->second;
}

Deliveries Readers::deliverResults(const TickPlan& plan, const TickResult& tick, const ResultMeta& meta,
                                   const Occasion& at) {
  Deliveries out;
  for (const auto& [id, subscriber] : subscribers_) subscriber->dropStalePrefetch(at.revision, at.pace, at.now);
  if (tick.transported) deliverVolume(plan, meta, VolumeStage::kTransported, tick.transported, at, &out);
  if (tick.injected) deliverVolume(plan, meta, VolumeStage::kInjected, tick.injected, at, &out);
  deliverFrames(plan, meta, tick.frames, at, &out);
  for (const auto& [id, subscriber] : subscribers_) {
    // Passed by, because it has not acknowledged what it was sent, or wants fewer results a second.
    const bool passed = at.now < subscriber->dueAt(at.revision, at.pace);
    if (subscriber->lacks(meta.revision) && !subscriber->prefetch && passed) ++out.coalesced;
  }
  return out;
}

/// A volume goes to every reader with credit that lacks it, also to those that came or got their credit back while the
/// tick ran, and to the calls that waited; it is kept for readers whose credit is about to come back.
void Readers::deliverVolume(const TickPlan& plan, ResultMeta meta, VolumeStage stage, const VolumePtr& volume,
                            const Occasion& at, Deliveries* out) {
  meta.resultId = nextResult_++;
  const Result& latest = latest_[stage] = {meta, volume, nullptr, 0, 0, 0};
  for (const auto& [id, subscriber] : subscribers_) {
    const bool due = at.now >= subscriber->dueAt(at.revision, at.pace) ||
                     (plan.prefetchesFor(*subscriber) && subscriber->canStorePrefetch(at.pace));
    const Subscription& wanted = subscriber->subscription;
    const bool serves = wanted.volume == stage && (!wanted.guarded || volume->guarded != nullptr);
    if (!serves || !subscriber->lacks(meta.revision) || !due) continue;
    Result result = latest;
    result.meta.clientSequence = plan.moment.sequenceOf(subscriber->subscription.clientId);
    if (!subscriber->hasCredit(at.pace)) {
      Result kept = subscriber->storePrefetch(std::move(result), at.now);
      if (subscriber->worthAhead(at.pace)) out->offers.push_back({subscriber, std::move(kept), Offer::kPrepare});
      continue;
    }
    result.baseId = subscriber->baseId;
    subscriber->markSent(result, at.now);
    out->offers.push_back({subscriber, std::move(result)});
  }
  for (const auto& call : plan.volumeCalls) {
    if (call->volume == stage) out->answers.push_back({call, latest});
  }
}

void Readers::deliverFrames(const TickPlan& plan, ResultMeta meta, const std::vector<FramePtr>& frames,
                            const Occasion& at, Deliveries* out) {
  for (const auto& [subscriber, settings, frame] : plan.frameReaders) {
    meta.resultId = nextResult_++;
    meta.clientSequence = plan.moment.sequenceOf(subscriber->subscription.clientId);
    Result result{meta, nullptr, frames[frame], settings.cameraSequence, subscriber->frameShape().quality, 0};
    if (!subscribers_.contains(subscriber->id)) continue;
    if (plan.sharp) {
      if (subscriber->sharpenAt(at.revision) == Subscriber::kNever) continue;
      result.quality = settings.quality;
      result.sharp = true;
    }
    if (!subscriber->hasCredit(at.pace)) {
      if (subscriber->canStorePrefetch(at.pace)) subscriber->storePrefetch(std::move(result), at.now);
      continue;
    }
    subscriber->markSent(result, at.now);
    out->offers.push_back({subscriber, std::move(result)});
  }
  auto frame = frames.begin() + std::ptrdiff_t(plan.readersFrames);
  for (const auto& call : plan.frameCalls) {
    meta.resultId = nextResult_++;
    meta.clientSequence = 0;
    out->answers.push_back(
        {call, Result{meta, nullptr, *frame++, 0, call->frame->quality, 0, false, std::move(call->hold)}});
  }
}

void Readers::restore(const TickPlan& plan) {
  for (const TickPlan::FrameReader& reader : plan.frameReaders) {
    Subscriber& subscriber = *reader.subscriber;
    if (plan.sharp) {
      subscriber.rough = false;
    } else {
      subscriber.settingsChanged = true;
    }
  }
}

}  // namespace lpv
