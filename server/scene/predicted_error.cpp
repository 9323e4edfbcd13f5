#include "scene/predicted_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "scene/emitter_list.h"
#include "scene/error_goal.h"
#include "scene/lookup.h"
#include "scene/small_lights.h"

namespace lpv {

namespace {

/// Tests of rays against triangles of surfaces.
constexpr std::size_t kMostCrossingTests = 2'000'000;

/// Triangles of a light that are read before it is thinned.
constexpr std::size_t kMostRead = 20'000;

/// Share of the irradiance by which light from VPLs is wrong where a receiver touches the light, which has a texture
/// then (others are seen as they are, scene/emitter_tree.h): the distance to a VPL is taken for half a cell at least,
/// and its cell for flat.
constexpr double kTouching = 0.65;
/// The same away from it, up to kNearFieldEnd cells.
constexpr double kNear = 0.03;

/// What a VPL's one position for all colours of a texture makes of its light, by opening ratio: a television in a room
/// (tests/evaluation/UNSHADOWED.md).
double ofTextures(double openingRatio) { return openingRatio < kAccurateOpeningRatio ? 0.015 : 0.004; }

/// What automatic groups of three lights and more come to, as a share of what they may: seen .2 to 1.
constexpr double kOfGroups = 0.6;

AreaLights thinnedLights(const AreaLights& all, std::uint32_t seed) {
  Random random(seed);
  return all.triangles() > kThinned ? all.thinned(kThinned, random) : all;
}

bool hasCentresAround(const Grid& grid, const glm::dvec3& g) {
  return glm::all(glm::greaterThanEqual(g, glm::dvec3(0.5))) &&
         glm::all(glm::lessThanEqual(g, glm::dvec3(grid.dims) - 0.5));
}

double smooth(double cells) {
  const double t = std::clamp((cells - kNearFieldBegin) / (kNearFieldEnd - kNearFieldBegin), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

struct WeightedCentre {
  glm::dvec3 at{0.0};
  double weight = 0.0;
};

/// The centres of the eight cells around a point that has them, and their weights.
std::array<WeightedCentre, 8> centresAround(const Grid& grid, const glm::dvec3& at) {
  const glm::dvec3 centred = grid.gridFromWorld(at) - 0.5;
  const glm::ivec3 low = glm::clamp(glm::ivec3(glm::floor(centred)), glm::ivec3(0), glm::max(grid.dims - 2, 0));
  const glm::dvec3 f = centred - glm::dvec3(low);
  std::array<WeightedCentre, 8> out;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 offset(corner & 1, (corner >> 1) & 1, corner >> 2);
    const glm::dvec3 axis = glm::mix(1.0 - f, f, glm::dvec3(offset));
    out[std::size_t(corner)] = {grid.cellCentre(low + offset), axis.x * axis.y * axis.z};
  }
  return out;
}

sh::Coefficients incident(const Arriving& light) {
  return sh::fromBands(sh::kY0 * light.fluence, sh::kY1 * light.vectorIrradiance);
}

double lookedUp(Lookup lookup, const sh::Coefficients& c, const glm::dvec3& n) {
  return lookup == Lookup::kCap ? irradianceCap(c, n) : irradianceSh2(c, n);
}

/// What looking at lights through their trees is off by; nothing where all are polygons.
double errorOfTrees(std::span<const LightSize> lights, LightingSettings options) {
  options.transport = Transport::kDirect;
  const bool trees =
      std::ranges::any_of(lights, [](const LightSize& l) { return l.triangles > kFewPolygons || !l.constant; });
  return trees ? expectedError(options, kDefaultCellsOfLongestEdge) : 0.0;
}

double squared(const glm::dvec3& v) { return glm::dot(v, v); }

}  // namespace

ErrorPredictor::ErrorPredictor(const Scene& scene, const LightingSettings& options, std::uint32_t seed)
    : scene_(scene), options_(options), seed_(seed), all_(scene, kMostRead), lights_(thinnedLights(all_, seed)) {
  std::map<std::string, std::size_t> byName;
  for (std::size_t i = 0; i < lights_.lights(); ++i) grouped_ = grouped_ || !lights_.group(i).empty();
  for (std::size_t i = 0; i < lights_.lights(); ++i) {
    const std::string name = grouped_ ? lights_.group(i) : std::to_string(i);
    groupOf_.push_back(byName.try_emplace(name, byName.size()).first->second);
  }
  groups_ = byName.size();
  for (const auto& [name, light] : scene.lights) {
    if (light->enabled && emittedRadiance(*light) != glm::dvec3(0.0))
      textured_.push_back(light->texture != nullptr ? 1.0 : 0.0);
  }
  if (!scene.surfaces.empty()) onSurfaces_ = sampled(LitSides(scene));
}

std::vector<ErrorPredictor::Point> ErrorPredictor::sampled(const LitSides& sides) const {
  std::vector<Point> out;
  if (!(lights_.power() > 0.0) || !(sides.area() > 0.0)) return out;
  const std::size_t wanted = std::min(kPredictedReceivers, kMostPredicted / lights_.triangles());
  if (wanted < kLeastPredictedReceivers) return out;
  Random random(seed_);
  LitPoints lit = litPoints(sides, lights_, kMostCrossingTests, random);
  std::shuffle(lit.at.begin(), lit.at.end(), random);
  lit.at.resize(std::min(lit.at.size(), wanted / 2));
  const std::size_t everywhere = wanted - lit.at.size();
  const double perArea = double(everywhere) / sides.area();
  const double perIrradiance = lit.at.empty() ? 0.0 : double(lit.at.size()) / lit.received;
  for (std::size_t i = 0; i < wanted; ++i) {
    const Receiver at = i < everywhere ? sides.sample(random) : lit.at[i - everywhere];
    const glm::dvec3 truth = lights_.irradiance(at);
    const double weight = 1.0 / (perArea + perIrradiance * (truth.x + truth.y + truth.z) / 3.0);
    out.push_back({at, truth, weight, all_.distancesToTrees(at.position)});
  }
  return out;
}

/// EmitterList::farFromEmitters: distances are known at the centres of cells, and lie between them elsewhere.
double ErrorPredictor::farFromLights(const Grid& grid, const glm::dvec3& at) const {
  constexpr double kReach = kNearFieldEnd + 1.0;  // centres are up to .9 cells away
  if (lights_.distance(at, kReach * grid.cell) >= kReach * grid.cell) return 1.0;
  double distance = 0.0;
  for (const auto& [centre, weight] : centresAround(grid, at))
    distance += weight * lights_.distance(centre, 2.0 * kReach * grid.cell);
  return smooth(distance / grid.cell);
}

/// Share of the point's irradiance by which it is wrong for VPLs that it nearly touches.
double ErrorPredictor::touching(const Grid& grid, const Point& point) const {
  double share = 0.0;
  for (std::size_t i = 0; i < point.toTrees.size(); ++i) {
    const double cells = point.toTrees[i] / (grid.cell * voxelEdge(lights_.across(i) / grid.cell));
    const double touching = std::max(0.0, 1.0 - cells), near = std::max(0.0, 1.0 - cells / kNearFieldEnd);
    share = std::max({share, kTouching * touching * touching, kNear * near});
  }
  return share;
}

ErrorPredictor::LookedUp ErrorPredictor::lookUp(const Grid& grid, const Receiver& at,
                                                std::span<const double> shares) const {
  std::vector<Arriving> moments(lights_.lights());
  if (options_.lookup == Lookup::kNearest) {
    const glm::ivec3 cell(glm::floor(grid.gridFromWorld(at.position)));
    lights_.addMoments(grid.cellCentre(glm::clamp(cell, glm::ivec3(0), grid.dims - 1)), 1.0, moments);
  } else {
    for (const auto& [centre, weight] : centresAround(grid, at.position)) {
      if (weight != 0.0) lights_.addMoments(centre, weight, moments);
    }
  }
  LookedUp out;
  std::vector<glm::dmat3x4> groups(groups_, glm::dmat3x4(0.0));
  glm::dmat3x4 all(0.0);  // a column of coefficients per colour
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const glm::dmat3x4 light = glm::outerProduct((1.0 - shares[i]) * incident(moments[i]), lights_.radiance(i));
    groups[groupOf_[i]] += light;
    all += light;
  }
  for (int colour = 0; colour < 3; ++colour) {
    for (const glm::dmat3x4& group : groups) out.apart[colour] += lookedUp(options_.lookup, group[colour], at.normal);
    out.together[colour] = lookedUp(options_.lookup, all[colour], at.normal);
  }
  return out;
}

std::vector<ErrorPredictor::Point> ErrorPredictor::pointsFor(const Grid& grid) const {
  return scene_.surfaces.empty() ? sampled(LitSides(scene_, grid)) : onSurfaces_;
}

double ErrorPredictor::ofTouching(const Grid& grid) const {
  double whole = 0.0, apart = 0.0;
  for (const Point& point : pointsFor(grid)) {
    const double share = touching(grid, point);
    whole += point.weight * squared(point.truth);
    apart += point.weight * share * share * squared(point.truth);
  }
  return whole > 0.0 ? std::sqrt(apart / whole) : 0.0;
}

std::optional<double> ErrorPredictor::with(const Grid& grid) const {
  const bool gathers = options_.transport == Transport::kGather;
  const std::vector<LightSize> sizes = lightSizes(scene_, grid);
  const double ofTrees = errorOfTrees(sizes, options_);
  std::vector<double> shares(lights_.lights(), 0.0);
  if (gathers) shares = lookedAtShares(sizes);
  const bool someLookedAt = std::ranges::any_of(shares, [](double share) { return share > 0.0; });
  const bool anyTexture = std::ranges::any_of(textured_, [](double share) { return share > 0.0; });
  double whole = 0.0, apart = 0.0, together = 0.0, byVolume = 0.0, ofTextured = 0.0;
  for (const Point& point : pointsFor(grid)) {
    whole += point.weight * squared(point.truth);
    const double touched = touching(grid, point);
    apart += point.weight * touched * touched * squared(point.truth);
    const bool between = hasCentresAround(grid, grid.gridFromWorld(point.at.position));
    const double far = between ? farFromLights(grid, point.at.position) : 0.0;
    apart += point.weight * (1.0 - far) * (1.0 - far) * ofTrees * ofTrees * squared(point.truth);
    if (anyTexture) ofTextured += point.weight * squared(lights_.irradiance(point.at, textured_));
    if (far == 0.0) continue;
    const LookedUp got = lookUp(grid, point.at, shares);
    const glm::dvec3 truth = someLookedAt ? point.truth - lights_.irradiance(point.at, shares) : point.truth;
    apart += point.weight * far * far * squared(got.apart - truth);
    together += point.weight * far * far * squared(got.together - got.apart);
    byVolume += point.weight * far * far * squared(truth);
  }
  if (!(whole > 0.0)) return std::nullopt;
  if (gathers && areLookedAtEverywhere(shares)) return ofTrees;
  const double merging = mergingError(options_.openingRatio()), textures = ofTextures(options_.openingRatio());
  const double allowed = groupingGoal(options_, std::max({grid.dims.x, grid.dims.y, grid.dims.z}));
  const bool apartWhereTooMuch = grouped_ || (groups_ == 2 && together > allowed * allowed * whole);
  const double grouping =
      apartWhereTooMuch ? 0.0 : std::min(together / whole, kOfGroups * allowed * kOfGroups * allowed);
  return std::sqrt(apart / whole + grouping +
                   (merging * merging * byVolume + textures * textures * ofTextured) / whole);
}

std::optional<double> predictError(const Scene& scene, const Grid& grid, const LightingSettings& options,
                                   std::uint32_t seed) {
  return ErrorPredictor(scene, options, seed).with(grid);
}

}  // namespace lpv
