#include "scene/merged_triangles.h"

#include <algorithm>
#include <cmath>
#include <glm/gtx/component_wise.hpp>
#include <limits>
#include <numeric>
#include <tuple>

#include "scene/triangle_bvh.h"

namespace lpv {

namespace {

struct LessTriangle {
  bool operator()(const glm::uvec3& a, const glm::uvec3& b) const {
    return std::tuple(a.x, a.y, a.z) < std::tuple(b.x, b.y, b.z);
  }
};

/// How far a point is from a triangle, about: 0 in its plane and inside.
double distanceFrom(const Mesh& mesh, const glm::uvec3& t, const glm::dvec3& p) {
  const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
  const glm::dvec3 cross = glm::cross(b - a, c - a);
  const double twice = glm::length(cross);
  if (!(twice > 0.0)) return std::numeric_limits<double>::infinity();
  const glm::dvec3 n = cross / twice;
  const auto outside = [&](const glm::dvec3& from, const glm::dvec3& to) {
    return glm::dot(glm::cross(p - from, to - from), n) / glm::length(to - from);
  };
  return std::max({std::abs(glm::dot(p - a, n)), outside(a, b), outside(b, c), outside(c, a)});
}

/// What flat patches became, by place.
class Merged {
 public:
  Merged(const Mesh& mesh, std::vector<std::uint32_t> triangles) : mesh_(mesh), triangles_(std::move(triangles)) {
    std::vector<BvhBox> boxes;
    for (const std::uint32_t i : triangles_) {
      const glm::uvec3& t = mesh.merged[i];
      const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
      boxes.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
    }
    bvh_ = makeBvh(boxes, 4);
    const glm::dvec3 size = mesh.bounds.max - mesh.bounds.min;
    margin_ = 1e-5 * glm::compMax(size);
  }

  /// The nearest of those around a point.
  std::uint32_t at(const glm::dvec3& p) const {
    std::uint32_t best = triangles_.front();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < bvh_.nodes.size();) {
      const BvhNode& node = bvh_.nodes[i];
      const bool inside = glm::all(glm::greaterThanEqual(p, glm::dvec3(node.lower) - margin_)) &&
                          glm::all(glm::lessThanEqual(p, glm::dvec3(node.upper) + margin_));
      for (std::uint32_t k = 0; inside && k < node.items(); ++k) {
        const std::uint32_t triangle = triangles_[bvh_.order[node.firstItem() + k]];
        const double distance = distanceFrom(mesh_, mesh_.merged[triangle], p);
        if (distance < least) best = triangle;
        least = std::min(least, distance);
      }
      i = inside ? i + 1 : node.skip;
    }
    return best;
  }

 private:
  const Mesh& mesh_;
  std::vector<std::uint32_t> triangles_;  ///< of Mesh::merged
  Bvh bvh_;
  double margin_ = 0.0;
};

}  // namespace

std::vector<std::uint32_t> mergedTriangleOf(const Mesh& mesh) {
  std::vector<std::uint32_t> out(mesh.triangles.size());
  std::iota(out.begin(), out.end(), 0U);
  if (mesh.merged.empty()) return out;
  std::vector<std::uint32_t> order(mesh.merged.size());
  std::iota(order.begin(), order.end(), 0U);
  const LessTriangle less;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return less(mesh.merged[a], mesh.merged[b]); });
  std::vector<bool> kept(mesh.merged.size(), false);
  std::vector<std::uint32_t> gone;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto same = std::lower_bound(order.begin(), order.end(), mesh.triangles[i],
                                       [&](std::uint32_t m, const glm::uvec3& t) { return less(mesh.merged[m], t); });
    if (same == order.end() || mesh.merged[*same] != mesh.triangles[i]) {
      gone.push_back(i);
      continue;
    }
    out[i] = *same;
    kept[*same] = true;
  }
  if (gone.empty()) return out;
  std::vector<std::uint32_t> fans;
  for (std::uint32_t i = 0; i < mesh.merged.size(); ++i) {
    if (!kept[i]) fans.push_back(i);
  }
  if (fans.empty()) return out;
  const Merged merged(mesh, std::move(fans));
  for (const std::uint32_t i : gone) {
    const glm::uvec3& t = mesh.triangles[i];
    out[i] = merged.at(
        (glm::dvec3(mesh.positions[t.x]) + glm::dvec3(mesh.positions[t.y]) + glm::dvec3(mesh.positions[t.z])) / 3.0);
  }
  return out;
}

}  // namespace lpv
