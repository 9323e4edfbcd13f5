#include "lpv/frame/frame_view.h"

#include <array>

namespace lpv {

namespace {

/// GL's depth -1..1 to 1..0.
glm::dmat4 reversedFromClip() {
  glm::dmat4 m(1.0);
  m[2][2] = -0.5;
  m[3][2] = 0.5;
  return m;
}

}  // namespace

FrameView::FrameView(const Camera& camera, const glm::ivec2& size)
    : camera_(camera),
      size_(size),
      viewFromEye_(glm::dmat3(camera.viewFromWorld())),
      clipFromView_(reversedFromClip() * camera.clipFromView(double(size.x) / double(size.y))) {}

layout::FrameParams FrameView::params(const Grid& grid) const {
  const glm::dmat3 eyeFromView = glm::transpose(glm::dmat3(viewFromEye_));
  const glm::dvec3 right = eyeFromView[0] / clipFromView_[0][0], up = eyeFromView[1] / clipFromView_[1][1];
  const glm::dvec3 forward = -eyeFromView[2];
  layout::FrameParams params{};
  params.clipFromEye = glm::mat4(clipFromView_ * viewFromEye_);
  params.rayOrigin = glm::vec3((forward - right + up) / grid.cell);
  params.rayRight = glm::vec3(2.0 * right / grid.cell);
  params.rayDown = glm::vec3(-2.0 * up / grid.cell);
  params.eye = glm::vec3(grid.gridFromWorld(camera_.eye));
  // depth d = (A z + B) / -z with z = -view depth
  params.depthScale = float(clipFromView_[3][2]);
  params.depthOffset = float(clipFromView_[2][2]);
  params.pixelSize = glm::vec2(1.0 / glm::dvec2(size_));
  params.dims = grid.dims;
  params.pixels = size_.x * size_.y;
  return params;
}

glm::mat4 FrameView::clipFromEye(const glm::dvec2& offset, int firstRow, int rows) const {
  const glm::dvec2 size(size_), to = 2.0 * offset / size;
  const double share = size.y / double(rows);
  glm::dmat4 moved(1.0);  // clip space: y points up, and row 0 is the top one
  moved[3][0] = -to.x;
  moved[1][1] = share;
  moved[3][1] = to.y * share + 1.0 - share + 2.0 * firstRow / double(rows);
  return glm::mat4(moved * clipFromView_ * viewFromEye_);
}

glm::dmat4 FrameView::eyeFromObject(const glm::dmat4& worldFromObject) const {
  glm::dmat4 m = worldFromObject;
  m[3] -= glm::dvec4(camera_.eye, 0.0);
  return m;
}

bool FrameView::sees(const Bounds& box, const glm::dmat4& worldFromObject) const {
  const glm::dmat4 clipFromObject = clipFromView_ * viewFromEye_ * eyeFromObject(worldFromObject);
  std::array<int, 6> outside{};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec4 p =
        clipFromObject * glm::dvec4((corner & 1) ? box.max.x : box.min.x, (corner & 2) ? box.max.y : box.min.y,
                                    (corner & 4) ? box.max.z : box.min.z, 1.0);
    const std::array<bool, 6> beyond = {p.x<-p.w, p.x> p.w, p.y<-p.w, p.y> p.w, p.z<0.0, p.z> p.w};
    for (std::size_t i = 0; i < 6; ++i) outside[i] += beyond[i] ? 1 : 0;
  }
  for (const int corners : outside) {
    if (corners == 8) return false;
  }
  return true;
}

}  // namespace lpv
