#include "renderer/linear_texture.h"

#include <cmath>

namespace lpv::evaluation {

namespace {

int wrapped(int i, int size) { return ((i % size) + size) % size; }

}  // namespace

LinearTexture::LinearTexture(const Texture& texture) : width_(texture.width), height_(texture.height) {
  for (int row = 0; row < height_; ++row) appendLinearRow(texture, row, texels_);
  for (const glm::vec3& texel : texels_) mean_ += glm::dvec3(texel);
  mean_ /= double(texels_.size());
}

glm::dvec3 LinearTexture::texel(int x, int y) const {
  return texels_[std::size_t(wrapped(y, height_)) * std::size_t(width_) + std::size_t(wrapped(x, width_))];
}

glm::dvec3 LinearTexture::at(const glm::dvec2& uv) const {
  const double x = uv.x * width_ - 0.5;
  const double y = uv.y * height_ - 0.5;
  const int left = int(std::floor(x));
  const int top = int(std::floor(y));
  const glm::dvec3 upper = glm::mix(texel(left, top), texel(left + 1, top), x - left);
  const glm::dvec3 lower = glm::mix(texel(left, top + 1), texel(left + 1, top + 1), x - left);
  return glm::mix(upper, lower, y - top);
}

}  // namespace lpv::evaluation
