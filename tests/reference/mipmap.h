#pragma once
// A texture decoded to linear doubles with its mip chain (paper 3.3).
//
// Level k + 1 has max(1, floor(w / 2)) x max(1, floor(h / 2)) texels. Each is the mean of level k, taken as constant
// over each texel, over the texel's own rectangle: of 2 x 2 texels where sizes are even, else of the 3 that it touches
// along an odd axis, weighted by how much of each it covers (5 -> 2: weights 1, 1, 1/2 and 1/2, 1, 1 over 2.5; 3 -> 1:
// 1, 1, 1 over 3). Every level has the mean of level 0. The last level is 1 x 1: 1 + floor(log2(max(w, h))) levels.

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "scene/texture.h"

namespace lpv::reference {

struct MipLevel {
  int width = 0;
  int height = 0;
  std::vector<glm::dvec3> texels;  ///< linear RGB, rows from v = 0

  /// Coordinates wrap (repeat).
  const glm::dvec3& at(std::int64_t x, std::int64_t y) const;
};

struct MipChain {
  std::vector<MipLevel> levels;  ///< level 0 first; never empty
};
using MipChainPtr = std::shared_ptr<const MipChain>;

MipChain mipChainOf(const Texture& texture);

/// Texel centres at (i + .5) / size, repeat.
glm::dvec3 bilinear(const MipLevel& level, const glm::dvec2& uv);

/// Linear between the two levels next to lambda, which is clamped to [0, levels - 1] (log2 of 0 included).
glm::dvec3 trilinear(const MipChain& chain, const glm::dvec2& uv, double lambda);

}  // namespace lpv::reference
