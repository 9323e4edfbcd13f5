#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "scene/texture.h"

namespace lpv {

/// A texture as some boxes across at most, each the mean of some of its rows: what a part of a mesh has on the whole.
class CoarseTexture {
 public:
  static constexpr int kMostBoxes = 64;
  /// `factors`: by the alpha of a texel, 256 of them; empty: 1.
  explicit CoarseTexture(const Texture& texture, const std::vector<float>& factors = {}, int mostBoxes = kMostBoxes);
  /// Boxes across and down, and their means, row by row.
  const glm::ivec2& size() const { return size_; }
  const std::vector<glm::dvec3>& means() const { return means_; }
  /// Linear, of the box that holds uv; (0, 0) is the corner of the first texel, and the texture repeats.
  glm::vec3 at(const glm::dvec2& uv) const;
  /// The mean over a triangle, from places in it, several for each box that it covers.
  glm::vec3 meanOver(const glm::dvec2 (&uvs)[3]) const;

 private:
  static constexpr int kPlacesOfBox = 4, kMostPlaces = 1024;

  std::size_t indexOf(const glm::ivec2& box) const {
    return std::size_t(box.y) * std::size_t(size_.x) + std::size_t(box.x);
  }

  glm::ivec2 size_;
  std::vector<glm::dvec3> means_;
};

}  // namespace lpv
