#include "scene/parted_patches.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "scene/light_around.h"
#include "scene/occluders.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

static_assert(kAllPlaces == (1U << layout::kPatchPlaces) - 1U);

constexpr int kLeastPlaces = 2;  // of a side
constexpr double kDetours[] = {0.5, 1.0, 2.0};  // of a patch's width, how high one may lead
constexpr double kLeastNearness = 0.01;  // as in shaders/visibility/patches.glsl
constexpr int kRaysOfSide = 64, kOpenRays = 4;  // of a side, and more than so many must get a patch's width away

glm::dvec3 placeOn(const Patch& patch, glm::dvec2 u) {
  if (u.x + u.y > 1.0) u = 1.0 - u;
  const glm::dvec3 first((*patch.triangle)[0]);
  return first + u.x * (glm::dvec3((*patch.triangle)[1]) - first) + u.y * (glm::dvec3((*patch.triangle)[2]) - first);
}

/// A triangle's places, as high above it as its rays begin, and which of them can be reached from which.
class Places {
 public:
  Places(const Patch& patch, double offset, const Occluders& occluders)
      : occluders_(occluders), width_(std::sqrt(double(patch.area))), normal_(patch.normal) {
    for (int k = 0; k < layout::kPatchPlaces; ++k)
      at_[std::size_t(k)] = placeOfTriangle(patch, k) + offset * glm::dvec3(patch.normal);
  }
  /// Along the surface, or over what stands on it.
  bool reaches(int from, int to) const {
    const glm::dvec3 a = at_[std::size_t(from)], b = at_[std::size_t(to)];
    return open(a, b) || std::ranges::any_of(kDetours, [&](double height) {
             const glm::dvec3 up = height * width_ * normal_;
             return open(a, a + up) && open(a + up, b + up) && open(b + up, b);
           });
  }
  /// Whether rays from these places get a patch's width away. Those from below a chair's leg do not.
  bool seeFurther(std::uint32_t places) const {
    int further = 0;
    std::uint32_t left = places;
    for (int k = 0; k < kRaysOfSide; ++k) {  // from each in turn, so that each has rays of all heights
      const glm::dvec3 a = at_[std::size_t(std::countr_zero(left))];
      further += int(open(a, a + width_ * directionAbout(normal_, k, kRaysOfSide)));
      left &= left - 1U;
      if (left == 0U) left = places;
    }
    return further > kOpenRays;
  }

 private:
  bool open(const glm::dvec3& a, const glm::dvec3& b) const {
    return occluders_.transmitted(a, b, kAllLights) == glm::dvec3(1.0);
  }

  const Occluders& occluders_;
  double width_;
  glm::dvec3 normal_;
  std::array<glm::dvec3, layout::kPatchPlaces> at_;
};

/// Those of `others` that can be reached from the first of them, and that one.
std::uint32_t sideOfFirst(std::uint32_t others, const Places& places) {
  std::uint32_t side = others & (~others + 1U);
  for (std::uint32_t next = side; next != 0U; next &= next - 1U) {
    for (std::uint32_t left = others & ~side; left != 0U; left &= left - 1U) {
      const std::uint32_t bit = left & (~left + 1U);
      if (!places.reaches(std::countr_zero(next), std::countr_zero(left))) continue;
      side |= bit;
      next |= bit;
    }
  }
  return side;
}

/// The largest first; none or one of a triangle that is not parted.
std::vector<std::uint32_t> sidesOf(const Patch& patch, double offset, const Occluders& occluders) {
  const Places places(patch, offset, occluders);
  std::vector<std::uint32_t> out;
  for (std::uint32_t left = kAllPlaces; left != 0U;) {
    const std::uint32_t side = sideOfFirst(left, places);
    if (side == kAllPlaces) break;
    left &= ~side;
    if (std::popcount(side) >= kLeastPlaces && places.seeFurther(side)) out.push_back(side);
  }
  std::ranges::stable_sort(out, [](std::uint32_t a, std::uint32_t b) { return std::popcount(a) > std::popcount(b); });
  return out;
}

Patch sideOf(const Patch& patch, std::uint32_t places) {
  Patch out = patch;
  out.places = places;
  out.area = float(patch.area * ownShare(out));
  glm::dvec3 sum(0.0);
  for (std::uint32_t left = places; left != 0U; left &= left - 1U)
    sum += placeOfTriangle(patch, std::countr_zero(left));
  out.position = glm::vec3(sum / double(std::popcount(places)));
  return out;
}

}  // namespace

glm::dvec3 placeOfTriangle(const Patch& patch, int k) {
  return placeOn(patch, glm::fract(0.5 + double(k + 1) * glm::dvec2(0.7548776662, 0.5698402910)));
}

glm::dvec3 ownPlace(const Patch& patch, glm::dvec2 u) {
  if (patch.places == kAllPlaces) return placeOn(patch, u);
  int left = int(u.x * std::popcount(patch.places));
  std::uint32_t from = patch.places;
  for (; left > 0; --left) from &= from - 1U;
  return placeOfTriangle(patch, std::countr_zero(from));
}

double ownShare(const Patch& patch) { return double(std::popcount(patch.places)) / layout::kPatchPlaces; }

double sentFrom(const Patch& patch, const glm::dvec3& place, const glm::dvec3& at, const glm::dvec3& n) {
  const glm::dvec3 d = place - at;
  const double r2 = glm::dot(d, d) + kLeastNearness * double(patch.area);
  return std::max(glm::dot(d, n), 0.0) * std::max(-glm::dot(d, glm::dvec3(patch.normal)), 0.0) / (r2 * r2);
}

double ownShare(const Patch& patch, const glm::dvec3& at, const glm::dvec3& n) {
  if (patch.places == kAllPlaces) return 1.0;
  double own = 0.0, all = 0.0;
  for (int k = 0; k < layout::kPatchPlaces; ++k) {
    const double sent = sentFrom(patch, placeOfTriangle(patch, k), at, n);
    if ((patch.places >> k & 1U) == 1U) own += sent;
    all += sent;
  }
  return all > 0.0 ? own / all : 0.0;
}

PatchedScene parted(const PatchedScene& patched, const Scene& scene) {
  const Occluders occluders(scene);
  const double offset = double(layout::kShadowOffset) * scene.grid.cell;
  PatchedScene out = patched;
  const std::size_t most = patched.patches.size() + patched.patches.size() / 4;
  for (std::size_t i = 0; i < patched.patches.size(); ++i) {
    const Patch& patch = patched.patches[i];
    if (!patch.triangle) continue;
    const std::vector<std::uint32_t> sides = sidesOf(patch, offset, occluders);
    if (sides.size() < 2) continue;
    out.patches[i] = sideOf(patch, sides[0]);
    for (std::size_t k = 1; k < sides.size() && out.patches.size() < most; ++k)
      out.patches.push_back(sideOf(patch, sides[k]));
  }
  return out;
}

}  // namespace lpv
