#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lpv/v1/result.pb.h"
#include "session/delivery/result.h"
#include "session/limits.h"

namespace lpv::api {

namespace pb = lpv::v1;

/// World positions and unit normals.
using ProbePoints = std::vector<std::pair<glm::dvec3, glm::dvec3>>;

/// What is asked about every point.
struct ProbeWish {
  bool volumeOnly = false;  ///< without near field
  bool around = false;      ///< the light all around, too

  static ProbeWish of(const pb::ProbeRequest& request) { return {request.volume_only(), request.around()}; }
};

/// Points of a ProbeRequest, checked.
Expected<ProbePoints> probePoints(const std::string& bytes, const ProbeWish& wish, const Limits& limits);

/// The answer at each point from one volume result.
void answerPoints(const Result& result, const ProbePoints& points, const ProbeWish& wish, pb::ProbeResponse* out);

}  // namespace lpv::api
