#pragma once
// What the server makes, as a client holds it.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "lpv/v1/result.pb.h"
#include "scene/volume.h"

namespace lpv::client {

/// A volume, decoded and verified against its checksum. Look irradiance up with lpv::irradianceAt (scene/volume.h).
struct VolumeResult {
  Volume volume;
  v1::VolumeHeader header;     ///< revision, stage times, features, layers
  std::size_t bytes = 0;       ///< received, payload only
  double decodeSeconds = 0.0;  ///< from the first part to the finished volume, network included
};

/// An encoded picture, verified against its checksum.
struct FrameResult {
  std::string file;  ///< JPEG, PNG or EXR, complete
  v1::FrameHeader header;
};

/// A place that receives light.
struct SurfacePoint {
  glm::dvec3 position{0.0};          ///< world, metres
  glm::dvec3 normal{0.0, 1.0, 0.0};  ///< any length but 0
};

/// Answers of a probe, in the order asked.
struct ProbeResult {
  v1::ResultInfo info;
  std::vector<Irradiance> irradiance;
};

}  // namespace lpv::client
