#include "scene/triangle_bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>

namespace lpv {

namespace {

constexpr int kBins = 16;
constexpr int kDeepest = 64;         ///< from here on splits are in the middle: an unbalanced tree has an end
constexpr double kStepCost = 1.0;    ///< of a box, by that of a triangle
constexpr double kRounding =
    1e-12;  ///< of coordinates: what a box is larger by, so that it holds what its triangles do

struct Box {
  glm::vec3 lower{std::numeric_limits<float>::max()}, upper{std::numeric_limits<float>::lowest()};

  void add(const glm::vec3& a, const glm::vec3& b) {
    lower = glm::min(lower, a);
    upper = glm::max(upper, b);
  }
  void add(const BvhBox& box) { add(box.lower, box.upper); }
  void add(const Box& box) { add(box.lower, box.upper); }
  /// Half of the surface.
  double area() const {
    if (lower.x > upper.x) return 0.0;
    const glm::dvec3 e = glm::dvec3(upper) - glm::dvec3(lower);
    return e.x * e.y + e.y * e.z + e.z * e.x;
  }
};

glm::vec3 centreOf(const BvhBox& box) { return 0.5F * box.lower + 0.5F * box.upper; }

class Builder {
 public:
  Builder(std::span<const BvhBox> boxes, std::uint32_t itemsOfLeaf) : boxes_(boxes), itemsOfLeaf_(itemsOfLeaf) {
    out_.order.resize(boxes.size());
    std::iota(out_.order.begin(), out_.order.end(), 0U);
    if (!boxes.empty()) build(0, std::uint32_t(boxes.size()), 0);
  }
  Bvh take() { return std::move(out_); }

 private:
  struct Split {
    int axis = -1;
    float place = 0.0F;  ///< centres below go first
    double cost = std::numeric_limits<double>::max();
  };

  void build(std::uint32_t begin, std::uint32_t end, int depth) {
    Box all, centres;
    for (std::uint32_t i = begin; i < end; ++i) {
      const BvhBox& box = boxes_[out_.order[i]];
      all.add(box);
      centres.add(centreOf(box), centreOf(box));
    }
    const std::size_t node = out_.nodes.size();
    out_.nodes.push_back({all.lower, 0, all.upper, 0});
    if (end - begin <= itemsOfLeaf_) {
      out_.nodes[node].leaf = begin * kLeafItems + (end - begin);
    } else {
      const std::uint32_t middle = divide(begin, end, depth, all, centres);
      build(begin, middle, depth + 1);
      build(middle, end, depth + 1);
    }
    out_.nodes[node].skip = std::uint32_t(out_.nodes.size());
  }

  std::uint32_t divide(std::uint32_t begin, std::uint32_t end, int depth, const Box& all, const Box& centres) {
    Split best;
    for (int axis = 0; axis < 3 && depth < kDeepest; ++axis) tryAxis(begin, end, axis, all, centres, best);
    const auto first = out_.order.begin() + begin, last = out_.order.begin() + end;
    if (best.axis >= 0) {
      const auto middle = std::stable_partition(
          first, last, [&](std::uint32_t i) { return centreOf(boxes_[i])[best.axis] < best.place; });
      if (middle != first && middle != last) return std::uint32_t(middle - out_.order.begin());
    }
    const glm::vec3 extent = centres.upper - centres.lower;
    const int axis = extent.x >= extent.y ? (extent.x >= extent.z ? 0 : 2) : (extent.y >= extent.z ? 1 : 2);
    std::ranges::stable_sort(first, last, {}, [&](std::uint32_t i) { return centreOf(boxes_[i])[axis]; });
    return begin + (end - begin) / 2;
  }

  void tryAxis(std::uint32_t begin, std::uint32_t end, int axis, const Box& all, const Box& centres,
               Split& best) const {
    const float low = centres.lower[axis], width = (centres.upper[axis] - low) / float(kBins);
    if (!(width > 0.0F)) return;
    std::array<Box, kBins> bins;
    std::array<double, kBins> counts{};
    for (std::uint32_t i = begin; i < end; ++i) {
      const BvhBox& box = boxes_[out_.order[i]];
      const auto bin = std::size_t(std::clamp(int((centreOf(box)[axis] - low) / width), 0, kBins - 1));
      bins[bin].add(box);
      counts[bin] += 1.0;
    }
    std::array<double, kBins> after{};  // area x count of the bins from this one on
    Box right;
    double count = 0.0;
    for (std::size_t b = kBins; b-- > 1;) {
      right.add(bins[b]);
      after[b] = right.area() * (count += counts[b]);
    }
    Box left;
    count = 0.0;
    for (std::size_t b = 0; b + 1 < kBins; ++b) {
      left.add(bins[b]);
      count += counts[b];
      const double cost = kStepCost + (left.area() * count + after[b + 1]) / std::max(all.area(), 1e-300);
      if (count > 0.0 && cost < best.cost) best = {axis, low + float(b + 1) * width, cost};
    }
  }

  std::span<const BvhBox> boxes_;
  std::uint32_t itemsOfLeaf_;
  Bvh out_;
};

BvhTriangle triangleOf(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::dvec3& normal) {
  const glm::vec3 n(glm::normalize(normal));
  return {a, n.x, b, n.y, c, n.z};
}

/// How a corner lies, seen along a segment that begins at the origin: across it, and as a share of its length.
struct Seen {
  double x, y, depth;
};

/// Positive where the segment passes an edge on its left. Never of the wrong sign: products are rounded in order.
double passes(const Seen& a, const Seen& b) { return a.x * b.y - b.x * a.y; }

}  // namespace

Bvh makeBvh(std::span<const BvhBox> boxes, std::uint32_t itemsOfLeaf) { return Builder(boxes, itemsOfLeaf).take(); }

TriangleBvh::TriangleBvh(const Mesh& mesh) {
  constexpr std::uint32_t kTrianglesOfLeaf = 4;
  std::vector<BvhBox> boxes;
  std::vector<BvhTriangle> found;
  std::vector<std::uint32_t> inMesh;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    const glm::dvec3 normal = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
    if (normal == glm::dvec3(0.0)) continue;
    boxes.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
    found.push_back(triangleOf(a, b, c, normal));
    inMesh.push_back(i);
  }
  Bvh bvh = makeBvh(boxes, kTrianglesOfLeaf);
  nodes = std::move(bvh.nodes);
  triangles.reserve(found.size());
  indices.reserve(found.size());
  for (const std::uint32_t i : bvh.order) {
    triangles.push_back(found[i]);
    indices.push_back(inMesh[i]);
  }
}

TriangleBvhPtr bvhOf(const MeshPtr& mesh) {
  static std::mutex lock;
  static std::map<std::weak_ptr<const Mesh>, TriangleBvhPtr, std::owner_less<>> made;
  {
    const std::scoped_lock held(lock);
    const auto known = made.find(mesh);
    if (known != made.end()) return known->second;
  }
  auto bvh = std::make_shared<const TriangleBvh>(*mesh);
  const std::scoped_lock held(lock);
  std::erase_if(made, [](const auto& entry) { return entry.first.expired(); });
  return made.try_emplace(mesh, std::move(bvh)).first->second;
}

BvhSegment::BvhSegment(const glm::dvec3& from, const glm::dvec3& to) : from_(from), direction_(to - from) {
  constexpr double kLeast = 1e-300;
  const glm::dvec3& d = direction_;
  for (int axis = 0; axis < 3; ++axis) inverse_[axis] = 1.0 / (std::abs(d[axis]) < kLeast ? kLeast : d[axis]);
  right_ = std::abs(d.x) > std::abs(d.z) ? glm::dvec3(-d.y, d.x, 0.0) : glm::dvec3(0.0, -d.z, d.y);
  up_ = glm::cross(d, right_);
}

bool BvhSegment::meets(const BvhNode& node) const {
  double enter = 0.0, leave = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double lower = double(node.lower[axis]), upper = double(node.upper[axis]);
    const double margin = kRounding * (std::abs(lower) + std::abs(upper) + std::abs(from_[axis]));
    const double a = (lower - margin - from_[axis]) * inverse_[axis],
                 b = (upper + margin - from_[axis]) * inverse_[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

bool BvhSegment::meets(const BvhTriangle& triangle) const {
  const double length2 = glm::dot(direction_, direction_);
  const auto seen = [&](const glm::vec3& corner) {
    const glm::dvec3 p = glm::dvec3(corner) - from_;
    return Seen{glm::dot(p, right_), glm::dot(p, up_), glm::dot(p, direction_) / length2};
  };
  const Seen a = seen(triangle.first), b = seen(triangle.second), c = seen(triangle.third);
  const double u = passes(b, c), v = passes(c, a), w = passes(a, b);
  const bool inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
  if (!inside || u + v + w == 0.0) return false;
  const glm::dvec3 first(triangle.first);
  const glm::dvec3 normal = glm::cross(glm::dvec3(triangle.second) - first, glm::dvec3(triangle.third) - first);
  // Where the plane is, which its own corners bound: almost along the plane the quotient may be anything.
  const double slope = glm::dot(normal, direction_),
               plane = slope == 0.0 ? a.depth : glm::dot(normal, first - from_) / slope;
  const double at = std::clamp(plane, std::min({a.depth, b.depth, c.depth}), std::max({a.depth, b.depth, c.depth}));
  return at > 0.0 && at < 1.0;
}

bool meets(const TriangleBvh& bvh, const glm::dvec3& from, const glm::dvec3& to) {
  const BvhSegment segment(from, to);
  for (std::size_t at = 0; at < bvh.nodes.size();) {
    const BvhNode& node = bvh.nodes[at];
    if (!segment.meets(node)) {
      at = node.skip;
      continue;
    }
    for (std::uint32_t i = 0; i < node.items(); ++i) {
      if (segment.meets(bvh.triangles[node.firstItem() + i])) return true;
    }
    ++at;
  }
  return false;
}

}  // namespace lpv
