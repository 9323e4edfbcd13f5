#pragma once
// The error of a session's light as it is predicted from its scene, before anything is computed on the device.

#include <cstdint>
#include <optional>
#include <span>

#include "scene/receiver_sampler.h"

namespace lpv {

inline constexpr std::uint32_t kPredictionSeed = 1;
/// Receivers of one prediction at most, at least, and what they and the lights' triangles multiply to at most: of a
/// grid about nine times as many closed forms are evaluated. Lights of many triangles are thinned to kThinned.
inline constexpr std::size_t kPredictedReceivers = 256, kLeastPredictedReceivers = 16;
inline constexpr std::size_t kMostPredicted = 6'000, kThinned = 96;

/// Emulates GATHER: seeded receivers as the self-check draws them (session/delivery/self_check.h), what the lookup
/// gives them where the centres of the cells around have the exact moments of each light, the near field as the server
/// has it, and the truth. Lights that are looked at through trees are as wrong as with DIRECT; where a receiver nearly
/// touches one that it sees as VPLs, which textured ones are, a figure by distance. No occluders; textures are taken as
/// their mean, and for what they add a figure by opening ratio, emission directions as normals. Lights share groups as
/// the scene names them; where it names none, they add what one group for all would, or most of what automatic grouping
/// may (groupingGoal), whichever is less, and nothing where two part. What merging voxels adds is a figure by opening
/// ratio.
class ErrorPredictor {
 public:
  /// `options`: resolved settings.
  ErrorPredictor(const Scene& scene, const LightingSettings& options, std::uint32_t seed = kPredictionSeed);

  /// Raw relative L2 of irradiance over the scene's surfaces with this grid; without surfaces over walls within the
  /// grid. Null where nothing emits, nothing is lit, or the lights are too many.
  std::optional<double> with(const Grid& grid) const;
  /// The part of it that looking at the lights has too: VPLs that nearly touch receivers.
  double ofTouching(const Grid& grid) const;

 private:
  struct Point {
    Receiver at;
    glm::dvec3 truth{0.0};
    double weight = 0.0;  ///< area that it stands for, times any common factor
    std::vector<double> toTrees;  ///< metres to each light that receivers near it see as VPLs
  };
  /// What a lookup gives: a volume for each group by hand, or by light; and one volume for all.
  struct LookedUp {
    glm::dvec3 apart{0.0};
    glm::dvec3 together{0.0};
  };

  std::vector<Point> pointsFor(const Grid& grid) const;
  std::vector<Point> sampled(const LitSides& sides) const;
  double farFromLights(const Grid& grid, const glm::dvec3& at) const;
  double touching(const Grid& grid, const Point& point) const;
  /// `shares` of the lights are not in the volume.
  LookedUp lookUp(const Grid& grid, const Receiver& at, std::span<const double> shares) const;

  const Scene& scene_;
  LightingSettings options_;
  std::uint32_t seed_;
  AreaLights all_;
  AreaLights lights_;  ///< thinned
  std::vector<std::size_t> groupOf_;  ///< by light
  std::size_t groups_ = 0;
  bool grouped_ = false;  ///< by hand
  std::vector<double> textured_;  ///< by light: 1 where it has a texture
  std::vector<Point> onSurfaces_;
};

/// ErrorPredictor's figure for one grid.
std::optional<double> predictError(const Scene& scene, const Grid& grid, const LightingSettings& options,
                                   std::uint32_t seed = kPredictionSeed);

}  // namespace lpv
