#pragma once
// What voxelization needs to know of a scene's lights, worked out on the CPU.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace lpv {

/// A light that emits: enabled, with a radiance above 0.
struct EmittingLight {
  LightPtr source;                  ///< null only in tests
  MeshPtr mesh;
  glm::dmat4 gridFromObject{1.0};   ///< cell units from the grid's minimum corner
  glm::dvec3 radiance{0.0};         ///< W/(sr m^2)
  bool twoSided = false;
  bool mirrored = false;  ///< the transform turns the mesh inside out; it emits from the object-space front
  TexturePtr texture;     ///< radiance factor, or null; null for a mesh without texture coordinates
  int group = 0;          ///< of the scene's groups of lights, which one
  bool polygons = false;  ///< receivers look at its triangles, not at its VPLs (lpv/transport/emitter_list.h)

  /// Whether both put the same VPLs into the grid.
  bool emitsLike(const EmittingLight& other) const;
};

/// The scene's emitting lights in name order. `previous` saves working out radiance from power for unchanged lights.
std::vector<EmittingLight> emittingLights(const Scene& scene, const std::vector<EmittingLight>& previous);

/// The field is kept per channel of colour, not per colour: lights of one chromaticity share a channel, whose colour is
/// applied at the end. Transport is linear, so this is exact, and one white light costs a third. A textured light has
/// every colour.
struct Palette {
  int channels = 1;  ///< 1..3; 3 is always red, green, blue
  std::array<glm::dvec3, 3> radiance{};  ///< rgb of each channel's unit, that of its radianceScale light
  std::vector<glm::dvec3> weights;  ///< per light: share of each channel's unit, 0..1
};
Palette choosePalette(const std::vector<EmittingLight>& lights);

/// Fixed point of COUNT's accumulators (MATHS.md 2): value = word / 2^shift, values up to 1 per lobe.
struct FixedPoint {
  int shift = 0;
  double error = 0.0;  ///< bound of the rounding of one injected coefficient, relative to the largest possible
};
/// The finest for which `lobes` aligned lobes of one light in one cell cannot overflow int32. RESOURCE_EXHAUSTED when
/// there are too many for any.
Expected<FixedPoint> fixedPointFor(std::uint64_t lobes);

/// Cells [lower, upper), empty where any axis is.
struct CellBox {
  glm::ivec3 lower{0};
  glm::ivec3 upper{0};

  bool operator==(const CellBox&) const = default;
  bool empty() const { return lower.x >= upper.x || lower.y >= upper.y || lower.z >= upper.z; }
  /// One more cell on each side, within the grid: as far as light gets in one iteration.
  CellBox grown(const glm::ivec3& dims, int by = 1) const;
};
/// A box around every cell the lights can touch.
CellBox cellsAround(const std::vector<EmittingLight>& lights, const glm::ivec3& dims);

}  // namespace lpv
