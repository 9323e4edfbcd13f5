#include "scene/patches.h"

#include <algorithm>
#include <cmath>
#include <glm/gtx/component_wise.hpp>
#include <memory>
#include <utility>

#include "scene/coarse_texture.h"
#include "scene/grid_choice.h"
#include "scene/transparency.h"

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

/// A piece of a triangle: places in its plane by the weights of its second and third corner.
struct Piece {
  glm::dvec2 corners[3] = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
  double area = 0.0;

  glm::dvec2 middle() const { return (corners[0] + corners[1] + corners[2]) / 3.0; }
};

/// A surface's triangles, world space.
class Triangles {
 public:
  explicit Triangles(const Surface& surface)
      : surface_(surface),
        varies_(surface.albedoTexture != nullptr && !surface.mesh->uvs.empty()),
        albedo_(alphaVaries(surface) ? surface.albedo : alphaOf(surface, 255) * surface.albedo),
        texture_(varies_ ? std::make_unique<CoarseTexture>(*surface.albedoTexture, alphaFactors(surface)) : nullptr) {
    const glm::dmat4 worldFromObject = surface.transform.worldFromObject();
    for (const glm::vec3& p : surface.mesh->positions)
      positions_.emplace_back(worldFromObject * glm::dvec4(glm::dvec3(p), 1.0));
  }

  const std::vector<glm::uvec3>& all() const {
    return varies_ ? surface_.mesh->triangles : surface_.mesh->evenTriangles();
  }
  double area(const glm::uvec3& t) const { return 0.5 * glm::length(cross(t)); }
  /// Halved along the longest edge until no piece is larger than `most`; appends the pieces' patches.
  void split(const glm::uvec3& t, double most, std::vector<Patch>& out) const {
    std::vector<Piece> open = {Piece{.area = area(t)}};
    while (!open.empty()) {
      const Piece piece = open.back();
      open.pop_back();
      if (piece.area <= most) {
        out.push_back(patch(t, piece.middle(), piece.area));
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
  Patch patch(const glm::uvec3& t, const glm::dvec2& w, double area) const {
    const glm::dvec3 normal = (surface_.transform.mirrors() ? -1.0 : 1.0) * glm::normalize(cross(t));
    glm::vec3 albedo(albedo_);
    if (texture_ != nullptr) {
      const std::vector<glm::vec2>& uv = surface_.mesh->uvs;
      albedo *= texture_->at(glm::mix(glm::dvec2(uv[t.x]), glm::dvec2(uv[t.y]), w.x) +
                             w.y * (glm::dvec2(uv[t.z]) - glm::dvec2(uv[t.x])));
    }
    return {glm::vec3(at(t, w)), float(area), glm::vec3(normal), albedo, std::nullopt};
  }

 private:
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
  bool varies_;
  glm::dvec3 albedo_;  ///< times alpha, where that is the same all over
  std::unique_ptr<CoarseTexture> texture_;
  std::vector<glm::dvec3> positions_;
};

/// Large triangles in pieces, which tile a flat wall evenly; small ones together, one of them for all, until their area
/// is that of a piece.
class Patches {
 public:
  explicit Patches(double most) : most_(most) {}

  /// Of one side.
  void add(const Triangles& triangles) {
    for (const glm::uvec3& t : triangles.all()) {
      const double area = triangles.area(t);
      if (!(area > 0.0)) continue;
      if (area > 0.5 * most_) {
        triangles.split(t, most_, patches_);
        continue;
      }
      if (pending_ < 0.5 * most_) last_ = triangles.patch(t, glm::dvec2(1.0 / 3.0), 0.0);
      pending_ += area;
      if (pending_ >= most_) flush();
    }
  }
  /// What is left of small triangles gets a patch.
  void flush() {
    if (pending_ > 0.0) patches_.push_back(last_);
    if (pending_ > 0.0) patches_.back().area = float(pending_);
    pending_ = 0.0;
  }
  const std::vector<Patch>& all() const { return patches_; }

 private:
  double most_;
  std::vector<Patch> patches_;
  Patch last_;
  double pending_ = 0.0;
};

Patch turned(Patch p) {
  p.normal = -p.normal;
  if (p.triangle) std::swap((*p.triangle)[1], (*p.triangle)[2]);
  return p;
}

}  // namespace

std::vector<Patch> patchesOf(const Scene& scene, std::size_t count) {
  constexpr double kPieces = 1.4;  // halving leaves pieces of half to all of what is allowed
  double area = 0.0;
  std::vector<const Surface*> reflecting;
  for (const auto& [name, surface] : scene.surfaces) {
    area += areaOf(*surface);
    if (highestAlbedo(*surface) > 0.0) reflecting.push_back(surface.get());
  }
  std::vector<Patch> out;
  for (const int sides : {1, 2}) {
    Patches patches(kPieces * area / double(count));
    for (const Surface* surface : reflecting) {
      if (sidesOf(*surface) != sides) continue;
      patches.add(Triangles(*surface));
      if (2 * reflecting.size() <= count) patches.flush();
    }
    patches.flush();
    out.insert(out.end(), patches.all().begin(), patches.all().end());
    for (const Patch& p : patches.all()) {
      if (sides == 2) out.push_back(turned(p));
    }
  }
  return out;
}

int bouncesFor(const Scene& scene) {
  constexpr double kShareOfError = 1.0 / 3.0, kHighestAlbedo = 0.98;
  double highest = 0.0;
  for (const auto& [name, surface] : scene.surfaces) highest = std::max(highest, highestAlbedo(*surface));
  if (scene.options.bounces != kAutoBounces || highest <= 0.0) return highest > 0.0 ? scene.options.bounces : 0;
  const double wanted = scene.options.maxError > 0.0 ? scene.options.maxError : kWantedError;
  const double goal = kShareOfError * wanted;
  return std::clamp(int(std::ceil(std::log(goal) / std::log(std::min(highest, kHighestAlbedo)))) - 1, 1, kMaxBounces);
}

}  // namespace lpv
