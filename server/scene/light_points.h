#pragma once
// Points of a light's surface that stand for all of it: where shadow rays go (MATHS.md 3d).

#include <cstddef>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "scene/mesh.h"
#include "scene/texture.h"

namespace lpv {

class CoarseTexture;

/// Stands for a patch of `area` around it.
struct LightPoint {
  glm::vec3 position{0.0F};
  float area = 0.0F;         ///< of one side
  glm::vec3 normal{0.0F};    ///< unit, of the front
  glm::vec3 direction{0.0F}; ///< unit, that it emits about: the normal, but for meshes with emission directions
  glm::vec3 factor{1.0F};    ///< mean of the texture around it
};
using LightPoints = std::vector<LightPoint>;
using LightPointsPtr = std::shared_ptr<const LightPoints>;

/// Points of a light that looks the same all over and has few triangles, and of any other.
inline constexpr std::size_t kPointsOfFewPolygons = 256;
inline constexpr std::size_t kMostLightPoints = 1024;

/// Of one mesh, object space, m^2: each stands for the same area, and neighbours in the list are neighbours in space,
/// so that every n-th one is a sample of the whole. Empty for a mesh without area. `texture` may be null; it is not
/// read where the mesh has no texture coordinates. `times` as many as usual.
LightPoints lightPoints(const Mesh& mesh, const Texture* texture, std::size_t times = 1);
/// The same of a light of which some of it may be far brighter than the rest, a picture of the sky: half of the points
/// are spread by area and half by what is sent, and each stands for the area that is left to it. `picture` may be null.
LightPoints lightPointsByPower(const Mesh& mesh, const CoarseTexture* picture);
/// Of a light with its mesh transformed; areas in the squared unit of the space that `transform` leads to.
LightPoints transformed(const LightPoints& points, const glm::dmat4& transform);

}  // namespace lpv
