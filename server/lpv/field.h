#pragma once
// GPU memory of one session's grid.

#include <array>
#include <optional>
#include <string>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "lpv/lights.h"
#include "scene/grid.h"

namespace lpv {

/// Coefficients of every cell and channel, with a halo of one zero cell around the grid (shaders/field.glsl).
struct FieldBuffer {
  FieldBuffer() = default;
  FieldBuffer(const std::string& label, const glm::ivec3& dims, int channels);
  gpu::Buffer buffer;
  gpu::BufferTexture texels;
};

/// Everything whose size follows from grid and channels. Made anew when either changes.
struct LightField {
  LightField(const Grid& grid, int channels);

  Grid grid;
  int channels;                            ///< 1..3 (lights.h, Palette)
  gpu::Buffer accumulators;                ///< words per cell (shaders/deposit.glsl); all zero between lights
  gpu::Buffer lobeCounts;                  ///< float per cell: N of eq. 1, negative once divided by
  gpu::Buffer counters;                    ///< layout::Counters
  FieldBuffer injected;                    ///< emitted intensity of unit palette radiance, W/sr per W/(sr m^2)
  std::array<FieldBuffer, 2> steps;        ///< propagation goes back and forth between them
  std::optional<FieldBuffer> sum;          ///< clamped form only
  int result = 0;                          ///< which of `steps` holds the transported field (unless `sum` does)
  bool clamped = false;                    ///< the transported field is in `sum`

  const FieldBuffer& transported() const { return clamped ? *sum : steps[std::size_t(result)]; }
};

}  // namespace lpv
