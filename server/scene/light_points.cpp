#include "scene/light_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "scene/coarse_texture.h"
#include "scene/emitter_list.h"

namespace lpv {

namespace {

/// The additive recurrence of the plastic number (Roberts 2018, "The unreasonable effectiveness of quasirandom
/// sequences"), folded into a triangle: the weights of its second and third corner.
glm::dvec2 inTriangle(std::size_t i) {
  constexpr double kFirst = 0.7548776662466927, kSecond = 0.5698402909980532;
  glm::dvec2 p(std::fmod(0.5 + kFirst * double(i), 1.0), std::fmod(0.5 + kSecond * double(i), 1.0));
  return p.x + p.y > 1.0 ? 1.0 - p : p;
}

glm::dvec3 cornersCross(const Mesh& mesh, const glm::uvec3& t) {
  const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
  return glm::cross(b - a, c - a);
}

template <typename T>
auto mixed(const std::vector<T>& values, const glm::uvec3& t, const glm::dvec2& w) {
  using Double = decltype(1.0 * glm::vec<T::length(), double>(values[0]));
  return (1.0 - w.x - w.y) * Double(values[t.x]) + w.x * Double(values[t.y]) + w.y * Double(values[t.z]);
}

/// Bits of a number of 10 bits, two places apart.
std::uint32_t spread(std::uint32_t v) {
  v = (v | v << 16U) & 0x030000FFU;
  v = (v | v << 8U) & 0x0300F00FU;
  v = (v | v << 4U) & 0x030C30C3U;
  return (v | v << 2U) & 0x09249249U;
}

/// Along Morton's curve through the mesh's box.
void sortInSpace(LightPoints& points, const Bounds& box) {
  const double edge = std::max({box.extent().x, box.extent().y, box.extent().z, 1e-30});
  const auto key = [&](const LightPoint& p) {
    const glm::uvec3 cell(glm::clamp((glm::dvec3(p.position) - box.min) / edge, 0.0, 1.0) * 1023.0);
    return spread(cell.x) | spread(cell.y) << 1U | spread(cell.z) << 2U;
  };
  std::ranges::stable_sort(points, {}, key);
}

/// Of so many points of these triangles, each stands for the same area.
LightPoints evenlySpread(const Mesh& mesh, const std::vector<glm::uvec3>& triangles, std::size_t count,
                         const CoarseTexture* coarse) {
  double area = 0.0;
  for (const glm::uvec3& t : triangles) area += 0.5 * glm::length(cornersCross(mesh, t));
  if (!(area > 0.0)) return {};
  LightPoints points;
  double before = 0.0;
  for (const glm::uvec3& t : triangles) {
    const glm::dvec3 cross = cornersCross(mesh, t);
    before += 0.5 * glm::length(cross);
    while (points.size() < count && (double(points.size()) + 0.5) / double(count) * area < before) {
      const glm::dvec2 w = inTriangle(points.size());
      LightPoint& p = points.emplace_back();
      p.position = glm::vec3(mixed(mesh.positions, t, w));
      p.area = float(area / double(count));
      p.normal = glm::vec3(glm::normalize(cross));
      const glm::dvec3 direction = mesh.directions.empty() ? cross : mixed(mesh.directions, t, w);
      p.direction = glm::vec3(glm::normalize(glm::length(direction) > 0.0 ? direction : cross));
      if (coarse != nullptr) p.factor = coarse->at(mixed(mesh.uvs, t, w));
    }
  }
  sortInSpace(points, mesh.bounds);
  return points;
}

constexpr std::size_t kSpreadForPower = 32 * kMostLightPoints;  // points that those by power are chosen from

}  // namespace

LightPoints lightPoints(const Mesh& mesh, const Texture* texture, std::size_t times) {
  const bool textured = texture != nullptr && !mesh.uvs.empty();
  const bool varies = textured || !mesh.directions.empty();
  const bool few = !varies && mesh.evenTriangles().size() <= kFewPolygons;
  const std::optional<CoarseTexture> coarse = textured ? std::optional<CoarseTexture>(*texture) : std::nullopt;
  return evenlySpread(mesh, varies ? mesh.triangles : mesh.evenTriangles(),
                      times * (few ? kPointsOfFewPolygons : kMostLightPoints), coarse ? &*coarse : nullptr);
}

LightPoints lightPointsByPower(const Mesh& mesh, const CoarseTexture* picture) {
  const LightPoints all = evenlySpread(mesh, mesh.triangles, kSpreadForPower, picture);
  const auto brightness = [](const LightPoint& p) { return double(p.factor.x + p.factor.y + p.factor.z); };
  double power = 0.0;
  for (const LightPoint& p : all) power += brightness(p);
  LightPoints points;
  double before = 0.0;
  for (const LightPoint& p : all) {
    const double byArea = 1.0 / double(all.size());
    const double chosen = double(kMostLightPoints) * 0.5 * (byArea + (power > 0.0 ? brightness(p) / power : byArea));
    before += chosen;
    while (double(points.size()) + 0.5 < before && points.size() < kMostLightPoints) {
      points.push_back(p);
      points.back().area = float(double(p.area) / chosen);
    }
  }
  return points;
}

LightPoints transformed(const LightPoints& points, const glm::dmat4& transform) {
  const glm::dmat3 linear(transform);
  const double volume = glm::determinant(linear);
  const glm::dmat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                             glm::cross(linear[0], linear[1]));
  LightPoints out = points;
  for (LightPoint& p : out) {
    const glm::dvec3 normal = cofactors * glm::dvec3(p.normal);
    const double stretch = glm::length(normal);
    const bool aside = p.direction != p.normal;
    p.position = glm::vec3(transform * glm::dvec4(glm::dvec3(p.position), 1.0));
    p.area *= float(stretch);
    if (stretch > 0.0) p.normal = glm::vec3((volume < 0.0 ? -1.0 : 1.0) * normal / stretch);
    p.direction = aside ? glm::vec3(glm::normalize(linear * glm::dvec3(p.direction))) : p.normal;
  }
  return out;
}

}  // namespace lpv
