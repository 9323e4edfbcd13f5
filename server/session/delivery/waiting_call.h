#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "base/status.h"
#include "session/answer_room.h"
#include "session/delivery/result.h"
#include "session/delivery/subscription.h"

namespace lpv {

/// A call that waits for one result.
struct WaitingCall {
  std::uint64_t minRevision = 0;
  std::optional<VolumeStage> volume;
  bool guarded = false;  ///< with guard cells
  bool probed = false;   ///< with what surfaces reflect (Volume::probed)
  std::optional<FrameSettings> frame;
  AnswerHoldPtr hold = nullptr;  ///< of a frame: there from when it can be made on
  std::function<void(Expected<Result>)> done;  ///< called once, on a worker thread
};

}  // namespace lpv
