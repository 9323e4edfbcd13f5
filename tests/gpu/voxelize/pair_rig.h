#pragma once
// The GPU's set of (triangle, cell) pairs beside the exact integer oracle's (MATHS.md 2, 6.8).

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "gpu/buffer_texture.h"
#include "gpu/support/gl_test.h"

namespace lpv::test {

using Triangle = std::array<glm::vec3, 3>;

/// What came of asking both about the same triangles. A decision is one cell of the grid that a snapped triangle's box
/// reaches: one yes or no of the oracle and of the GPU.
struct PairVerdict {
  std::uint64_t decisions = 0;
  std::uint64_t pairs = 0;    ///< of the oracle
  std::uint64_t missing = 0;  ///< pairs the GPU does not make
  std::uint64_t extra = 0;    ///< and those it should not, pairs made twice included

  PairVerdict& operator+=(const PairVerdict& other);
};

/// Programs and buffers that many comparisons share. Needs a current context.
class PairRig {
 public:
  PairRig();
  /// Asks the GPU, and the oracle on every core.
  PairVerdict compare(std::span<const Triangle> triangles, const glm::ivec3& dims,
                      const glm::dmat4& gridFromObject = glm::dmat4(1.0));

 private:
  using Pair = std::uint64_t;  // triangle << 32 | cell
  std::vector<Pair> gpuPairs(std::span<const Triangle> triangles, const glm::ivec3& dims,
                             const glm::dmat4& gridFromObject);

  gpu::Program small_, large_, thin_;
  gpu::Buffer recorded_, cells_, positions_, order_;
  gpu::BufferTexture positionTexels_, orderTexels_;
  gpu::Buffer items_, segments_, params_;
};

}  // namespace lpv::test
