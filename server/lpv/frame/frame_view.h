#pragma once
// One camera's geometry: matrices for drawing, rays for finding positions again from depth.

#include <glm/glm.hpp>

#include "engine/engine.h"
#include "scene/bounds.h"
#include "scene/camera.h"
#include "scene/grid.h"
#include "shaders/layout.h"

namespace lpv {

/// A frame to be drawn, or some rows of one: `size` is theirs.
struct FrameRows : FrameRequest {
  explicit FrameRows(const FrameRequest& whole) : FrameRequest(whole), pictureHeight(whole.size.y) {}

  int firstRow = 0;   ///< of the picture
  int pictureHeight;  ///< rows
};

/// Eye space is world space moved to the eye, so that single precision suffices on the GPU anywhere in the world. Depth
/// is reversed (near 1, far 0): a float keeps it to 1e-7 of the distance. Row 0 of a picture is its top row.
class FrameView {
 public:
  explicit FrameView(const FrameRows& frame);

  /// What the frame shaders read. `grid` places the picture's rays in the volume.
  layout::FrameParams params(const Grid& grid) const;
  /// To draw some of the request's rows by themselves, `offset` pixels to the right of and below their middles.
  glm::mat4 clipFromEye(const glm::dvec2& offset, int firstRow, int rows) const;
  /// `worldFromObject` moved to the eye.
  glm::dmat4 eyeFromObject(const glm::dmat4& worldFromObject) const;
  /// What a distant light is drawn with: its directions are the same wherever the eye is.
  glm::dmat4 worldFromDistant(const Light& light) const;
  /// False when no point of the box can be in the picture.
  bool sees(const Bounds& objectBounds, const glm::dmat4& worldFromObject) const;

 private:
  glm::dmat4 clipFromEyeOf(const glm::dvec2& offset, int firstRow, int rows) const;

  Camera camera_;
  glm::ivec2 size_;  ///< of the whole picture
  int firstRow_, rows_;  ///< those that are asked for
  glm::dmat4 viewFromEye_{1.0};  ///< rotation only
  glm::dmat4 clipFromView_{1.0};  ///< of the whole picture; reversed depth
};

}  // namespace lpv
