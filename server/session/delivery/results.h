#pragma once
// What a session hands out, and who waits for it.

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "base/timers.h"
#include "engine/engine.h"
#include "scene/camera.h"
#include "scene/volume.h"
#include "session/delivery/frame_adapter.h"
#include "session/delivery/round_trip.h"

namespace lpv {

/// What every result says of itself.
struct ResultMeta {
  std::uint64_t epoch = 0;
  std::uint64_t revision = 0;
  std::uint64_t resultId = 0;
  std::int64_t completedNs = 0;        ///< system clock, nanoseconds since the Unix epoch
  std::uint64_t clientSequence = 0;    ///< highest edit sequence of the receiver's client that is contained
  std::shared_ptr<const TickReport> report;
  Lookup lookup = Lookup::kSh2;        ///< how the session reads irradiance from the volume
};

/// One finished thing: a volume or a frame.
struct Result {
  ResultMeta meta;
  VolumePtr volume;
  FramePtr frame;
  std::uint64_t cameraSequence = 0;
  int quality = 0;  ///< frames of subscribers: JPEG quality to encode with
  std::uint64_t baseId = 0;  ///< volumes: newest result that the receiver has acknowledged; 0: none that it still holds
};

/// Why a session's streams end.
enum class Closing {
  kDeleted,
  kDraining,
  kEncodingFailed,  ///< of one subscriber: its frame could not be encoded; the session goes on
  kEvicted,  ///< idle: it is kept on disk, and comes back with the next call
};

/// The camera of a frame subscriber or call: given, or a camera of the session by name, or the default view.
struct CameraChoice {
  std::optional<Camera> camera;
  std::string name;
};

/// What a frame subscriber or call wants to see.
struct FrameSettings {
  CameraChoice camera;
  std::uint64_t cameraSequence = 0;
  glm::ivec2 size{640, 360};
  Exposure exposure;
  PixelFormat format = PixelFormat::kRgb8;
  int quality = 85;  ///< of JPEG, 1..100
};

/// What a subscriber wants.
struct Subscription {
  std::optional<VolumeStage> volume;  ///< a volume of this stage ...
  std::optional<FrameSettings> frame;  ///< ... or frames
  std::string clientId;  ///< whose edit sequences to echo; may be empty
  double maxRate = 0.0;  ///< results per second; 0 = the session's tick rate
  bool twoCredits = false;
  double adaptRate = 0.0;  ///< frames per second that size and quality are adapted to keep; 0: they stay as wished
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

/// A result on its way to a subscriber.
struct Sent {
  std::uint64_t resultId = 0;
  Clock::time_point at{};
};

/// A volume that was made for a credit that is about to come back.
struct Prefetch {
  Result result;
  Clock::time_point at{};
};

/// A live subscriber. Its fields belong to the session's lock.
struct Subscriber {
  std::uint64_t key = 0;
  std::string id;
  Subscription subscription;
  std::weak_ptr<ResultSink> sink;
  /// Newest result that the receiver has begun to take; nobody has seen a later one.
  std::atomic<std::uint64_t> taken{0};

  std::deque<Sent> inFlight;  ///< sent and not acknowledged, oldest first
  std::uint64_t lastSent = 0;  ///< result id
  std::uint64_t baseId = 0;  ///< newest result acknowledged ...
  std::uint64_t basesAfter = 0;  ///< ... among those after this one; what came before is lost
  std::uint64_t shownRevision = 0;  ///< of the last result sent
  bool shownAny = false;
  bool settingsChanged = false;  ///< camera, size or exposure since the last frame asked for
  Clock::time_point notBefore{};  ///< rate limit
  RoundTrip roundTrip;
  std::optional<Prefetch> prefetch;
  std::uint64_t prefetchFor = 0;  ///< the result whose acknowledgement a volume was last made ahead of
  std::optional<FrameAdapter> adapter;  ///< where the subscription has a rate to adapt to
};

/// A call that waits for one result.
struct WaitingCall {
  std::uint64_t minRevision = 0;
  std::optional<VolumeStage> volume;
  std::optional<FrameSettings> frame;
  std::function<void(Expected<Result>)> done;  ///< called once, on a worker thread
};

}  // namespace lpv
