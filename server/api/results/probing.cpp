#include "api/results/probing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>

#include "api/results/parts.h"
#include "scene/light_around.h"
#include "scene/lookup.h"

namespace lpv::api {

namespace {

/// The light all around a point counts as so many points.
constexpr int kPointsForAround = 64;

template <typename Number>
void append(std::string& bytes, const Number* numbers, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(numbers), count * sizeof(Number));
}

/// The index-th answer, whose irradiance is there already.
void answerAround(const Volume& volume, Lookup lookup, const glm::dvec3& at, bool volumeOnly, std::size_t index,
                  pb::ProbeResponse* out) {
  const LightAnswer answer = lightAround(volume, lookup, at, volumeOnly);
  std::array<float, 27> harmonics{};
  for (std::size_t i = 0; i < harmonics.size(); ++i) harmonics[i] = float(answer.light.radiance[i / 3][int(i % 3)]);
  append(*out->mutable_harmonics(), harmonics.data(), harmonics.size());
  const MainLight main = answer.light.mainLight();
  const double light[] = {main.direction.x,  main.direction.y,  main.direction.z,
                          main.irradiance.r, main.irradiance.g, main.irradiance.b};
  append(*out->mutable_main_light(), light, std::size(light));
  const int backs = backFacesAround(volume, at);
  out->mutable_back_faces()->push_back(char(backs));
  if (!answer.valid || backs >= kBackFacesInside) (*out->mutable_valid())[index] = 0;
}

}  // namespace

Expected<ProbePoints> probePoints(const std::string& bytes, const ProbeWish& wish, const Limits& limits) {
  constexpr std::size_t kPointBytes = 6 * sizeof(double);
  if (bytes.size() % kPointBytes != 0) {
    return invalid("points", "points has " + std::to_string(bytes.size()) + " bytes, no multiple of 48");
  }
  const std::size_t count = bytes.size() / kPointBytes;
  const int most = wish.around ? std::max(1, limits.maxProbePoints / kPointsForAround) : limits.maxProbePoints;
  if (std::int64_t(count) > most) {
    return Status(Code::kInvalidArgument, Reason::kMaxProbePoints,
                  "max_probe_points: points has " + std::to_string(count) + ", allowed are " + std::to_string(most) +
                      " in one message" + (wish.around ? " that asks for the light around them" : ""),
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

void answerPoints(const Result& result, const ProbePoints& points, const ProbeWish& wish, pb::ProbeResponse* out) {
  const auto look = wish.volumeOnly ? irradianceAt : irradianceWithNearField;
  toProto(result.meta, out->mutable_result());
  std::string& rgb = *out->mutable_irradiance();
  rgb.resize(points.size() * 3 * sizeof(double));
  out->mutable_valid()->resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Irradiance e = look(*result.volume, result.meta.lookup, points[i].first, points[i].second);
    std::memcpy(rgb.data() + i * 3 * sizeof(double), &e.rgb, 3 * sizeof(double));
    (*out->mutable_valid())[i] = e.valid ? 1 : 0;
    if (wish.around) answerAround(*result.volume, result.meta.lookup, points[i].first, wish.volumeOnly, i, out);
  }
}

}  // namespace lpv::api
