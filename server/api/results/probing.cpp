#include "api/results/probing.h"

#include <cmath>
#include <cstring>

#include "api/results/parts.h"
#include "scene/lookup.h"

namespace lpv::api {

Expected<ProbePoints> probePoints(const std::string& bytes, const Limits& limits) {
  constexpr std::size_t kPointBytes = 6 * sizeof(double);
  if (bytes.size() % kPointBytes != 0) {
    return invalid("points", "points has " + std::to_string(bytes.size()) + " bytes, no multiple of 48");
  }
  const std::size_t count = bytes.size() / kPointBytes;
  if (std::int64_t(count) > limits.maxProbePoints) {
    return Status(Code::kInvalidArgument, Reason::kMaxProbePoints,
                  "max_probe_points: points has " + std::to_string(count) + ", allowed are " +
                      std::to_string(limits.maxProbePoints) + " in one message",
                  "points");
  }
  ProbePoints out(count);
  for (std::size_t i = 0; i < count; ++i) {
    double v[6];
    std::memcpy(v, bytes.data() + i * kPointBytes, kPointBytes);
    const glm::dvec3 normal(v[3], v[4], v[5]);
    const double length = glm::length(normal);
    bool finite = std::isfinite(length);
    for (int axis = 0; axis < 3; ++axis) finite = finite && std::isfinite(v[axis]);
    if (!finite || length == 0.0) {
      return invalid("points", "point " + std::to_string(i) + " is not finite, or its normal has no length");
    }
    out[i] = {{v[0], v[1], v[2]}, normal / length};
  }
  return out;
}

void answerPoints(const Result& result, const ProbePoints& points, bool volumeOnly, pb::ProbeResponse* out) {
  const auto look = volumeOnly ? irradianceAt : irradianceWithNearField;
  toProto(result.meta, out->mutable_result());
  std::string& rgb = *out->mutable_irradiance();
  rgb.resize(points.size() * 3 * sizeof(double));
  out->mutable_valid()->resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Irradiance e = look(*result.volume, result.meta.lookup, points[i].first, points[i].second);
    std::memcpy(rgb.data() + i * 3 * sizeof(double), &e.rgb, 3 * sizeof(double));
    (*out->mutable_valid())[i] = e.valid ? 1 : 0;
  }
}

}  // namespace lpv::api
