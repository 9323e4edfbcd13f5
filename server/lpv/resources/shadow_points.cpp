#include "lpv/resources/shadow_points.h"

#include <glm/glm.hpp>

namespace lpv {

namespace {

/// Vectors of four of a ShadowPoint (shaders/visibility/shadow_points.glsl).
constexpr std::size_t kTexels = 7;

gpu::Buffer deviceBuffer(const std::string& label, std::size_t bytes) {
  return {label, bytes, gpu::BufferUse::kDevice, gpu::Undefined{}};
}

}  // namespace

ShadowPoints::ShadowPoints(const std::string& label, std::size_t points)
    : label_(label), count_(points), points_(deviceBuffer(label, points * kTexels * sizeof(glm::vec4))) {}

void ShadowPoints::bind() const {
  points_.bindStorage(layout::kShadowPoints);
  if (patchSums_) patchSums_.bindStorage(layout::kPatchSums);
}

void ShadowPoints::keepPatchSums() {
  if (!patchSums_)
    patchSums_ = deviceBuffer(label_ + ": sums of patches", count_ * layout::kPatchSumsOfPoint * sizeof(float));
}

}  // namespace lpv
