#pragma once
// A texture as linear texels, looked up as the server does: bilinear, repeated, at full resolution.

#include <glm/glm.hpp>
#include <vector>

#include "scene/texture.h"

namespace lpv::evaluation {

class LinearTexture {
 public:
  explicit LinearTexture(const Texture& texture);

  /// (0, 0) is the outer corner of the first texel of the first row.
  glm::dvec3 at(const glm::dvec2& uv) const;
  /// Of all texels.
  glm::dvec3 mean() const { return mean_; }
  int width() const { return width_; }
  int height() const { return height_; }
  /// Rows from v = 0, linear RGB.
  const std::vector<glm::vec3>& texels() const { return texels_; }

 private:
  glm::dvec3 texel(int x, int y) const;

  int width_;
  int height_;
  std::vector<glm::vec3> texels_;
  glm::dvec3 mean_{0.0};
};

}  // namespace lpv::evaluation
