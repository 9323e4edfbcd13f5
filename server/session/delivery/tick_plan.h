#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "base/timers.h"
#include "engine/engine.h"
#include "session/delivery/scene_source.h"
#include "session/delivery/subscriber.h"
#include "session/delivery/waiting_call.h"

namespace lpv {

/// What one tick makes, and for whom. The frames are the readers', who share those that show the same, then the calls'.
struct TickPlan {
  struct FrameReader {
    SubscriberPtr subscriber;
    FrameSettings settings;  ///< as they were when the tick was planned, in the size that the frame is made in
    std::size_t frame = 0;  ///< among the tick's; set when it begins
  };

  bool transported = false;
  bool injected = false;
  bool guarded = false;
  bool probed = false;
  bool sharp = false;  ///< one frame as calls get it, and nothing else
  std::vector<SubscriberPtr> prefetchFor;  ///< readers whose credit is out
  std::vector<FrameReader> frameReaders;
  std::vector<std::shared_ptr<WaitingCall>> volumeCalls;
  std::vector<std::shared_ptr<WaitingCall>> frameCalls;
  std::size_t readersFrames = 0;  ///< before those of calls; set when the tick begins
  Clock::time_point begun;
  SceneMoment moment;  ///< set when the tick begins

  bool empty() const { return !transported && !injected && frameReaders.empty() && frameCalls.empty(); }
  void addVolume(VolumeStage stage, bool withGuard) {
    (stage == VolumeStage::kInjected ? injected : transported) = true;
    guarded = guarded || withGuard;
  }
  bool prefetchesFor(const Subscriber& subscriber) const {
    return std::any_of(prefetchFor.begin(), prefetchFor.end(),
                       [&](const SubscriberPtr& one) { return one.get() == &subscriber; });
  }
};

}  // namespace lpv
