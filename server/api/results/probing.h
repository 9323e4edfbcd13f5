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

/// Points of a ProbeRequest, checked.
Expected<ProbePoints> probePoints(const std::string& bytes, const Limits& limits);

/// Irradiance at each point from one volume result; `volumeOnly`: without near field.
void answerPoints(const Result& result, const ProbePoints& points, bool volumeOnly, pb::ProbeResponse* out);

}  // namespace lpv::api
