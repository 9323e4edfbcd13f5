#pragma once

#include <cstdint>
#include <string>

#include "base/status.h"
#include "scene/grid.h"

namespace lpv {

enum class Injection { kCount, kFlux };
enum class InjectionMethod { kCompute, kRaster, kDense };
enum class Transport { kPropagate, kGather, kDirect };
enum class Quality { kFast, kAccurate };
enum class Lookup { kSh2, kCap, kNearest };
enum class Visibility { kAuto, kOn, kOff };

inline constexpr int kMaxIterations = 1000;
/// k of GATHER's distance rule by quality (MATHS.md 3b.3).
inline constexpr double kFastOpeningRatio = 1.5;
inline constexpr double kAccurateOpeningRatio = 3.0;

/// Everything a session may ask of its light transport. Values whose feature is not in this version are refused by
/// checkOptions with UNIMPLEMENTED, by name.
struct LightingSettings {
  GridOptions grid;
  Injection injection = Injection::kFlux;
  InjectionMethod method = InjectionMethod::kCompute;
  int denseSamples = 0;                 ///< samples per triangle of kDense
  Transport transport = Transport::kGather;
  bool clampFaces = false;              ///< PROPAGATE: K&D's clamp of face intensities at 0 (adds energy)
  Quality quality = Quality::kFast;
  int iterations = 0;                   ///< PROPAGATE: 0 = the grid's longest dimension; 1..kMaxIterations
  double k = 0.0;                       ///< GATHER, DIRECT: distance rule of the tree; 0 = from quality
  Lookup lookup = Lookup::kCap;
  double maxError = 0.0;                ///< wanted raw relative L2 (scene/error_goal.h); 0 = not asked
  Visibility visibility = Visibility::kAuto;
  int bounces = 0;
  double haze = 0.0;                    ///< extinction per metre; 0 = none

  bool operator==(const LightingSettings&) const = default;

  /// What the paper does: COUNT, PROPAGATE, SH2.
  static LightingSettings paper();
  /// Injection and lookup that belong to a transport when nothing else is said.
  void followTransport();

  int iterationsFor(const Grid& g) const;
  /// k of GATHER's distance rule, of settings as they are carried out.
  double openingRatio() const;
};

/// INVALID_ARGUMENT for values out of range or that do not go together, UNIMPLEMENTED for values of later versions,
/// both by field; whatever the error goal.
Status checkSavedOptions(const LightingSettings& options);

/// The same, and INVALID_ARGUMENT for an error goal out of reach: of settings that somebody asks for. What was reached
/// by the measurements of an older version is no reason to give up what was kept.
Status checkOptions(const LightingSettings& options);

}  // namespace lpv
