#include "scene/triangle_bvh.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>

namespace lpv {

namespace {

constexpr int kBins = 16;
constexpr int kDeepest = 64;         ///< from here on splits are in the middle: an unbalanced tree has an end
constexpr double kStepCost = 1.0;    ///< of a box, by that of a triangle
constexpr double kEdges = 1e-6;      ///< by which a triangle is wider than it is: no ray slips between two

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
      const auto middle = std::stable_partition(first, last, [&](std::uint32_t i) {
        return centreOf(boxes_[i])[best.axis] < best.place;
      });
      if (middle != first && middle != last) return std::uint32_t(middle - out_.order.begin());
    }
    const glm::vec3 extent = centres.upper - centres.lower;
    const int axis = extent.x >= extent.y ? (extent.x >= extent.z ? 0 : 2) : (extent.y >= extent.z ? 1 : 2);
    std::ranges::stable_sort(first, last, {}, [&](std::uint32_t i) { return centreOf(boxes_[i])[axis]; });
    return begin + (end - begin) / 2;
  }

  void tryAxis(std::uint32_t begin, std::uint32_t end, int axis, const Box& all, const Box& centres, Split& best) const {
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

bool meets(const BvhTriangle& t, const glm::dvec3& from, const glm::dvec3& direction) {
  const glm::dvec3 first(t.first), second(t.second), p = glm::cross(direction, second);
  const double determinant = glm::dot(first, p);
  if (determinant == 0.0) return false;
  const glm::dvec3 offset = from - glm::dvec3(t.corner);
  const double u = glm::dot(offset, p) / determinant;
  const glm::dvec3 q = glm::cross(offset, first);
  const double v = glm::dot(direction, q) / determinant, at = glm::dot(second, q) / determinant;
  return u >= -kEdges && v >= -kEdges && u + v <= 1.0 + kEdges && at > 0.0 && at < 1.0;
}

}  // namespace

Bvh makeBvh(std::span<const BvhBox> boxes, std::uint32_t itemsOfLeaf) { return Builder(boxes, itemsOfLeaf).take(); }

TriangleBvh::TriangleBvh(const Mesh& mesh) {
  constexpr std::uint32_t kTrianglesOfLeaf = 4;
  std::vector<BvhBox> boxes;
  std::vector<BvhTriangle> found;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    if (glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a)) == glm::dvec3(0.0)) continue;
    boxes.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
    found.push_back({a, i, b - a, 0, c - a, 0});
  }
  Bvh bvh = makeBvh(boxes, kTrianglesOfLeaf);
  nodes = std::move(bvh.nodes);
  triangles.reserve(found.size());
  for (const std::uint32_t i : bvh.order) triangles.push_back(found[i]);
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

bool meets(const BvhNode& node, const glm::dvec3& from, const glm::dvec3& inverse) {
  constexpr double kRoundedOff = 1e-12;
  double enter = 0.0, leave = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (double(node.lower[axis]) - from[axis]) * inverse[axis];
    const double b = (double(node.upper[axis]) - from[axis]) * inverse[axis];
    if (std::min(a, b) > enter) enter = std::min(a, b);
    if (std::max(a, b) < leave) leave = std::max(a, b);
  }
  return enter <= leave + kRoundedOff;
}

bool meets(const TriangleBvh& bvh, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 direction = to - from, inverse = 1.0 / direction;
  for (std::size_t at = 0; at < bvh.nodes.size();) {
    const BvhNode& node = bvh.nodes[at];
    if (!meets(node, from, inverse)) {
      at = node.skip;
      continue;
    }
    for (std::uint32_t i = 0; i < node.items(); ++i) {
      if (meets(bvh.triangles[node.firstItem() + i], from, direction)) return true;
    }
    ++at;
  }
  return false;
}

}  // namespace lpv
