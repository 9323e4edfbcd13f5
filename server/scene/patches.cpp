#include "scene/patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <glm/gtx/component_wise.hpp>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <utility>

#include "scene/coarse_texture.h"
#include "scene/grid_choice.h"
#include "scene/merged_triangles.h"
#include "scene/shadowing.h"
#include "scene/transparency.h"
#include "scene/triangle_pools.h"

namespace lpv {

namespace {

int sidesOf(const Surface& surface) { return surface.twoSided ? 2 : 1; }

double areaOf(const Surface& surface) { return worldArea(*surface.mesh, surface.transform) * sidesOf(surface); }

/// The highest reflectance that the surface has anywhere.
double highestAlbedo(const Surface& surface) { return alphaOf(surface, 255) * glm::compMax(surface.albedo); }

/// By the alpha of a texel, what of its albedo the surface reflects; empty: all.
std::vector<float> alphaFactors(const Surface& surface) {
  std::vector<float> out;
  for (int texel = 0; alphaVaries(surface) && texel < 256; ++texel)
    out.push_back(float(alphaOf(surface, std::uint8_t(texel))));
  return out;
}

bool albedoVaries(const Surface& surface) { return surface.albedoTexture != nullptr && !surface.mesh->uvs.empty(); }

constexpr double kBefore = 1e-5;  // of the surfaces' diagonal: what is no further before a side is on its plane

/// Whether all surfaces and lights are behind a side, so that no light comes there or goes from there: the outside of a
/// room's walls.
bool isBehind(const LitSpace& space, const glm::dvec3& at, const glm::dvec3& n) {
  double farthest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(n[axis]) < kBefore) continue;
    const bool up = n[axis] > 0.0;
    if (space.open[up][std::size_t(axis)]) return false;
    farthest += n[axis] * ((up ? space.surfaces.max : space.surfaces.min)[axis] - at[axis]);
  }
  return farthest <= kBefore * glm::length(space.surfaces.extent());
}

/// A piece of a triangle: places in its plane by the weights of its second and third corner.
struct Piece {
  glm::dvec2 corners[3] = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
  double area = 0.0;

  glm::dvec2 middle() const { return (corners[0] + corners[1] + corners[2]) / 3.0; }
};

/// A surface's triangles, world space.
class Triangles {
 public:
  Triangles(const Surface& surface, std::size_t number)
      : surface_(surface),
        number_(number),
        varies_(albedoVaries(surface)),
        albedo_(alphaVaries(surface) ? surface.albedo : alphaOf(surface, 255) * surface.albedo),
        texture_(varies_ ? std::make_unique<CoarseTexture>(*surface.albedoTexture, alphaFactors(surface)) : nullptr) {
    const glm::dmat4 worldFromObject = surface.transform.worldFromObject();
    for (const glm::vec3& p : surface.mesh->positions)
      positions_.emplace_back(worldFromObject * glm::dvec4(glm::dvec3(p), 1.0));
  }

  const std::vector<glm::uvec3>& all() const { return patchedTriangles(surface_); }
  double area(const glm::uvec3& t) const { return 0.5 * glm::length(cross(t)); }
  /// How many sides of a triangle light may come to.
  int litSides(const glm::uvec3& t, const LitSpace& space) const {
    const glm::dvec3 n = normal(t), at = positions_[t.x];
    return (isBehind(space, at, n) ? 0 : 1) + (surface_.twoSided && !isBehind(space, at, -n) ? 1 : 0);
  }
  /// Of all of these.
  double area(const LitSpace& space) const {
    double sum = 0.0;
    for (const glm::uvec3& t : all()) sum += area(t) > 0.0 ? area(t) * litSides(t, space) : 0.0;
    return sum;
  }
  /// How far the corners of a triangle are from a place at the most.
  float farthest(const glm::uvec3& t, const glm::vec3& from) const {
    double out = 0.0;
    for (int i = 0; i < 3; ++i) out = std::max(out, glm::distance(positions_[t[i]], glm::dvec3(from)));
    return float(out);
  }
  const Surface& surface() const { return surface_; }
  std::size_t number() const { return number_; }
  /// By triangle of the mesh: which of all() it is part of.
  std::vector<std::uint32_t> indices() const {
    if (!varies_) return mergedTriangleOf(*surface_.mesh);
    std::vector<std::uint32_t> out(surface_.mesh->triangles.size());
    std::iota(out.begin(), out.end(), 0U);
    return out;
  }
  /// Halved along the longest edge until no piece is larger than `most`; appends the pieces' patches.
  void split(const glm::uvec3& t, double most, std::vector<Patch>& out) const {
    std::vector<Piece> open = {Piece{.area = area(t)}};
    while (!open.empty()) {
      const Piece piece = open.back();
      open.pop_back();
      if (piece.area <= most) {
        out.push_back(patch(t, piece));
        out.back().triangle = corners(t, piece);
        continue;
      }
      const int longest = longestEdge(t, piece);
      const glm::dvec2 &a = piece.corners[longest], &b = piece.corners[(longest + 1) % 3],
                       &c = piece.corners[(longest + 2) % 3], half = 0.5 * (a + b);
      open.push_back({{half, b, c}, 0.5 * piece.area});
      open.push_back({{a, half, c}, 0.5 * piece.area});
    }
  }
  /// Of all of a triangle.
  Patch patch(const glm::uvec3& t) const { return patch(t, Piece{.area = area(t)}); }

 private:
  Patch patch(const glm::uvec3& t, const Piece& piece) const {
    const glm::vec3 albedo = glm::vec3(albedo_) * (texture_ != nullptr ? textureOver(t, piece) : glm::vec3(1.0F));
    return {glm::vec3(at(t, piece.middle())), float(piece.area), glm::vec3(normal(t)), albedo, std::nullopt};
  }
  /// The mean of the texture: a patch of a floor has many boards.
  glm::vec3 textureOver(const glm::uvec3& t, const Piece& piece) const {
    const std::vector<glm::vec2>& uv = surface_.mesh->uvs;
    const glm::dvec2 origin(uv[t.x]), right = glm::dvec2(uv[t.y]) - origin, up = glm::dvec2(uv[t.z]) - origin;
    glm::dvec2 corners[3];
    for (int i = 0; i < 3; ++i) corners[i] = origin + piece.corners[i].x * right + piece.corners[i].y * up;
    return texture_->meanOver(corners);
  }
  glm::dvec3 normal(const glm::uvec3& t) const {
    return (surface_.transform.mirrors() ? -1.0 : 1.0) * glm::normalize(cross(t));
  }
  std::array<glm::vec3, 3> corners(const glm::uvec3& t, const Piece& piece) const {
    std::array<glm::vec3, 3> out;
    for (std::size_t i = 0; i < 3; ++i) out[i] = glm::vec3(at(t, piece.corners[i]));
    if (surface_.transform.mirrors()) std::swap(out[1], out[2]);
    return out;
  }
  glm::dvec3 cross(const glm::uvec3& t) const {
    return glm::cross(positions_[t.y] - positions_[t.x], positions_[t.z] - positions_[t.x]);
  }
  glm::dvec3 at(const glm::uvec3& t, const glm::dvec2& w) const {
    return (1.0 - w.x - w.y) * positions_[t.x] + w.x * positions_[t.y] + w.y * positions_[t.z];
  }
  int longestEdge(const glm::uvec3& t, const Piece& piece) const {
    int longest = 0;
    double length = -1.0;
    for (int i = 0; i < 3; ++i) {
      const double own = glm::distance(at(t, piece.corners[i]), at(t, piece.corners[(i + 1) % 3]));
      if (own > length * (1.0 + 1e-9)) {
        longest = i;
        length = own;
      }
    }
    return longest;
  }

  const Surface& surface_;
  std::size_t number_;  ///< of the scene's surfaces, in the order of names
  bool varies_;
  glm::dvec3 albedo_;  ///< times alpha, where that is the same all over
  std::unique_ptr<CoarseTexture> texture_;
  std::vector<glm::dvec3> positions_;
};

/// One for which another one may stand.
struct SmallTriangle {
  const Triangles* of = nullptr;
  std::uint32_t index = 0;  ///< in Triangles::all
  std::uint32_t patch = 0;  ///< that stands for it
};

/// As how far apart small triangles count whose normals differ by 1, in sizes of a patch, and how many pools there are
/// for as much of their area as a patch may have: tests/bench/NOTES.md has others.
constexpr double kTurned = 3.0, kPoolsOfPatch = 2.0;

/// Large triangles in pieces, which tile a flat wall evenly; small ones in pools, of each the one next to its middle
/// for all.
class Patches {
 public:
  explicit Patches(double most) : most_(most) {}

  /// Of one side; nothing of triangles to which no light comes.
  void add(const Triangles& triangles, const LitSpace& space) {
    for (std::uint32_t i = 0; i < triangles.all().size(); ++i) {
      const glm::uvec3& t = triangles.all()[i];
      const double area = triangles.area(t);
      if (!(area > 0.0) || triangles.litSides(t, space) == 0) continue;
      if (area > 0.5 * most_)
        triangles.split(t, most_, patches_);
      else
        small_.push_back({&triangles, i, 0});
    }
  }
  /// What there is of small triangles since the last time gets patches.
  void flush() {
    const std::span<SmallTriangle> fresh = std::span(small_).subspan(pooled_);
    std::vector<Patch> own;
    std::vector<PooledTriangle> triangles;
    double area = 0.0;
    for (const SmallTriangle& t : fresh) {
      const glm::uvec3& corners = t.of->all()[t.index];
      const Patch& patch = own.emplace_back(t.of->patch(corners));
      triangles.push_back({patch.position, patch.normal, double(patch.area)});
      area += double(patch.area);
    }
    const auto count = std::max(std::size_t(1), std::size_t(std::llround(kPoolsOfPatch * area / most_)));
    const TrianglePools pools = poolsOf(triangles, count, kTurned * std::sqrt(most_));
    const std::size_t before = patches_.size();
    for (const std::uint32_t i : pools.central) patches_.push_back(own[i]);
    takeMeans(std::span(patches_).subspan(before), own, pools.poolOf);
    for (std::size_t i = 0; i < fresh.size(); ++i) fresh[i].patch = std::uint32_t(before) + pools.poolOf[i];
    std::ranges::stable_sort(fresh, {}, &SmallTriangle::patch);
    pooled_ = small_.size();
  }
  std::vector<Patch>& all() { return patches_; }
  const std::vector<SmallTriangle>& small() const { return small_; }

 private:
  /// Each pool has the area and the mean albedo of its triangles.
  static void takeMeans(std::span<Patch> pools, const std::vector<Patch>& triangles,
                        const std::vector<std::uint32_t>& poolOf) {
    std::vector<double> areas(pools.size(), 0.0);
    std::vector<glm::dvec3> reflecting(pools.size(), glm::dvec3(0.0));
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      areas[poolOf[i]] += double(triangles[i].area);
      reflecting[poolOf[i]] += double(triangles[i].area) * glm::dvec3(triangles[i].albedo);
    }
    for (std::size_t i = 0; i < pools.size(); ++i) {
      pools[i].area = float(areas[i]);
      pools[i].albedo = glm::vec3(reflecting[i] / areas[i]);
    }
  }

  double most_;
  std::vector<Patch> patches_;
  std::vector<SmallTriangle> small_;
  std::size_t pooled_ = 0;  ///< of them
};

constexpr double kMostPiecesOfTriangle = 127.0;  // halving makes up to twice as many of it, which kPieceBits can tell

/// The pieces of small triangles: one that is larger than a piece is cut; others share one with those of their patch
/// that face about the same way and are nearest.
class SmallPieces {
 public:
  /// `coarser`: those of `sizes` are so many steps larger.
  SmallPieces(double most, const PieceSizes& sizes, int coarser) : most_(most), sizes_(sizes), coarser_(coarser) {}

  /// Of one surface, which one patch stands for.
  void add(std::span<const SmallTriangle> together) {
    const Triangles& of = *together.front().of;
    ranges_[&of].resize(of.all().size());
    std::map<int, std::vector<Member>> byDirection;
    for (const SmallTriangle& t : together) {
      const glm::uvec3& corners = of.all()[t.index];
      const double area = of.area(corners);
      const double most = std::min(most_, sizes_.most(of.number(), t.index, coarser_));
      if (area > most) {
        const std::size_t first = pieces_.size();
        of.split(corners, std::max(most, area / kMostPiecesOfTriangle), pieces_);
        for (std::size_t i = first; i < pieces_.size(); ++i) pieces_[i].triangle.reset();
        ranges_[&of][t.index] = {std::uint32_t(first), std::uint32_t(pieces_.size() - first)};
        continue;
      }
      const Patch patch = of.patch(corners);
      byDirection[directionOf(patch.normal)].push_back({patch, t.index, most});
    }
    for (auto& [direction, members] : byDirection) addMembers(of, members);
    patchOf_.resize(pieces_.size(), together.front().patch);
  }

  const std::vector<Patch>& all() const { return pieces_; }
  const std::vector<std::uint32_t>& patchOf() const { return patchOf_; }
  const std::map<const Triangles*, std::vector<Folds::Range>>& ranges() const { return ranges_; }

 private:
  struct Member {
    Patch patch;
    std::uint32_t index = 0;  ///< in Triangles::all
    double most = 0.0;  ///< m^2, of a piece with it
  };

  /// Which of some fifty, 25 degrees or so apart.
  static int directionOf(const glm::vec3& n) {
    const glm::ivec3 steps(glm::round(2.0F * n));
    return 25 * steps.x + 5 * steps.y + steps.z;
  }

  /// Halved along the way that they stretch most until they are no more than a piece, which is the one in the middle.
  void addMembers(const Triangles& of, std::span<Member> members) {
    if (members.empty()) return;
    glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
    double area = 0.0, most = most_;
    for (const Member& m : members) {
      most = std::min(most, m.most);
      low = glm::min(low, m.patch.position);
      high = glm::max(high, m.patch.position);
      area += double(m.patch.area);
    }
    const glm::vec3 size = high - low, middle = 0.5F * (low + high);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    if (area > most && members.size() > 1) {
      std::stable_sort(members.begin(), members.end(), [axis](const Member& a, const Member& b) {
        return a.patch.position[axis] < b.patch.position[axis];
      });
      addMembers(of, members.first(members.size() / 2));
      addMembers(of, members.subspan(members.size() / 2));
      return;
    }
    const auto central = std::min_element(members.begin(), members.end(), [&middle](const Member& a, const Member& b) {
      return glm::distance(a.patch.position, middle) < glm::distance(b.patch.position, middle);
    });
    pieces_.push_back(central->patch);
    pieces_.back().area = float(area);
    for (const Member& m : members) ranges_[&of][m.index] = {std::uint32_t(pieces_.size()) - 1, 1};
  }

  double most_;
  const PieceSizes& sizes_;
  int coarser_;
  std::vector<Patch> pieces_;
  std::vector<std::uint32_t> patchOf_;
  std::map<const Triangles*, std::vector<Folds::Range>> ranges_;  ///< by Triangles::all
};

Patch turned(Patch p) {
  p.normal = -p.normal;
  if (p.triangle) std::swap((*p.triangle)[1], (*p.triangle)[2]);
  return p;
}

constexpr float kFoldReach = 3.0F;  // of folds, in sizes of the patch that stands for them: beyond it is nearly a point
constexpr double kMostNearLights = 3.0;  // times as many pieces as are wanted,
constexpr int kMostCoarser = 8;  // if so many steps leave no more
constexpr double kPieces = 1.4;  // halving leaves pieces of half to all of what is allowed

/// Whether a ray ends at whatever of the surface it meets, so that what it sees there is all that it sees.
bool stopsRays(const Surface& surface) { return canStop(surface) && coverageOf(surface).isOpaque(); }

/// Surfaces of one kind, with so many sides: their patches, front and back, and the small triangles among them.
struct Sides {
  int sides = 1;
  std::deque<Triangles> surfaces;  // where they are they stay
  std::vector<SmallTriangle> small;  ///< of folded patches
  std::map<std::uint32_t, std::uint32_t> backs;  ///< by folded patch of the front
};

/// Appends the patches of surfaces to which light may come; of small triangles those are folded that stand for what
/// stops rays alone.
void addPatches(const LitSpace& space, bool apart, double most, Sides& of, std::vector<Patch>& out) {
  Patches patches(most);
  for (const Triangles& surface : of.surfaces) {
    patches.add(surface, space);
    if (apart) patches.flush();
  }
  patches.flush();
  for (const SmallTriangle& t : patches.small()) {
    Patch& patch = patches.all()[t.patch];
    const float size = std::sqrt(patch.area);
    patch.reach =
        std::max({patch.reach, kFoldReach * size, size + t.of->farthest(t.of->all()[t.index], patch.position)});
  }
  for (const SmallTriangle& t : patches.small()) {
    if (!stopsRays(t.of->surface())) patches.all()[t.patch].reach = 0.0F;
  }
  const auto isLit = [&](const Patch& p) { return !p.triangle || !isBehind(space, p.position, p.normal); };
  std::vector<std::uint32_t> fronts;
  for (const Patch& p : patches.all()) {
    fronts.push_back(std::uint32_t(out.size()));
    if (isLit(p)) out.push_back(p);
  }
  for (const SmallTriangle& t : patches.small()) {
    if (patches.all()[t.patch].reach > 0.0F) of.small.push_back({t.of, t.index, fronts[t.patch]});
  }
  for (std::size_t i = 0; of.sides == 2 && i < fronts.size(); ++i) {
    const Patch back = turned(patches.all()[i]);
    if (back.reach > 0.0F) of.backs[fronts[i]] = std::uint32_t(out.size());
    if (isLit(back)) out.push_back(back);
  }
}

void addPieces(const Sides& of, SmallPieces pieces, Folds& out) {
  for (std::size_t first = 0, end = 0; first < of.small.size(); first = end) {
    const auto isOther = [&](const SmallTriangle& t) {
      return t.of != of.small[first].of || t.patch != of.small[first].patch;
    };
    while (end < of.small.size() && !isOther(of.small[end])) ++end;
    pieces.add(std::span(of.small).subspan(first, end - first));
  }
  const auto before = std::uint32_t(out.pieces.size()), count = std::uint32_t(pieces.all().size());
  out.pieces.insert(out.pieces.end(), pieces.all().begin(), pieces.all().end());
  out.patchOf.insert(out.patchOf.end(), pieces.patchOf().begin(), pieces.patchOf().end());
  for (std::uint32_t i = 0; of.sides == 2 && i < count; ++i) {
    out.pieces.push_back(turned(pieces.all()[i]));
    out.patchOf.push_back(of.backs.at(pieces.patchOf()[i]));
  }
  for (const auto& [triangles, ranges] : pieces.ranges()) {
    Folds::OfSurface& surface = out.surfaces[triangles->number()];
    surface.toBack = of.sides == 2 ? count : 0;
    for (const std::uint32_t i : triangles->indices()) {
      const Folds::Range range = i < ranges.size() ? ranges[i] : Folds::Range();
      surface.triangles.push_back({before + range.first, range.count});
    }
  }
}

double areaOfSmall(const Sides& of) {
  double sum = 0.0;
  for (const SmallTriangle& t : of.small) sum += of.sides * t.of->area(t.of->all()[t.index]);
  return sum;
}

constexpr double kHighestAlbedo = 0.98;  ///< that bounces are counted for

double highestAlbedo(const Scene& scene) {
  double highest = 0.0;
  for (const auto& [name, surface] : scene.surfaces) highest = std::max(highest, highestAlbedo(*surface));
  return highest;
}

/// Of the light, under way when bounces end.
double mayBeLeft(const LightingSettings& options) {
  return (options.maxError > 0.0 ? options.maxError : kWantedError) / 3.0;
}

}  // namespace

double PieceSizes::most(std::size_t surface, std::size_t triangle, int coarser) const {
  if (surface >= exponents.size() || triangle >= exponents[surface].size())
    return std::numeric_limits<double>::infinity();
  const std::int8_t exponent = exponents[surface][triangle];
  return exponent == kAny ? std::numeric_limits<double>::infinity() : std::exp2(2.0 * (exponent + coarser));
}

LitSpace litSpace(const Scene& scene) {
  LitSpace out;
  Bounds lights;
  bool bounded = false;
  for (const auto& [name, surface] : scene.surfaces)
    out.surfaces.add(surface->mesh->bounds.transformed(surface->transform.worldFromObject()));
  for (const auto& [name, light] : scene.lights) {
    if (!light->enabled) continue;
    if (light->distant) return {out.surfaces};
    lights.add(light->mesh->bounds.transformed(light->transform.worldFromObject()));
    bounded = true;
  }
  for (std::size_t axis = 0; bounded && axis < 3; ++axis) {
    out.open[0][axis] = lights.min[int(axis)] < out.surfaces.min[int(axis)];
    out.open[1][axis] = lights.max[int(axis)] > out.surfaces.max[int(axis)];
  }
  return out;
}

PatchedScene patchedScene(const Scene& scene, std::size_t count, std::size_t pieces, const PieceSizes& sizes) {
  const LitSpace space = litSpace(scene);
  double area = 0.0;
  Sides kinds[2] = {{.sides = 1, .surfaces = {}, .small = {}, .backs = {}},
                    {.sides = 2, .surfaces = {}, .small = {}, .backs = {}}};
  std::size_t number = 0;
  for (const auto& [name, surface] : scene.surfaces) {
    Sides& of = kinds[sidesOf(*surface) - 1];
    const bool reflects = highestAlbedo(*surface) > 0.0;
    area += reflects ? of.surfaces.emplace_back(*surface, number).area(space) : areaOf(*surface);
    ++number;
  }
  const bool apart = 2 * (kinds[0].surfaces.size() + kinds[1].surfaces.size()) <= count;
  PatchedScene out;
  for (Sides& of : kinds) addPatches(space, apart, kPieces * area / double(count), of, out.patches);
  const double folded = areaOfSmall(kinds[0]) + areaOfSmall(kinds[1]);
  if (pieces == 0 || !(folded > 0.0)) return out;
  const double most = kPieces * folded / double(pieces);
  for (int coarser = 0; coarser <= kMostCoarser; ++coarser) {
    out.folds = {};
    out.folds.surfaces.resize(scene.surfaces.size());
    for (const Sides& of : kinds) addPieces(of, SmallPieces(most, sizes, coarser), out.folds);
    if (double(out.folds.pieces.size()) <= kMostNearLights * double(pieces)) break;
  }
  return out;
}

std::vector<Patch> patchesOf(const Scene& scene, std::size_t count) { return patchedScene(scene, count, 0).patches; }

const std::vector<glm::uvec3>& patchedTriangles(const Surface& surface) {
  return albedoVaries(surface) ? surface.mesh->triangles : surface.mesh->evenTriangles();
}

double largestPiece(const Scene& scene, std::size_t pieces) {
  double area = 0.0;
  for (const auto& [name, surface] : scene.surfaces) area += areaOf(*surface);
  return kPieces * area / double(pieces);
}

int bouncesFor(const Scene& scene) {
  const double highest = highestAlbedo(scene);
  if (scene.options.bounces != kAutoBounces || highest <= 0.0) return highest > 0.0 ? scene.options.bounces : 0;
  const double bound = std::log(mayBeLeft(scene.options)) / std::log(std::min(highest, kHighestAlbedo));
  return std::clamp(int(std::ceil(bound)) - 1, 1, kMaxBounces);
}

double BouncePlan::weight(int turn) const {
  double weight = 1.0;
  for (int i = 1; i <= turn; ++i) weight = 1.0 / (1.0 - (i == 1 ? 0.5 : 0.25) * albedo * albedo * weight);
  return weight;
}

BouncePlan bouncePlan(const Scene& scene) {
  const int bounces = bouncesFor(scene);
  if (scene.options.bounces != kAutoBounces || bounces == 0) return {bounces, 0.0};
  const double albedo = std::min(highestAlbedo(scene), kHighestAlbedo);
  // The last turn is the receivers' own, which leaves the albedo's share.
  const double ratio = std::max(1.0, 3.0 * albedo / mayBeLeft(scene.options));
  const double turns = std::ceil(std::acosh(ratio) / std::acosh(1.0 / albedo));
  return {int(std::clamp(turns, 1.0, double(kMaxBounces))), albedo};
}

}  // namespace lpv
