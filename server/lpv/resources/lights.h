#pragma once
// What voxelization needs to know of a scene's lights, worked out on the CPU.

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "lpv/resources/cell_box.h"
#include "scene/scene.h"

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
  bool polygons = false;  ///< receivers look at its triangles, not at its VPLs (lpv/transport/emitter_list.h)

  Emission emission() const;
};

/// The scene's emitting lights in name order, in the cells of `grid`. `previous` saves working out radiance from power
/// for unchanged lights.
std::vector<EmittingLight> emittingLights(const Scene& scene, const Grid& grid,
                                          const std::vector<EmittingLight>& previous);

/// A box around every cell the lights can touch.
CellBox cellsAround(const std::vector<EmittingLight>& lights, const glm::ivec3& dims);

}  // namespace lpv
