#pragma once

#include <cstdint>
#include <string>

#include "scene/grid.h"
#include "scene/status.h"

namespace lpv {

enum class Injection { kCount, kFlux };
enum class InjectionMethod { kCompute, kRaster, kDense };
enum class Transport { kPropagate, kGather, kDirect };
enum class Quality { kFast, kAccurate };
enum class Lookup { kSh2, kCap, kNearest };
enum class Visibility { kAuto, kOn, kOff };

inline constexpr int kMaxIterations = 1000;

/// Everything a session may ask of its light transport. Values whose feature is not in this version are refused by
/// checkOptions with UNIMPLEMENTED, by name.
struct SessionOptions {
  GridOptions grid;
  Injection injection = Injection::kCount;
  InjectionMethod method = InjectionMethod::kCompute;
  int denseSamples = 0;                 ///< samples per triangle of kDense
  Transport transport = Transport::kPropagate;
  bool clampFaces = false;              ///< PROPAGATE: K&D's clamp of face intensities at 0 (adds energy)
  Quality quality = Quality::kFast;
  int iterations = 0;                   ///< PROPAGATE: 0 = the grid's longest dimension; 1..kMaxIterations
  double k = 0.0;                       ///< GATHER distance rule; 0 = from quality
  Lookup lookup = Lookup::kSh2;
  double maxError = 0.0;                ///< wanted raw relative L2; 0 = not asked
  Visibility visibility = Visibility::kAuto;
  int bounces = 0;
  double haze = 0.0;                    ///< extinction per metre; 0 = none

  bool operator==(const SessionOptions&) const = default;

  int iterationsFor(const Grid& g) const;
};

/// INVALID_ARGUMENT for values out of range, UNIMPLEMENTED for values of later versions, both by field.
Status checkOptions(const SessionOptions& options);

}  // namespace lpv
