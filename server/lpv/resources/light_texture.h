#pragma once
// The radiance factor of a textured light on the GPU, in the forms that injection reads.

#include <glm/glm.hpp>
#include <memory>

#include "gpu/buffer.h"
#include "gpu/texture.h"
#include "lpv/pacing/gpu_task.h"
#include "scene/texture.h"

namespace lpv {

/// Linear texels, tiled. Pictures of more than 2^22 texels are halved until they have fewer.
struct GpuLightTexture {
  TexturePtr source;
  glm::ivec2 size{0};
  int levels = 0;             ///< of the mip chain
  gpu::Texture radiance;      ///< RGBA32F with mip levels
  // shaders/voxelize/texture_integral.glsl
  gpu::Buffer rowIntegrals;  ///< double x 3: integral along the row from texel centre 0
  gpu::Buffer rowMoments;  ///< double x 2: of brightness times the distance from there and its square
  double radianceScale = 1.0;  ///< largest component of any texel; 1 for an all-black texture
  glm::dvec3 mean{0.0};
};

/// Fills `out` from `texture`, a bounded number of rows at a time.
GpuTask uploadLightTexture(const TexturePtr& texture, GpuLightTexture& out);

}  // namespace lpv
