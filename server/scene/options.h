#pragma once

#include <cstdint>
#include <string>

#include "base/status.h"
#include "scene/grid.h"

namespace lpv {

enum class Injection { kCount, kFlux };
enum class InjectionMethod { kCompute, kRaster, kDense };
/// kAuto: GATHER or DIRECT, as the scene is (scene/transport_choice.h); never of a scene that a tick reads.
enum class Transport { kPropagate, kGather, kDirect, kAuto };
enum class Quality { kFast, kAccurate };
enum class Lookup { kSh2, kCap, kNearest };
enum class Visibility { kAuto, kOn, kOff };
/// Whether frames show what surfaces reflect like mirrors, sharply or not (MATHS.md 3e).
enum class Gloss { kOn, kOff };

inline constexpr int kMaxIterations = 1000;
inline constexpr int kMaxBounces = 32;
inline constexpr int kAutoBounces = -1;
inline constexpr double kMaxHaze = 100.0;
inline constexpr double kMaxHazeAnisotropy = 0.95;
/// Opening ratio of GATHER and DIRECT by quality (MATHS.md 3b.3).
inline constexpr double kFastOpeningRatio = 1.5;
inline constexpr double kAccurateOpeningRatio = 3.0;

/// A session's settings of light transport. checkOptions refuses values of features that this version lacks with
/// UNIMPLEMENTED and the field's name.
struct LightingSettings {
  GridOptions grid;
  Injection injection = Injection::kFlux;
  InjectionMethod method = InjectionMethod::kCompute;
  int denseSamples = 0;                 ///< samples per triangle of kDense
  Transport transport = Transport::kGather;
  bool clampFaces = false;              ///< PROPAGATE: K&D's clamp of face intensities at 0 (adds energy)
  Quality quality = Quality::kFast;
  int iterations = 0;                   ///< PROPAGATE: 0 = the grid's longest dimension; 1..kMaxIterations
  double k = 0.0;                       ///< GATHER, DIRECT: opening ratio of the tree walk; 0 = from quality
  Lookup lookup = Lookup::kCap;
  double maxError = 0.0;                ///< wanted raw relative L2 (scene/error_goal.h); 0 = not asked
  Visibility visibility = Visibility::kAuto;
  int bounces = 0;                      ///< 0..kMaxBounces, or kAutoBounces: as many as the wanted error asks for
  Gloss gloss = Gloss::kOff;
  double haze = 0.0;                    ///< extinction per metre of what fills the grid (scene/haze.h); 0 = none
  double hazeAbsorption = 0.0;          ///< of what haze takes from light, the share that it does not scatter
  double hazeAnisotropy = 0.0;          ///< of what it scatters: mean cosine (Henyey and Greenstein 1941)

  bool operator==(const LightingSettings&) const = default;

  /// The paper's settings: COUNT, PROPAGATE, SH2.
  static LightingSettings paper();
  /// Sets the injection and lookup that are the defaults of the transport.
  void followTransport();

  int iterationsFor(const Grid& g) const;
  /// Whether the server groups lights where the scene names no groups: GATHER with CAP. Of resolved settings.
  bool groupsItself() const { return transport == Transport::kGather && lookup == Lookup::kCap; }
  /// The opening ratio of resolved settings.
  double openingRatio() const;
};

/// INVALID_ARGUMENT for values out of range or in conflict, UNIMPLEMENTED for features of later versions; both name the
/// field. Does not check the error goal.
Status checkSavedOptions(const LightingSettings& options);

/// checkSavedOptions, and INVALID_ARGUMENT for an error goal out of reach: for settings of a call. Saved settings may
/// miss a goal because the table of expected errors differs between versions.
Status checkOptions(const LightingSettings& options);

}  // namespace lpv
