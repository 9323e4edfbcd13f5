#pragma once
// What a subscriber or a call asks for.

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "engine/engine.h"
#include "scene/camera.h"
#include "scene/volume.h"

namespace lpv {

/// The camera of a frame subscriber or call: given, or a camera of the session by name, or the default view.
struct CameraChoice {
  std::optional<Camera> camera;
  std::string name;

  bool operator==(const CameraChoice&) const = default;
};

/// What a frame subscriber or call wants to see.
struct FrameSettings {
  CameraChoice camera;
  std::uint64_t cameraSequence = 0;
  glm::ivec2 size{640, 360};  ///< pixels
  Exposure exposure;
  PixelFormat format = PixelFormat::kRgb8;
  FrameQuantity quantity = FrameQuantity::kRadiance;
  int samples = 1;   ///< FrameRequest::samples
  int quality = 85;  ///< of JPEG, 1..100
  bool sharpen = false;  ///< subscriptions: a frame as calls get it follows when everything rests

  bool operator==(const FrameSettings&) const = default;
  /// Whether the same pixels serve both, where a name means the same camera.
  bool showsTheSame(const FrameSettings& other) const {
    FrameSettings like = other;
    like.cameraSequence = cameraSequence;
    like.quality = quality;
    like.sharpen = sharpen;
    return *this == like;
  }
};

/// What a subscriber wants.
struct Subscription {
  std::optional<VolumeStage> volume;   ///< a volume of this stage ...
  bool guarded = false;                ///< ... with guard cells
  std::optional<FrameSettings> frame;  ///< ... or frames
  std::string clientId;                ///< whose edit sequences to echo; may be empty
  double maxRate = 0.0;                ///< results per second; 0 = the session's tick rate
  bool twoCredits = false;
  double adaptRate = 0.0;  ///< frames per second that size and quality are adapted to keep; 0: they stay as wished
};

}  // namespace lpv
