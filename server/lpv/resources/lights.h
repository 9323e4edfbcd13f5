#pragma once
// What voxelization needs to know of a scene's lights, worked out on the CPU.

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "lpv/resources/cell_box.h"
#include "scene/emitter_list.h"
#include "scene/scene.h"
#include "scene/small_lights.h"

namespace lpv {

/// All that the grid knows of a light.
struct Emission {
  MeshPtr mesh;
  glm::dmat4 gridFromObject{1.0};
  glm::dvec3 radiance{0.0};
  bool twoSided = false;
  bool mirrored = false;
  TexturePtr texture;
  std::string group;  ///< by name
  bool castsShadow = true;

  bool operator==(const Emission&) const = default;
};

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
  int nextGroup = 0;      ///< the group that it is on its way to, and the share of its light that is there
  double moved = 0.0;
  double lookedAt = 0.0;  ///< share that receivers look at wherever they are (scene/small_lights.h), in layers apart
  bool polygons = false;  ///< receivers look at its triangles, not at its VPLs (lpv/transport/emitter_list.h)
  bool tree = false;  ///< receivers look at the tree over its triangles (scene/emitter_tree.h)

  Emission emission() const;
};

/// All that receivers know of a light that they look at: where it is in the list aside.
struct LookedAtLight {
  Emission emission;  ///< its group left out
  bool polygons = false;
  bool tree = false;

  bool operator==(const LookedAtLight&) const = default;
};
LookedAtLight lookedAt(const EmittingLight& light);

/// The scene's emitting lights in name order, in the cells of `grid`, with what GATHER's receivers look at. `previous`
/// saves working out radiance from power for unchanged lights.
std::vector<EmittingLight> emittingLights(const Scene& scene, const Grid& grid,
                                          const std::vector<EmittingLight>& previous);

/// Diagonal of the light's box, cells; the same however it is turned.
double cellsAcross(const EmittingLight& light);

/// Of constant radiance without directions: what the closed form for polygons holds for.
bool isConstant(const EmittingLight& light);

/// Whether the near field takes the light for polygons, as far as it goes by this light alone.
bool fewPolygons(const EmittingLight& light);

/// areLookedAtEverywhere of scene/small_lights.h.
bool lookedAtEverywhere(const std::vector<EmittingLight>& lights);
/// Whether some of their light is.
bool someLookedAt(const std::vector<EmittingLight>& lights);

/// A box around every cell the lights can touch.
CellBox cellsAround(const std::vector<EmittingLight>& lights, const glm::ivec3& dims);

}  // namespace lpv
