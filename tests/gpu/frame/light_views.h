#pragma once
// A lamp over a floor, seen from above through the lamp: every point of the floor, up to where they touch.

#include <vector>

#include "gpu/engine/engine_rig.h"
#include "reference/ground_truth.h"
#include "reference/receivers.h"
#include "scene/scene.h"

namespace lpv::test {

/// 20^3 cells of .2 m about the origin; a white floor of 3.6 x 3.6 m in the plane z = 0, front up; the lamp "light",
/// 1 m across, its front down, a little off the middle and of the axes.
Scene floorScene(Transport transport, const MeshPtr& mesh);

/// A picture of the floor from above, the camera's near plane just above the floor.
struct FloorView {
  FrameRequest frame;
  std::vector<reference::Receiver> points;  ///< per pixel, world
};
/// Moves the floor so many cells below the lowest point of the lamp.
FloorView floorView(Scene& scene, double cellsBelow, const glm::ivec2& size = {64, 64});

/// pi radiance / albedo per pixel.
std::vector<glm::dvec3> floorIrradiance(const Frame& frame, const FloorView& view);
std::vector<glm::dvec3> truthOn(const Scene& scene, const FloorView& view);

/// Random points of the grid with random normals, outside the light, at least so many cells from it.
std::vector<reference::Receiver> receiversAway(const Grid& grid, const std::vector<reference::Emitter>& emitters,
                                               double cells, std::size_t count);

/// reference::errors, and a failure for lists that differ in length.
reference::Errors relativeErrors(const std::vector<glm::dvec3>& got, const std::vector<glm::dvec3>& want);

}  // namespace lpv::test
