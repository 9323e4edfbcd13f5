#pragma once
// The lights as receivers look at them without a grid (MATHS.md 3c): on the GPU for frames, and for the CPU's probes.

#include <vector>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "lpv/field.h"
#include "lpv/lights.h"
#include "lpv/voxels.h"

namespace lpv {

/// Up to so many triangles of constant radiance, without directions, are polygons; other lights are their trees.
inline constexpr std::size_t kMostPolygons = 32;

bool arePolygons(const EmittingLight& light);

struct DirectBuffer {
  gpu::Buffer texels;  ///< as shaders/direct.glsl has them
  gpu::BufferTexture view;
  std::size_t count = 0;

  /// `k`: the distance rule of the trees.
  void make(const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels, double k);
};

}  // namespace lpv
