#pragma once
// What a session hands out.

#include <cstdint>
#include <memory>

#include "engine/engine.h"
#include "scene/volume.h"
#include "session/answer_room.h"
#include "session/closing.h"

namespace lpv {

/// What every result says of itself.
struct ResultMeta {
  std::uint64_t epoch = 0;
  std::uint64_t revision = 0;
  std::uint64_t resultId = 0;
  std::int64_t completedNs = 0;      ///< system clock, nanoseconds since the Unix epoch
  std::uint64_t clientSequence = 0;  ///< highest edit sequence of the receiver's client that is contained
  std::shared_ptr<const TickReport> report;
  Lookup lookup = Lookup::kSh2;  ///< how the session reads irradiance from the volume
};

/// One finished thing: a volume or a frame.
struct Result {
  ResultMeta meta;
  VolumePtr volume;
  FramePtr frame;
  std::uint64_t cameraSequence = 0;
  int quality = 0;           ///< frames of subscribers: JPEG quality to encode with
  std::uint64_t baseId = 0;  ///< volumes: newest result that the receiver has acknowledged; 0: none that it still holds
  bool sharp = false;  ///< frames of subscribers: as calls get it (FrameSettings::sharpen)
  AnswerHoldPtr hold = nullptr;  ///< frames that calls asked for: the room of pixels and encoding
};

/// The receiving end of a subscriber; called on worker threads, one call at a time, without locks held.
class ResultSink {
 public:
  virtual ~ResultSink() = default;
  virtual void offer(const Result& result) = 0;
  /// This is likely to be offered soon: what it takes can be done now.
  virtual void prepare(const Result& /*result*/) {}
  virtual void close(Closing why) = 0;
};

}  // namespace lpv
