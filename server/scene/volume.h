#pragma once
// Volumes: SH of incident radiance per cell, and the lookup of irradiance in them.

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "scene/emitter_list.h"
#include "scene/grid.h"
#include "scene/options.h"
#include "scene/sh.h"

namespace lpv {

/// Which field a volume shows.
enum class VolumeStage {
  kInjected,     ///< SH of emitted intensity per cell, W/sr, direction of emission (MATHS.md 2)
  kTransported,  ///< SH of incident radiance at cell centres, W/(sr m^2), direction towards the light
};

/// One light group's field: cells x 3 colours x 4 coefficients, x fastest: [((z ny + y) nx + x) 3 + colour] 4 + coef.
struct VolumeLayer {
  std::string group;
  std::vector<float> coefficients;
};

/// 1..8 layers over one grid. Irradiance is looked up per layer and summed.
struct Volume {
  Grid grid;
  VolumeStage stage = VolumeStage::kTransported;
  std::vector<VolumeLayer> layers;
  EmitterListPtr direct;  ///< its lights, for receivers near emitters or outside the grid; null with PROPAGATE

  /// Coefficients of one cell and colour.
  static sh::Coefficients at(const VolumeLayer& layer, const Grid& grid, const glm::ivec3& cell, int colour);
};
using VolumePtr = std::shared_ptr<const Volume>;

/// One lookup's answer.
struct Irradiance {
  glm::dvec3 rgb{0.0};  ///< W/m^2
  bool valid = false;   ///< false more than half a cell outside the grid, where the volume has no answer
};

/// Irradiance at world position p on a surface with unit normal n: trilinear (kNearest: nearest cell), clamped to the
/// outermost cell centres within half a cell outside the grid; then kCap, or phi/4 + D.n/2 (MATHS.md 4). Layers are
/// looked up one by one and summed. The GLSL twin is shaders/transport/lookup.glsl.
Irradiance irradianceAt(const Volume& volume, Lookup lookup, const glm::dvec3& p, const glm::dvec3& n);

/// The same with the near field: the lights themselves where emitters are near, or outside the grid, blended by
/// smoothstep (MATHS.md 3c). Without Volume::direct as above.
Irradiance irradianceWithNearField(const Volume& volume, Lookup lookup, const glm::dvec3& p, const glm::dvec3& n);

/// E = max(0, phi/4 + D.n/2) of one colour.
double irradianceSh2(const sh::Coefficients& incident, const glm::dvec3& n);

/// E of one colour from the uniform cap of light about D with the same phi and |D| (MATHS.md 4), n a unit vector. Exact
/// where the light and that cap are above the horizon; finite and at least 0 for any finite coefficients, |D| > phi
/// too.
double irradianceCap(const sh::Coefficients& incident, const glm::dvec3& n);

}  // namespace lpv
