#pragma once
// One camera's geometry: matrices for drawing, rays for finding positions again from depth.

#include <glm/glm.hpp>

#include "scene/bounds.h"
#include "scene/camera.h"
#include "scene/grid.h"
#include "shaders/layout.h"

namespace lpv {

/// Eye space is world space moved to the eye, so that single precision suffices on the GPU anywhere in the world. Depth
/// is reversed (near 1, far 0): a float keeps it to 1e-7 of the distance. Row 0 of a picture is its top row.
class FrameView {
 public:
  FrameView(const Camera& camera, const glm::ivec2& size);

  /// What the frame shaders read. `grid` places the picture's rays in the volume.
  layout::FrameParams params(const Grid& grid) const;
  /// To draw some rows of the picture by themselves, `offset` pixels to the right of and below their middles.
  glm::mat4 clipFromEye(const glm::dvec2& offset, int firstRow, int rows) const;
  /// `worldFromObject` moved to the eye.
  glm::dmat4 eyeFromObject(const glm::dmat4& worldFromObject) const;
  /// False when no point of the box can be in the picture.
  bool sees(const Bounds& objectBounds, const glm::dmat4& worldFromObject) const;

 private:
  Camera camera_;
  glm::ivec2 size_;
  glm::dmat4 viewFromEye_{1.0};  ///< rotation only
  glm::dmat4 clipFromView_{1.0};  ///< reversed depth
};

}  // namespace lpv
