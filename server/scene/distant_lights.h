#pragma once
// Lights so far away that their light comes from the same directions everywhere: a picture of the sky, the sun. A
// session has them as they were given, in the unit of their distance; ticks have them in parts, placed around the grid.

#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "scene/grid.h"
#include "scene/scene.h"

namespace lpv {

/// How far away, in half diagonals of the grid: directions within it differ by a quarter of a degree at the most.
inline constexpr double kDistance = 256.0;

/// Parts of one light at most. A receiver asks each by rays of its own until neighbours agree, so what is behind a wall
/// costs four rays, and what is seen through a window is one or two of them.
inline constexpr std::size_t kMostDistantParts = 8;

/// A sphere of radius 1 that emits inwards, with texture coordinates of an equirectangular picture: its middle is
/// towards +x, its top towards +y, its right towards +z. Positions, uvs and triangles alone.
Mesh skyMesh();

/// A part of a mesh, and where shadow rays to it go: half of them spread by area, half by what is sent.
struct DistantPart {
  MeshPtr mesh;
  LightPointsPtr points;
};

/// Where a mesh is seen, but for how it is turned: scale x position + offset, from the origin.
struct DistantShape {
  glm::dvec3 scale{1.0};
  glm::dvec3 offset{0.0};
};

/// A mesh of `distant` lights in parts, each seen within few directions or sending little: those that differ most are
/// halved, where that leaves the least differences of directions within the halves, by power and by area alike. Every
/// triangle is in one of them; meshes of more than 65,536 are one part. `texture` may be null. Made at the first call
/// for both, in a tenth of a second for the sky, and kept while somebody has them. Thread-safe.
std::shared_ptr<const std::vector<DistantPart>> distantParts(const MeshPtr& mesh, const TexturePtr& texture,
                                                             const DistantShape& shape = {});

/// Where a distant light's mesh is in a scene with this grid.
Transform placedAround(const Grid& grid, const Transform& given);

/// Puts parts in the place of distant lights, as "NAME/1", "NAME/2", .., which no light of a session can be called.
/// Those that are there already are placed anew where the grid is another.
void placeDistantLights(std::map<std::string, LightPtr>& lights, const Grid& grid);

/// Takes away the parts of the light of that name.
void eraseParts(std::map<std::string, LightPtr>& lights, const std::string& name);

}  // namespace lpv
