#include "scene/flat_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/gtx/component_wise.hpp>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>

namespace lpv {

namespace {

/// What corners may be off the plane and the outline by, of the largest coordinate: two roundings of a float. Flat is
/// what a file could not have said better; what bends is left as it is. While a patch grows its plane is not that well
/// known.
constexpr double kRounding = 2.5e-7, kGrowing = 4.0;
constexpr std::size_t kLeastPatch = 4;  // triangles
constexpr double kSameArea = 1e-6;  // of a patch's area
constexpr std::int32_t kNone = -1;

using Loop = std::vector<std::uint32_t>;

/// The first vertex at each vertex's place: files repeat vertices for each of their normals.
Loop firstAtPlace(const std::vector<glm::vec3>& positions) {
  Loop order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t i) { return std::tuple(positions[i].x, positions[i].y, positions[i].z, i); };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  Loop first(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool repeated = i > 0 && positions[order[i]] == positions[order[i - 1]];
    first[order[i]] = repeated ? first[order[i - 1]] : order[i];
  }
  return first;
}

/// A mesh's triangles over places, and which of them share an edge that no third one has.
class Patches {
 public:
  explicit Patches(const Mesh& mesh)
      : mesh_(mesh),
        tolerance_(kRounding * glm::compMax(glm::max(glm::abs(mesh.bounds.min), glm::abs(mesh.bounds.max)))) {
    const Loop place = firstAtPlace(mesh.positions);
    for (const glm::uvec3& t : mesh.triangles) triangles_.emplace_back(place[t.x], place[t.y], place[t.z]);
    findNeighbours();
    patchOf_.assign(triangles_.size(), kNone);
  }

  std::vector<glm::uvec3> merged() {
    std::vector<glm::uvec3> out;
    bool fewer = false;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      if (patchOf_[t] != kNone) continue;
      const std::vector<std::uint32_t> patch = grow(std::uint32_t(t));
      const std::optional<Loop> corners =
          patch.size() >= kLeastPatch && isFlat(patch) ? convexOutline(patch) : std::nullopt;
      if (corners && 2 * (corners->size() - 2) <= patch.size()) {
        for (std::size_t i = 2; i < corners->size(); ++i)
          out.emplace_back((*corners)[0], (*corners)[i - 1], (*corners)[i]);
        fewer = true;
      } else {
        for (const std::uint32_t i : patch) out.push_back(mesh_.triangles[i]);
      }
    }
    return fewer ? out : std::vector<glm::uvec3>();
  }

 private:
  /// Of a triangle, beside the edge from its place with the lower number.
  struct Side {
    std::uint32_t higher, triangle;
    std::uint8_t corner;
    bool forward;
    bool operator<(const Side& other) const {
      return std::tuple(higher, triangle, corner) < std::tuple(other.higher, other.triangle, other.corner);
    }
  };

  /// Sides by the lower place of their edges: few have the same one, so that no long list is sorted.
  void findNeighbours() {
    const auto lower = [this](std::size_t t, int k) { return std::min(triangles_[t][k], triangles_[t][(k + 1) % 3]); };
    std::vector<std::uint32_t> ends(mesh_.positions.size() + 1, 0);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (int k = 0; k < 3; ++k) ends[lower(t, k) + 1]++;
    }
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    std::vector<Side> sides(3 * triangles_.size());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
        sides[ends[std::min(a, b)]++] = {std::max(a, b), t, std::uint8_t(k), a < b};
      }
    }
    neighbours_.assign(triangles_.size(), {kNone, kNone, kNone});
    std::uint32_t begin = 0;
    for (const std::uint32_t end : ends) {
      const std::span<Side> around = std::span(sides).subspan(begin, end - begin);
      std::ranges::sort(around, std::less<>());
      join(around);
      begin = end;
    }
  }

  /// Those of two triangles that share an edge which no third one has, and turn the same way.
  void join(std::span<const Side> sides) {
    for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
      while (end < sides.size() && sides[end].higher == sides[i].higher) ++end;
      if (end != i + 2 || sides[i].forward == sides[i + 1].forward) continue;
      neighbours_[sides[i].triangle][sides[i].corner] = std::int32_t(sides[i + 1].triangle);
      neighbours_[sides[i + 1].triangle][sides[i + 1].corner] = std::int32_t(sides[i].triangle);
    }
  }

  glm::dvec3 at(std::uint32_t place) const { return glm::dvec3(mesh_.positions[place]); }
  glm::dvec3 areaNormal(const glm::uvec3& t) const { return 0.5 * glm::cross(at(t.y) - at(t.x), at(t.z) - at(t.x)); }

  /// The mean plane of what a patch has so far.
  struct Plane {
    glm::dvec3 areaNormal{0.0}, moment{0.0};
    double area = 0.0;
    void add(const glm::dvec3& normal, const glm::dvec3& centroid) {
      areaNormal += normal;
      area += glm::length(normal);
      moment += glm::length(normal) * centroid;
    }
    double height(const glm::dvec3& p) const {
      return glm::dot(p - moment / area, areaNormal) / glm::length(areaNormal);
    }
  };

  void addTo(Plane& plane, const glm::uvec3& t) const { plane.add(areaNormal(t), (at(t.x) + at(t.y) + at(t.z)) / 3.0); }
  bool isIn(const Plane& plane, const glm::uvec3& t) const {
    if (!(glm::dot(areaNormal(t), plane.areaNormal) > 0.0)) return false;
    const double most = kGrowing * tolerance_;
    return std::abs(plane.height(at(t.x))) <= most && std::abs(plane.height(at(t.y))) <= most &&
           std::abs(plane.height(at(t.z))) <= most;
  }

  /// What is joined to a triangle and lies in its plane, ascending; a triangle without area is alone.
  std::vector<std::uint32_t> grow(std::uint32_t seed) {
    patchOf_[seed] = std::int32_t(seed);
    std::vector<std::uint32_t> patch = {seed};
    Plane plane;
    addTo(plane, triangles_[seed]);
    if (!(plane.area > 0.0)) return patch;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      for (const std::int32_t next : neighbours_[patch[i]]) {
        if (next == kNone || patchOf_[std::size_t(next)] != kNone || !isIn(plane, triangles_[std::size_t(next)]))
          continue;
        patchOf_[std::size_t(next)] = std::int32_t(seed);
        patch.push_back(std::uint32_t(next));
        addTo(plane, triangles_[std::size_t(next)]);
      }
    }
    std::sort(patch.begin(), patch.end());
    return patch;
  }

  /// Whether all corners lie in the mean plane, which becomes the patch's.
  bool isFlat(const std::vector<std::uint32_t>& patch) {
    glm::dvec3 sum(0.0);
    for (const std::uint32_t t : patch) sum += areaNormal(triangles_[t]);
    normal_ = glm::normalize(sum);
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const std::uint32_t t : patch) {
      for (int k = 0; k < 3; ++k) {
        const double height = glm::dot(at(triangles_[t][k]), normal_);
        least = std::min(least, height);
        most = std::max(most, height);
      }
    }
    return most - least <= 2.0 * tolerance_;
  }

  /// The patch's outline as one loop; nothing where there are several or it touches itself.
  std::optional<Loop> outline(const std::vector<std::uint32_t>& patch) const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;  // from, to
    for (const std::uint32_t t : patch) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t next = neighbours_[t][k];
        if (next != kNone && patchOf_[std::size_t(next)] == patchOf_[t]) continue;
        edges.emplace_back(triangles_[t][int(k)], triangles_[t][int((k + 1) % 3)]);
      }
    }
    std::sort(edges.begin(), edges.end());
    Loop loop;
    for (std::uint32_t from = edges.front().first; loop.size() < edges.size();) {
      const auto edge = std::lower_bound(edges.begin(), edges.end(), std::pair(from, 0U));
      if (edge == edges.end() || edge->first != from) return std::nullopt;
      if (const auto other = edge + 1; other != edges.end() && other->first == from) return std::nullopt;
      loop.push_back(from);
      from = edge->second;
      if (from == edges.front().first) break;
    }
    return loop.size() == edges.size() ? std::optional(loop) : std::nullopt;
  }

  /// Twice the area of the triangle over three places, seen from the front.
  double turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return glm::dot(glm::cross(at(b) - at(a), at(c) - at(b)), normal_);
  }

  /// The corners of a convex outline, from the one at the least place on, so that how the patch was cut up does not
  /// matter.
  std::optional<Loop> convexOutline(const std::vector<std::uint32_t>& patch) const {
    const std::optional<Loop> loop = outline(patch);
    if (!loop) return std::nullopt;
    Loop corners;
    double area = 0.0;
    for (std::size_t i = 0, n = loop->size(); i < n; ++i) {
      const std::uint32_t a = (*loop)[(i + n - 1) % n], b = (*loop)[i], c = (*loop)[(i + 1) % n];
      if (std::abs(turn(a, b, c)) > tolerance_ * glm::length(at(c) - at(a))) corners.push_back(b);
    }
    for (std::size_t i = 0, n = corners.size(); i < n; ++i) {
      if (turn(corners[(i + n - 1) % n], corners[i], corners[(i + 1) % n]) <= 0.0) return std::nullopt;
      if (i >= 2) area += 0.5 * turn(corners[0], corners[i - 1], corners[i]);
    }
    double want = 0.0;
    for (const std::uint32_t t : patch) want += glm::length(areaNormal(triangles_[t]));
    if (corners.size() < 3 || std::abs(area - want) > kSameArea * want) return std::nullopt;
    const auto less = [&](std::uint32_t a, std::uint32_t b) {
      const glm::vec3 &p = mesh_.positions[a], &q = mesh_.positions[b];
      return std::tuple(p.x, p.y, p.z) < std::tuple(q.x, q.y, q.z);
    };
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), less), corners.end());
    return corners;
  }

  const Mesh& mesh_;
  double tolerance_;
  std::vector<glm::uvec3> triangles_;
  std::vector<std::array<std::int32_t, 3>> neighbours_;
  std::vector<std::int32_t> patchOf_;
  glm::dvec3 normal_{0.0};  ///< of the patch at hand
};

}  // namespace

std::vector<glm::uvec3> flatPatchesMerged(const Mesh& mesh) { return Patches(mesh).merged(); }

}  // namespace lpv
