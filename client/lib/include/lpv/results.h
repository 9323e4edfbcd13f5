#pragma once
// Results of the server, decoded.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lpv/v1/result.pb.h"
#include "scene/lookup.h"
#include "scene/volume.h"

namespace lpv::client {

/// A decoded volume whose checksum has been verified. lpv::irradianceAt (scene/lookup.h) looks irradiance up.
struct VolumeResult {
  Volume volume;               ///< with guard cells, where they were asked for: one more on each side of header.grid
  v1::VolumeHeader header;     ///< revision, stage times, features, layers
  std::size_t bytes = 0;       ///< bytes received, payloads only
  double decodeSeconds = 0.0;  ///< from the first part to the decoded volume, network included
};

/// An encoded frame whose checksum has been verified.
struct FrameResult {
  std::string file;  ///< complete JPEG, PNG or EXR file
  v1::FrameHeader header;
};

/// A point on a surface.
struct SurfacePoint {
  glm::dvec3 position{0.0};          ///< world, metres
  glm::dvec3 normal{0.0, 1.0, 0.0};  ///< any length except 0
};

/// All the light around a probed point (ProbeResponse says what the numbers mean).
struct LightAround {
  std::array<glm::vec3, 9> harmonics{};      ///< of incident radiance: 00, 1-1, 10, 11, 2-2 .. 22; W/(sr m^2)
  glm::dvec3 mainDirection{0.0, 1.0, 0.0};   ///< unit, towards the main light
  glm::dvec3 mainIrradiance{0.0};            ///< of it, on a surface that faces it, W/m^2
  int backFaces = 0;                         ///< of 64 rays, those that meet the back of a surface
};

/// Irradiance at the probed points, in their order.
struct ProbeResult {
  v1::ResultInfo info;
  std::vector<Irradiance> irradiance;
  std::vector<LightAround> around;  ///< empty unless asked for
};

/// What is asked about every point.
struct ProbeWish {
  bool volumeOnly = false;  ///< the plain lookup without near field
  bool around = false;      ///< the light all around, too
  std::optional<std::uint64_t> minRevision = {};
};

}  // namespace lpv::client
