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

FrameView::FrameView(const FrameRows& frame)
    : camera_(frame.camera),
      size_(frame.size.x, frame.pictureHeight),
      firstRow_(frame.firstRow),
      rows_(frame.size.y),
      viewFromEye_(glm::dmat3(camera_.viewFromWorld())),
      clipFromView_(reversedFromClip() * camera_.clipFromView(double(size_.x) / double(size_.y))) {}

layout::FrameParams FrameView::params(const Grid& grid) const {
  const glm::dmat3 eyeFromView = glm::transpose(glm::dmat3(viewFromEye_));
  const glm::dvec3 right = eyeFromView[0] / clipFromView_[0][0], up = eyeFromView[1] / clipFromView_[1][1];
  const glm::dvec3 forward = -eyeFromView[2];
  const double above = double(firstRow_) / size_.y, share = double(rows_) / size_.y;
  layout::FrameParams params{};
  params.clipFromEye = clipFromEye(glm::dvec2(0.0), 0, rows_);
  params.rayOrigin = glm::vec3((forward - right + (1.0 - 2.0 * above) * up) / grid.cell);
  params.rayRight = glm::vec3(2.0 * right / grid.cell);
  params.rayDown = glm::vec3(-2.0 * share * up / grid.cell);
  params.eye = glm::vec3(grid.gridFromWorld(camera_.eye));
  // depth d = (A z + B) / -z with z = -view depth
  params.depthScale = float(clipFromView_[3][2]);
  params.depthOffset = float(clipFromView_[2][2]);
  params.pixelSize = glm::vec2(1.0 / glm::dvec2(size_.x, rows_));
  params.dims = grid.dims;
  params.pixels = size_.x * rows_;
  return params;
}

glm::mat4 FrameView::clipFromEye(const glm::dvec2& offset, int firstRow, int rows) const {
  return glm::mat4(clipFromEyeOf(offset, firstRow_ + firstRow, rows));
}

/// Of rows of the whole picture.
glm::dmat4 FrameView::clipFromEyeOf(const glm::dvec2& offset, int firstRow, int rows) const {
  const glm::dvec2 size(size_), to = 2.0 * offset / size;
  const double share = size.y / double(rows);
  glm::dmat4 moved(1.0);  // clip space: y points up, and row 0 is the top one
  moved[3][0] = -to.x;
  moved[1][1] = share;
  moved[3][1] = to.y * share + 1.0 - share + 2.0 * firstRow / double(rows);
  return moved * clipFromView_ * viewFromEye_;
}

glm::dmat4 FrameView::eyeFromObject(const glm::dmat4& worldFromObject) const {
  glm::dmat4 m = worldFromObject;
  m[3] -= glm::dvec4(camera_.eye, 0.0);
  return m;
}

glm::dmat4 FrameView::worldFromDistant(const Light& light) const {
  glm::dmat4 m = (light.placedFrom != nullptr ? *light.placedFrom : light).transform.worldFromObject();
  m[3] += glm::dvec4(camera_.eye, 0.0);
  return m;
}

/// In clip space.
std::array<glm::dvec4, 8> FrameView::cornersOf(const Bounds& box, const glm::dmat4& worldFromObject) const {
  const glm::dmat4 clipFromObject = clipFromEyeOf(glm::dvec2(0.0), firstRow_, rows_) * eyeFromObject(worldFromObject);
  std::array<glm::dvec4, 8> out;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    out[corner] =
        clipFromObject * glm::dvec4((corner & 1) ? box.max.x : box.min.x, (corner & 2) ? box.max.y : box.min.y,
                                    (corner & 4) ? box.max.z : box.min.z, 1.0);
  }
  return out;
}

PicturePart FrameView::partOf(const Bounds& box, const glm::dmat4& worldFromObject) const {
  PicturePart out;
  for (const glm::dvec4& p : cornersOf(box, worldFromObject)) {
    if (p.w <= 0.0) return {glm::dvec2(-1.0), glm::dvec2(1.0)};
    out.add({glm::dvec2(p) / p.w, glm::dvec2(p) / p.w});
  }
  return out;
}

bool FrameView::sees(const Bounds& box, const glm::dmat4& worldFromObject) const {
  std::array<int, 6> outside{};
  for (const glm::dvec4& p : cornersOf(box, worldFromObject)) {
    const std::array<bool, 6> beyond = {p.x<-p.w, p.x> p.w, p.y<-p.w, p.y> p.w, p.z<0.0, p.z> p.w};
    for (std::size_t i = 0; i < 6; ++i) outside[i] += beyond[i] ? 1 : 0;
  }
  for (const int corners : outside) {
    if (corners == 8) return false;
  }
  return true;
}

}  // namespace lpv
