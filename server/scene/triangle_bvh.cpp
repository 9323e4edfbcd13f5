#include "scene/triangle_bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/mutex.h"

namespace lpv {

namespace {

constexpr std::size_t kBins = 16, kFewBins = 8;  ///< that a range is divided into along each axis, and a short one
constexpr std::uint32_t kFewItems = 32;
constexpr int kDeepest = 64;  ///< from here on splits are in the middle: an unbalanced tree has an end
/// Of coordinates: what a box is larger by, so that it holds what its triangles do.
constexpr double kRounding = 1e-12;

/// Written out by coordinates: a million triangles are added some twenty times, along three axes.
struct Box {
  float lower[3] = {kNone, kNone, kNone}, upper[3] = {-kNone, -kNone, -kNone};

  void add(const float (&low)[3], const float (&high)[3]) {
    for (int i = 0; i < 3; ++i) {
      lower[i] = low[i] < lower[i] ? low[i] : lower[i];
      upper[i] = high[i] > upper[i] ? high[i] : upper[i];
    }
  }
  void add(const Box& box) { add(box.lower, box.upper); }
  /// Half of the surface; 0 where nothing was added.
  float area() const {
    if (lower[0] > upper[0]) return 0.0F;
    const float x = upper[0] - lower[0], y = upper[1] - lower[1], z = upper[2] - lower[2];
    return x * y + y * z + z * x;
  }

 private:
  static constexpr float kNone = std::numeric_limits<float>::max();
};

/// An item while the tree is made: moved as a whole, so that what is looked at together lies together.
struct Item {
  float lower[3], upper[3];
  std::uint32_t index;

  /// Twice the centre's coordinate.
  float centre(int axis) const { return lower[axis] + upper[axis]; }
};

class Builder {
 public:
  Builder(std::span<const BvhBox> boxes, std::uint32_t itemsOfLeaf) : itemsOfLeaf_(itemsOfLeaf) {
    items_.reserve(boxes.size());
    for (const BvhBox& b : boxes) {
      items_.push_back(
          {{b.lower.x, b.lower.y, b.lower.z}, {b.upper.x, b.upper.y, b.upper.z}, std::uint32_t(items_.size())});
    }
    out_.nodes.reserve(boxes.size());
    if (!boxes.empty()) build(0, std::uint32_t(boxes.size()), 0);
    out_.order.reserve(items_.size());
    for (const Item& item : items_) out_.order.push_back(item.index);
  }
  Bvh take() { return std::move(out_); }

 private:
  struct Bin {
    Box box;
    std::uint32_t items = 0;
  };
  struct Split {
    int axis = -1;
    std::size_t bin = 0;  ///< the first one that goes to the second part
    float cost = std::numeric_limits<float>::max();
  };
  /// Bins over the centres of a range.
  struct Binning {
    std::size_t bins;
    float low[3], scale[3];
    std::size_t binOf(const Item& item, int axis) const {
      return std::min(std::size_t((item.centre(axis) - low[axis]) * scale[axis]), bins - 1);
    }
  };

  void build(std::uint32_t begin, std::uint32_t end, int depth) {
    Box all, centres;
    for (std::uint32_t i = begin; i < end; ++i) {
      const Item& item = items_[i];
      const float centre[3] = {item.centre(0), item.centre(1), item.centre(2)};
      all.add(item.lower, item.upper);
      centres.add(centre, centre);
    }
    const std::size_t node = out_.nodes.size();
    out_.nodes.push_back(
        {{all.lower[0], all.lower[1], all.lower[2]}, 0, {all.upper[0], all.upper[1], all.upper[2]}, 0});
    if (end - begin <= itemsOfLeaf_) {
      out_.nodes[node].leaf = begin * kLeafItems + (end - begin);
    } else {
      const std::uint32_t middle = depth < kDeepest ? divide(begin, end, centres) : halve(begin, end, centres);
      build(begin, middle, depth + 1);
      build(middle, end, depth + 1);
    }
    out_.nodes[node].skip = std::uint32_t(out_.nodes.size());
  }

  std::uint32_t divide(std::uint32_t begin, std::uint32_t end, const Box& centres) {
    Binning binning = {.bins = end - begin < kFewItems ? kFewBins : kBins, .low = {}, .scale = {}};
    for (int axis = 0; axis < 3; ++axis) {
      const float width = centres.upper[axis] - centres.lower[axis];
      binning.low[axis] = centres.lower[axis];
      const float scale = float(binning.bins) / width;
      binning.scale[axis] = width > 0.0F && std::isfinite(scale) ? scale : 0.0F;
    }
    const Split best = bestSplit(begin, end, binning);
    if (best.axis < 0) return halve(begin, end, centres);
    const auto middle = std::partition(items_.begin() + begin, items_.begin() + end,
                                       [&](const Item& item) { return binning.binOf(item, best.axis) < best.bin; });
    return std::uint32_t(middle - items_.begin());
  }

  Split bestSplit(std::uint32_t begin, std::uint32_t end, const Binning& binning) const {
    std::array<std::array<Bin, kBins>, 3> bins;
    for (std::uint32_t i = begin; i < end; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        Bin& bin = bins[std::size_t(axis)][binning.binOf(items_[i], axis)];
        bin.box.add(items_[i].lower, items_[i].upper);
        bin.items++;
      }
    }
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      if (binning.scale[axis] > 0.0F) tryAxis(std::span(bins[std::size_t(axis)]).first(binning.bins), axis, best);
    }
    return best;
  }

  /// Of the places between bins the one with the least area x items on both sides.
  static void tryAxis(std::span<const Bin> bins, int axis, Split& best) {
    std::array<float, kBins> after{};  // of the bins from this one on
    Bin right, left;
    for (std::size_t b = bins.size(); b-- > 1;) {
      right.box.add(bins[b].box);
      right.items += bins[b].items;
      after[b] = right.box.area() * float(right.items);
    }
    const std::uint32_t all = right.items + bins[0].items;
    for (std::size_t b = 1; b < bins.size(); ++b) {
      left.box.add(bins[b - 1].box);
      left.items += bins[b - 1].items;
      const float cost = left.box.area() * float(left.items) + after[b];
      if (left.items > 0 && left.items < all && cost < best.cost) best = {axis, b, cost};
    }
  }

  std::uint32_t halve(std::uint32_t begin, std::uint32_t end, const Box& centres) {
    int axis = 0;
    for (int other = 1; other < 3; ++other) {
      if (centres.upper[other] - centres.lower[other] > centres.upper[axis] - centres.lower[axis]) axis = other;
    }
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end,
                     [&](const Item& a, const Item& b) {
                       return std::pair(a.centre(axis), a.index) < std::pair(b.centre(axis), b.index);
                     });
    return middle;
  }

  std::uint32_t itemsOfLeaf_;
  std::vector<Item> items_;
  Bvh out_;
};

BvhTriangle triangleOf(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::dvec3& normal) {
  const glm::vec3 n(glm::normalize(normal));
  return {a, n.x, b, n.y, c, n.z};
}

/// On which side a segment passes an edge, whose ends are seen along it. Never of the wrong sign: products are rounded
/// in order.
double passes(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - b.x * a.y; }

/// Whether a segment that passes an edge on `side` is on the triangle's: one through the edge itself belongs to the
/// triangle that has it in this direction, which its neighbour has turned over.
bool isWithin(double side, const glm::dvec2& edge) {
  return side > 0.0 || (side == 0.0 && (edge.y > 0.0 || (edge.y == 0.0 && edge.x > 0.0)));
}

}  // namespace

Bvh makeBvh(std::span<const BvhBox> boxes, std::uint32_t itemsOfLeaf) { return Builder(boxes, itemsOfLeaf).take(); }

TriangleBvh::TriangleBvh(const Mesh& mesh) {
  constexpr std::uint32_t kTrianglesOfLeaf = 3;
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

namespace {

/// The trees of the meshes that are in use.
class KnownTrees {
 public:
  TriangleBvhPtr find(const MeshPtr& mesh) LPV_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    const auto known = trees_.find(mesh);
    return known == trees_.end() ? nullptr : known->second;
  }

  /// The tree that is kept: another thread's where that came first.
  TriangleBvhPtr keep(const MeshPtr& mesh, TriangleBvhPtr tree) LPV_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    std::erase_if(trees_, [](const auto& entry) { return entry.first.expired(); });
    return trees_.try_emplace(mesh, std::move(tree)).first->second;
  }

 private:
  Mutex mutex_;
  std::map<std::weak_ptr<const Mesh>, TriangleBvhPtr, std::owner_less<>> trees_ LPV_GUARDED_BY(mutex_);
};

}  // namespace

TriangleBvhPtr bvhOf(const MeshPtr& mesh) {
  static KnownTrees known;
  if (auto tree = known.find(mesh)) return tree;
  return known.keep(mesh, std::make_shared<const TriangleBvh>(*mesh));
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

BvhSegment::Seen BvhSegment::seen(const BvhTriangle& triangle) const {
  const auto across = [&](const glm::dvec3& p) { return glm::dvec2(glm::dot(p, right_), glm::dot(p, up_)); };
  Seen t{glm::dvec3(triangle.first) - from_,
         glm::dvec3(triangle.second) - from_,
         glm::dvec3(triangle.third) - from_,
         {},
         {},
         {},
         {}};
  t.a = across(t.first);
  t.b = across(t.second);
  t.c = across(t.third);
  t.sides = {passes(t.b, t.c), passes(t.c, t.a), passes(t.a, t.b)};
  return t;
}

/// Sides of 0 say nothing where the segment passes beside the box of all corners.
bool BvhSegment::Seen::near() const {
  const glm::dvec2 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
  return low.x <= 0.0 && low.y <= 0.0 && high.x >= 0.0 && high.y >= 0.0;
}

/// Where the triangle's plane is met: 0..1 between the ends, 2 for none.
double BvhSegment::planeAt(const Seen& t) const {
  const glm::dvec3 normal = glm::cross(t.second - t.first, t.third - t.first);
  const double slope = glm::dot(normal, direction_);
  return slope == 0.0 ? 2.0 : glm::dot(normal, t.first) / slope;
}

bool BvhSegment::isInside(const Seen& t) const {
  const double u = t.sides.x, v = t.sides.y, w = t.sides.z;
  return t.near() && ((u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0));
}

std::optional<double> BvhSegment::where(const BvhTriangle& triangle) const {
  const Seen t = seen(triangle);
  if (!isInside(t)) return std::nullopt;
  const double at = planeAt(t);
  return at > 0.0 && at < 1.0 ? std::optional(at) : std::nullopt;
}

bool BvhSegment::meets(const BvhTriangle& triangle) const { return where(triangle).has_value(); }

std::optional<glm::dvec3> BvhSegment::crossing(const BvhTriangle& triangle) const {
  const Seen t = seen(triangle);
  const double all = t.sides.x + t.sides.y + t.sides.z;
  if (!t.near() || all == 0.0) return std::nullopt;
  const double turn = all > 0.0 ? 1.0 : -1.0;
  const bool inside = isWithin(turn * t.sides.x, turn * (t.c - t.b)) &&
                      isWithin(turn * t.sides.y, turn * (t.a - t.c)) && isWithin(turn * t.sides.z, turn * (t.b - t.a));
  const double at = planeAt(t);
  if (!inside || !(at > 0.0 && at < 1.0)) return std::nullopt;
  return t.sides / all;
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

std::optional<BvhHit> firstHit(const TriangleBvh& bvh, const glm::dvec3& from, const glm::dvec3& to) {
  const BvhSegment segment(from, to);
  std::optional<BvhHit> found;
  for (std::size_t at = 0; at < bvh.nodes.size();) {
    const BvhNode& node = bvh.nodes[at];
    if (!segment.meets(node)) {
      at = node.skip;
      continue;
    }
    ++at;
    for (std::uint32_t i = node.firstItem(); i < node.firstItem() + node.items(); ++i) {
      const std::optional<double> where = segment.where(bvh.triangles[i]);
      if (!where || (found && *where >= found->at)) continue;
      const BvhTriangle& t = bvh.triangles[i];
      const double towards = glm::dot(glm::dvec3(t.normalX, t.normalY, t.normalZ), to - from);
      found = {*where, i, towards < 0.0};
    }
  }
  return found;
}

}  // namespace lpv
