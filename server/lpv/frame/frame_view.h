#pragma once
// One camera's geometry: matrices for drawing, rays for finding positions again from depth.

#include <array>
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

/// A part of a picture in clip space, x to the right and y up, -1..1; empty where `low` is above `high`.
struct PicturePart {
  glm::dvec2 low{1.0}, high{-1.0};

  bool meets(const PicturePart& other) const {
    return glm::all(glm::lessThanEqual(low, other.high)) && glm::all(glm::lessThanEqual(other.low, high));
  }
  void add(const PicturePart& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
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
  /// Where the box is: all of the picture if some of it is beside or behind the eye.
  PicturePart partOf(const Bounds& objectBounds, const glm::dmat4& worldFromObject) const;

 private:
  std::array<glm::dvec4, 8> cornersOf(const Bounds& box, const glm::dmat4& worldFromObject) const;
  glm::dmat4 clipFromEyeOf(const glm::dvec2& offset, int firstRow, int rows) const;

  Camera camera_;
  glm::ivec2 size_;  ///< of the whole picture
  int firstRow_, rows_;  ///< those that are asked for
  glm::dmat4 viewFromEye_{1.0};  ///< rotation only
  glm::dmat4 clipFromView_{1.0};  ///< of the whole picture; reversed depth
};

}  // namespace lpv
