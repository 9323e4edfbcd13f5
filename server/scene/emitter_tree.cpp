#include "scene/emitter_tree.h"

#include <algorithm>
#include <cmath>
#include <glm/gtx/component_wise.hpp>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "base/mutex.h"
#include "scene/triangle_bvh.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

constexpr std::uint32_t kTrianglesOfLeaf = 4;
static_assert(layout::kNormalBins == 54);  // of binOf
constexpr double kOpenedEarlier = 1.15;  ///< than cubes of cells: boxes of triangles are filled to their edges
constexpr double kNextLevel = 0.7;       ///< of a node's size: children that are larger are left out
constexpr double kShapeSteps = 1e6;      ///< shapes that differ by less are one
constexpr float kNoLeastDistance = 1e6F; ///< inverse: nodes are looked at from afar only

struct Triangle {
  glm::dvec3 corners[3];
};

/// Integrals over triangles of one bin.
struct Moments {
  std::size_t bin = 0;
  double area = 0.0;
  glm::dvec3 areaNormal{0.0}, first{0.0};
  glm::dvec3 squares{0.0}, products{0.0};  ///< second moments: xx, yy, zz; xy, xz, yz

  void add(const Moments& more) {
    area += more.area;
    areaNormal += more.areaNormal;
    first += more.first;
    squares += more.squares;
    products += more.products;
  }
};
/// Those that hold something, in order: a node's few triangles look in few directions.
using Bins = std::vector<Moments>;

/// 3 x 3 on each face of a cube, as in shaders/voxelize/normal_bins.glsl.
std::size_t binOf(const glm::dvec3& normal) {
  const glm::dvec3 size = glm::abs(normal);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto third = [&](int other) { return std::clamp(int(1.5 * (normal[other] / size[axis] + 1.0)), 0, 2); };
  const int face = 2 * axis + (normal[axis] < 0.0 ? 1 : 0);
  return std::size_t(9 * face + 3 * third((axis + 1) % 3) + third((axis + 2) % 3));
}

glm::dvec3 productsOf(const glm::dvec3& v) { return {v.x * v.y, v.x * v.z, v.y * v.z}; }

Moments momentsOf(const Triangle& t) {
  const glm::dvec3 &a = t.corners[0], &b = t.corners[1], &c = t.corners[2], middle = (a + b + c) / 3.0;
  Moments m;
  m.areaNormal = 0.5 * glm::cross(b - a, c - a);
  m.bin = binOf(m.areaNormal);
  m.area = glm::length(m.areaNormal);
  m.first = m.area * middle;
  m.squares = m.area / 12.0 * (a * a + b * b + c * c + 9.0 * (middle * middle));
  m.products = m.area / 12.0 * (productsOf(a) + productsOf(b) + productsOf(c) + 9.0 * productsOf(middle));
  return m;
}

/// As in shaders/transport/vpls.glsl.
double spreadOf(double area, double n) {
  const double missing = std::max(area - n, 0.0);
  if (missing <= 1e-6 * area) return std::max(1e-6 * area, 1e-30);
  if (3.0 * area <= 4.0 * n) return std::sqrt(3.0 * n * missing);
  return 0.5 * (area + std::sqrt(std::max(area * area - 4.0 / 3.0 * n * n, 0.0)));
}

void addVpl(const Moments& m, std::vector<glm::vec4>& texels) {
  const glm::dvec3 position = m.first / m.area;
  const glm::dvec3 squares = m.squares / m.area - position * position;
  texels.emplace_back(position, m.area);
  texels.emplace_back(m.areaNormal, spreadOf(m.area, glm::length(m.areaNormal)));
  texels.emplace_back(squares, std::max(squares.x + squares.y + squares.z, 0.0));
  texels.emplace_back(m.products / m.area - productsOf(position), kNoLeastDistance);
}

/// A mesh's triangles with area, in tree space.
std::vector<Triangle> trianglesOf(const Mesh& mesh, const glm::dvec3& scale) {
  const bool mirrors = scale.x * scale.y * scale.z < 0.0;
  std::vector<Triangle> out;
  out.reserve(mesh.evenTriangles().size());
  for (glm::uvec3 t : mesh.evenTriangles()) {
    if (mirrors) std::swap(t.y, t.z);
    Triangle triangle;
    for (int i = 0; i < 3; ++i) triangle.corners[i] = scale * glm::dvec3(mesh.positions[t[i]]);
    const glm::dvec3* c = triangle.corners;
    if (glm::length(glm::cross(c[1] - c[0], c[2] - c[0])) > 0.0) out.push_back(triangle);
  }
  return out;
}

BvhBox boxOf(const Triangle& t) {
  const glm::vec3 a(t.corners[0]), b(t.corners[1]), c(t.corners[2]);
  return {glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))};
}

double sizeOf(const BvhNode& node) { return glm::compMax(glm::dvec3(node.upper) - glm::dvec3(node.lower)); }

/// Those that become entries: leaves, and what is not little smaller than the kept one above it.
std::vector<bool> keptNodes(const Bvh& bvh) {
  struct Open {
    std::uint32_t end;
    double size;
  };
  std::vector<Open> open;
  std::vector<bool> kept(bvh.nodes.size());
  for (std::uint32_t i = 0; i < bvh.nodes.size(); ++i) {
    const BvhNode& node = bvh.nodes[i];
    while (!open.empty() && open.back().end <= i) open.pop_back();
    kept[i] = open.empty() || node.leaf != 0 || sizeOf(node) <= kNextLevel * open.back().size;
    if (kept[i]) open.push_back({node.skip, sizeOf(node)});
  }
  return kept;
}

/// The VPLs of the nodes that are kept, each a number of texels from its first on.
struct NodeVpls {
  struct Range {
    std::size_t first = 0, count = 0;
  };
  std::vector<Range> ofNode;
  std::vector<glm::vec4> texels;
};

/// Bottom-up over nodes, whose children follow them. What waits for the node above lies on a stack, the later child
/// below the earlier one, so that no more is held than a path through the tree has beside it.
class VplMaker {
 public:
  VplMaker(const Bvh& bvh, const std::vector<Triangle>& triangles) : bvh_(bvh), triangles_(triangles) {}

  NodeVpls vplsOf(const std::vector<bool>& kept) {
    NodeVpls out;
    out.ofNode.resize(bvh_.nodes.size());
    for (std::size_t i = bvh_.nodes.size(); i-- > 0;) {
      begins_.push_back(waiting_.size());
      if (const BvhNode& node = bvh_.nodes[i]; node.leaf != 0) {
        for (std::uint32_t k = 0; k < node.items(); ++k) add(triangles_[bvh_.order[node.firstItem() + k]]);
      } else {
        mergeChildren();
      }
      if (kept[i]) out.ofNode[i] = put(out.texels);
    }
    return out;
  }

 private:
  /// To the topmost.
  void add(const Triangle& t) {
    const Moments m = momentsOf(t);
    const auto begin = waiting_.begin() + std::ptrdiff_t(begins_.back());
    const auto at =
        std::lower_bound(begin, waiting_.end(), m.bin, [](const Moments& a, std::size_t b) { return a.bin < b; });
    if (at != waiting_.end() && at->bin == m.bin) {
      at->add(m);
    } else {
      waiting_.insert(at, m);
    }
  }

  /// The two below the topmost, which is empty, become it.
  void mergeChildren() {
    begins_.pop_back();
    const auto early = waiting_.begin() + std::ptrdiff_t(begins_.back());
    begins_.pop_back();
    const auto late = waiting_.begin() + std::ptrdiff_t(begins_.back());
    merged_.clear();
    auto a = early, b = late;
    while (a != waiting_.end() || b != early) {
      const bool first = b == early || (a != waiting_.end() && a->bin <= b->bin);
      const bool both = first && b != early && a->bin == b->bin;
      merged_.push_back(first ? *a++ : *b++);
      if (both) merged_.back().add(*b++);
    }
    waiting_.erase(late, waiting_.end());
    waiting_.insert(waiting_.end(), merged_.begin(), merged_.end());
  }

  /// The topmost.
  NodeVpls::Range put(std::vector<glm::vec4>& texels) const {
    NodeVpls::Range range = {texels.size(), 0};
    for (std::size_t i = begins_.back(); i < waiting_.size(); ++i) {
      if (waiting_[i].area > 0.0) addVpl(waiting_[i], texels);
    }
    range.count = texels.size() - range.first;
    return range;
  }

  const Bvh& bvh_;
  const std::vector<Triangle>& triangles_;
  Bins waiting_, merged_;
  std::vector<std::size_t> begins_;  ///< of each subtree's bins
};

/// Puts the nodes that are kept down in their order, each with its VPLs.
class Entries {
 public:
  Entries(const Bvh& bvh, const std::vector<Triangle>& triangles) {
    const std::vector<bool> kept = keptNodes(bvh);
    const NodeVpls vpls = VplMaker(bvh, triangles).vplsOf(kept);
    texels.reserve(vpls.texels.size() + std::size_t(layout::kPlainEntryTexels) * bvh.nodes.size() +
                   3 * triangles.size());
    for (std::uint32_t i = 0; i < bvh.nodes.size(); ++i) {
      if (kept[i]) add(i, bvh.nodes[i], std::span(vpls.texels).subspan(vpls.ofNode[i].first, vpls.ofNode[i].count));
    }
    closeThoseBefore(~0U);
  }

  std::size_t count() const { return count_; }

  std::vector<glm::vec4> texels;

 private:
  struct Open {
    std::uint32_t end;
    std::size_t entry;
  };

  void add(std::uint32_t at, const BvhNode& node, std::span<const glm::vec4> vpls) {
    closeThoseBefore(at);
    open_.push_back({node.skip, count_});
    const std::size_t count = vpls.size() / layout::kPlainEntryTexels;
    texels.emplace_back(0.5F * (node.lower + node.upper), float(kOpenedEarlier * sizeOf(node)));
    texels.emplace_back(float(count), 0.0F, float(node.items()), float(node.firstItem()));
    texels.resize(texels.size() + 2, glm::vec4(0.0F));
    texels.insert(texels.end(), vpls.begin(), vpls.end());
    count_ += 1 + count;
  }

  void closeThoseBefore(std::uint32_t at) {
    for (; !open_.empty() && open_.back().end <= at; open_.pop_back())
      texels[layout::kPlainEntryTexels * open_.back().entry + 1].y = float(count_);
  }

  std::vector<Open> open_;
  std::size_t count_ = 0;
};

/// The trees of the meshes that are in use.
class KnownTrees {
 public:
  using Shape = std::tuple<std::int64_t, std::int64_t, std::int64_t>;

  EmitterTreePtr find(const MeshPtr& mesh, const Shape& shape) LPV_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    const auto known = trees_.find(mesh);
    if (known == trees_.end() || !known->second.contains(shape)) return nullptr;
    return known->second.at(shape);
  }
  /// The tree that is kept: another thread's where that came first. Of one mesh so many shapes at most.
  EmitterTreePtr keep(const MeshPtr& mesh, const Shape& shape, EmitterTreePtr tree) LPV_EXCLUDES(mutex_) {
    constexpr std::size_t kMostShapes = 16;
    const MutexLock lock(mutex_);
    std::erase_if(trees_, [](const auto& entry) { return entry.first.expired(); });
    auto& shapes = trees_[mesh];
    if (shapes.size() >= kMostShapes) shapes.clear();
    return shapes.try_emplace(shape, std::move(tree)).first->second;
  }

 private:
  Mutex mutex_;
  std::map<std::weak_ptr<const Mesh>, std::map<Shape, EmitterTreePtr>, std::owner_less<>> trees_ LPV_GUARDED_BY(mutex_);
};

KnownTrees& knownTrees() {
  static KnownTrees known;
  return known;
}

/// An affine map without shear in parts.
struct Placing {
  explicit Placing(const glm::dmat4& gridFromObject);

  glm::dvec3 scale, steps;  ///< along the mesh's axes; in units of kShapeSteps, the largest 1
  double largest;
  glm::dmat3 rotation;
  glm::dvec3 translation;

  KnownTrees::Shape shape() const { return {std::int64_t(steps.x), std::int64_t(steps.y), std::int64_t(steps.z)}; }
  PlacedEmitterTree place(EmitterTreePtr tree) const;
};

Placing::Placing(const glm::dmat4& gridFromObject) : translation(gridFromObject[3]) {
  const glm::dmat3 linear(gridFromObject);
  scale = {glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])};
  if (glm::determinant(linear) < 0.0) scale.x = -scale.x;
  largest = glm::compMax(glm::abs(scale));
  steps = glm::round(scale / largest * kShapeSteps);
  rotation = glm::dmat3(linear[0] / scale.x, linear[1] / scale.y, linear[2] / scale.z);
}

PlacedEmitterTree Placing::place(EmitterTreePtr tree) const {
  const glm::dmat3 turn = tree->unit / largest * glm::transpose(rotation);
  glm::dmat4 placed(turn);
  placed[3] = glm::dvec4(-(turn * translation), 1.0);
  return {std::move(tree), placed};
}

}  // namespace

EmitterTree::EmitterTree(const Mesh& mesh, const glm::dvec3& shapeOfIt) : shape(shapeOfIt) {
  const double longest = glm::compMax(glm::abs(shape) * glm::dvec3(mesh.bounds.extent()));
  unit = longest > 0.0 ? 1.0 / longest : 1.0;
  const std::vector<Triangle> triangles = trianglesOf(mesh, unit * shape);
  std::vector<BvhBox> boxes;
  boxes.reserve(triangles.size());
  for (const Triangle& t : triangles) boxes.push_back(boxOf(t));
  const Bvh bvh = makeBvh(boxes, kTrianglesOfLeaf);
  Entries nodes(bvh, triangles);
  entries = nodes.count();
  texels = std::move(nodes.texels);
  const std::size_t begin = texels.size();
  for (std::size_t at = 0; at < begin;) {
    glm::vec4& next = texels[at + 1];
    if (next.z > 0.0F) next.w = float(layout::kTreeSpaceTexels + begin) + 3.0F * next.w;
    at += layout::kPlainEntryTexels * (1 + std::size_t(next.x));
  }
  for (const std::uint32_t i : bvh.order) {
    for (const glm::dvec3& corner : triangles[i].corners) texels.emplace_back(corner, 0.0);
  }
}

PlacedEmitterTree emitterTreeOf(const MeshPtr& mesh, const glm::dmat4& gridFromObject) {
  const Placing placing(gridFromObject);
  EmitterTreePtr tree = knownTrees().find(mesh, placing.shape());
  if (tree == nullptr) {
    const glm::dvec3 rounded = glm::max(glm::abs(placing.steps), 1.0) * glm::sign(placing.scale) / kShapeSteps;
    tree = knownTrees().keep(mesh, placing.shape(), std::make_shared<const EmitterTree>(*mesh, rounded));
  }
  return placing.place(std::move(tree));
}

PlacedEmitterTree knownEmitterTreeOf(const MeshPtr& mesh, const glm::dmat4& gridFromObject) {
  const Placing placing(gridFromObject);
  EmitterTreePtr tree = knownTrees().find(mesh, placing.shape());
  return tree == nullptr ? PlacedEmitterTree() : placing.place(std::move(tree));
}

}  // namespace lpv
