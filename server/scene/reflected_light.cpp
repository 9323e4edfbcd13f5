#include "scene/reflected_light.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtx/component_wise.hpp>
#include <limits>

#include "scene/emitter_list.h"
#include "scene/light_around.h"
#include "scene/parted_patches.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

constexpr int kRays = 256;
constexpr int kFoldRays = 256;

/// E of unit radiance with nothing between: a triangle from near, else to second order in the patch's size
/// (shaders/visibility/patches.glsl).
double weightOf(const Patch& patch, const glm::dvec3& at, const glm::dvec3& n) {
  const glm::dvec3 d = glm::dvec3(patch.position) - at;
  const double r2 = glm::dot(d, d), area = double(patch.area);
  if (patch.triangle && r2 < kNearPatch * area) {
    const auto& t = *patch.triangle;
    const glm::dvec3 corners[3] = {glm::dvec3(t[0]) - at, glm::dvec3(t[1]) - at, glm::dvec3(t[2]) - at};
    return ownShare(patch, at, n) * triangleIrradiance(corners, n, 1);
  }
  const double size = kPatchSizeOfArea * area, p = glm::dot(n, d);
  const double q = std::min(glm::dot(glm::dvec3(patch.normal), d), 0.0);
  if (!(p > 0.0) || !(r2 > 0.0)) return 0.0;
  const double across = glm::dot(n, glm::dvec3(patch.normal)) * q + 2.0 * p - 3.0 * p * q * q / r2;
  return area * -q * std::max(p + size / (r2 + size) * across, 0.0) / (r2 * (r2 + size));
}

constexpr int kPlacesOfNear = 8;  // of a near triangle, that are weighed; as in shaders/frame/patch_light.comp
constexpr double kLeastSent = 0.25;  // anywhere, over the mean; as in shaders/visibility/patches.glsl
constexpr double kMostOfPiece = 4.0;  // as in shaders/frame/shadow_rays.comp
constexpr double kFoldedUpTo = 1.7;  // as in shaders/visibility/shadow_points.glsl

/// Of what a patch sends, what its pieces are seen instead: all within its reach, nothing well beyond.
double foldedShare(const Patch& patch, const glm::dvec3& at) {
  if (!(patch.reach > 0.0F)) return 0.0;
  const double from = glm::distance(glm::dvec3(patch.position), at) / double(patch.reach);
  return 1.0 - glm::smoothstep(1.0, kFoldedUpTo, from * from);
}

}  // namespace

void ReflectedLight::findPiecesOfPatches() {
  const Folds& folds = of->folds;
  piecesOf.assign(folds.pieces.empty() ? 0 : of->patches.size(), {});
  sentUpTo.clear();
  for (std::size_t i = 0; i < folds.pieces.size(); ++i) {
    Folds::Range& pieces = piecesOf[folds.patchOf[i]];
    const double before = pieces.count == 0 ? 0.0 : sentUpTo.back(), area = double(folds.pieces[i].area);
    if (pieces.count++ == 0) pieces.first = std::uint32_t(i);
    sentUpTo.push_back(before + area * (pieceRadiance[i].r + pieceRadiance[i].g + pieceRadiance[i].b));
  }
}

glm::dvec3 ReflectedLight::placeOn(std::size_t patch, int k, const glm::dvec3& at, const glm::dvec3& n) const {
  const Patch& p = of->patches[patch];
  const glm::dvec3 middle(p.position);
  if (!p.triangle) return middle;
  const glm::dvec3 d = middle - at;
  const int tries = glm::dot(d, d) < kNearPatch * double(p.area) ? kPlacesOfNear : 1;
  glm::dvec3 chosen = middle;
  double all = 0.0, chance = std::fmod(0.5497004779 * double(patch) + 0.6180339887 * k, 1.0);
  for (int i = 0; i < tries; ++i) {
    const glm::dvec2 u = glm::fract(double(patch) * glm::dvec2(0.8191725134, 0.6710436067) +
                                    double(k * tries + i) * glm::dvec2(0.7548776662, 0.5698402910));
    const glm::dvec3 place = ownPlace(p, u);
    const double weight = tries == 1 ? 1.0 : sentFrom(p, place, at, n);
    all += weight;
    const bool takes = weight > 0.0 && chance * all < weight;
    chance = takes ? chance * all / weight : (chance * all - weight) / std::max(all - weight, 1e-300);
    if (takes) chosen = place;
  }
  return chosen;
}

double ReflectedLight::sentAt(std::size_t patch, const glm::dvec3& place) const {
  if (slopes.empty()) return 1.0;
  return std::clamp(1.0 + glm::dot(slopes[patch], place - glm::dvec3(of->patches[patch].position)), kLeastSent,
                    2.0 - kLeastSent);
}

std::optional<std::size_t> ReflectedLight::pieceOf(std::size_t patch, double u) const {
  const Folds::Range pieces = piecesOf.empty() ? Folds::Range() : piecesOf[patch];
  if (pieces.count == 0) return std::nullopt;
  const auto first = sentUpTo.begin() + pieces.first, last = first + pieces.count - 1;
  return std::size_t(std::upper_bound(first, last, u * *last) - sentUpTo.begin());
}

std::optional<glm::dvec3> ReflectedLight::pieceAt(const LightVisibility::Sight& sight, const glm::dvec3& at) const {
  const Folds& folds = of->folds;
  if (sight.hit.surface < 0) return std::nullopt;
  const Folds::OfSurface& surface = folds.surfaces[std::size_t(sight.hit.surface)];
  if (surface.triangles.empty() || (!sight.hit.front && surface.toBack == 0)) return std::nullopt;
  const Folds::Range range = surface.triangles[sight.hit.triangle];
  if (range.count == 0) return std::nullopt;
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = range.first; i < range.first + range.count; ++i) {
    const double distance = glm::distance(glm::dvec3(folds.pieces[i].position), sight.hit.position);
    if (distance < least) nearest = i;
    least = std::min(least, distance);
  }
  if (!sight.hit.front) nearest += surface.toBack;
  const double share = foldedShare(of->patches[folds.patchOf[nearest]], at);
  return share > 0.0 ? std::optional(share * pieceRadiance[nearest]) : std::nullopt;
}

/// Of the pieces whose patches are near: rays all around see the nearest of what they meet.
glm::dvec3 ReflectedLight::fromPieces(const glm::dvec3& at, const glm::dvec3& n,
                                      const LightVisibility& visibility) const {
  glm::dvec3 sum(0.0);
  for (int k = 0; k < kFoldRays; ++k) {
    const auto sight = visibility.sight(at, n, directionAbout(n, k, kFoldRays));
    const auto piece = sight ? pieceAt(*sight, at) : std::nullopt;
    if (piece) sum += sight->share * *piece;
  }
  return glm::pi<double>() / kFoldRays * sum;
}

glm::dvec3 ReflectedLight::irradiance(const glm::dvec3& at, const glm::dvec3& n,
                                      const LightVisibility* visibility) const {
  const std::vector<Patch>& patches = of->patches;
  std::vector<glm::dvec3> sent(patches.size());
  glm::dvec3 sum(0.0), near(0.0);
  double all = 0.0;
  bool folded = false;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const bool looks = visibility != nullptr && !of->folds.pieces.empty();
    const double share = looks ? foldedShare(patches[i], at) : 0.0;
    folded = folded || share > 0.0;
    if (share == 1.0) continue;
    sent[i] = (1.0 - share) * weightOf(patches[i], at, n) * radiance[i];
    sum += sent[i];
    all += glm::compMax(sent[i]);
  }
  if (folded) near = fromPieces(at, n, *visibility);
  if (visibility == nullptr || !(all > 0.0)) return sum + near;
  glm::dvec3 tried(0.0), seen(0.0);
  double before = 0.0;
  int next = 0;
  for (std::size_t i = 0; i < patches.size() && next < kRays; ++i) {
    const double size = glm::compMax(sent[i]);
    before += size;
    const int first = next;
    for (; next < kRays && (next + 0.5) / kRays * all < before; ++next) {
    }
    const int rays = next - first;
    if (rays == 0) continue;
    const glm::dvec3 colour = double(rays) / size * sent[i];
    tried += colour;
    if (piecesOf.empty() || piecesOf[i].count == 0) {
      for (int k = 0; k < rays; ++k) {
        const glm::dvec3 place = placeOn(i, k, at, n);
        seen += sentAt(i, place) / rays * colour * visibility->seen(at, n, place);
      }
      continue;
    }
    const double whole = weightOf(patches[i], at, n);
    for (int k = 0; k < rays; ++k) {
      const Patch& piece = of->folds.pieces[*pieceOf(i, std::fmod(0.6180339887 * (first + k) + 0.5, 1.0))];
      const double worth =
          std::min(weightOf(piece, at, n) / double(piece.area) * double(patches[i].area) / whole, kMostOfPiece);
      if (worth > 0.0) seen += worth / rays * colour * visibility->seen(at, n, glm::dvec3(piece.position));
    }
  }
  for (int c = 0; c < 3; ++c) sum[c] *= tried[c] > 0.0 && seen[c] != tried[c] ? seen[c] / tried[c] : 1.0;
  return sum + near;
}

LightAround ReflectedLight::around(const glm::dvec3& at, const LightVisibility* visibility) const {
  constexpr int kAround = 4 * kFoldRays;
  const glm::dvec3 onNoSurface(0.0);
  LightAround out;
  bool folded = false;
  for (std::size_t i = 0; i < of->patches.size(); ++i) {
    const Patch& patch = of->patches[i];
    const glm::dvec3 place(patch.position);
    if (!(glm::dot(glm::dvec3(patch.normal), at - place) > 0.0) || radiance[i] == glm::dvec3(0.0)) continue;
    const double inPieces = visibility != nullptr && !of->folds.pieces.empty() ? foldedShare(patch, at) : 0.0;
    folded = folded || inPieces > 0.0;
    if (inPieces == 1.0) continue;
    const glm::dvec3 share = visibility == nullptr ? glm::dvec3(1.0) : visibility->seen(at, onNoSurface, place);
    if (share != glm::dvec3(0.0)) out.addPatch(patch, at, (1.0 - inPieces) * share * radiance[i]);
  }
  for (int k = 0; folded && k < kAround; ++k) {
    const glm::dvec3 direction = directionAround(k, kAround);
    const auto sight = visibility->sight(at, onNoSurface, direction);
    const auto piece = sight ? pieceAt(*sight, at) : std::nullopt;
    if (piece) out.addFrom(direction, 4.0 * glm::pi<double>() / kAround * sight->share * *piece);
  }
  return out;
}

}  // namespace lpv
