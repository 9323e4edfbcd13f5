#pragma once
// The surfaces' patches on the GPU: what reaches them, what they exchange, and what they reflect (MATHS.md
// 3d; scene/patches.h).

#include <vector>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "scene/grid.h"
#include "scene/patches.h"
#include "shaders/layout.h"

namespace lpv {

/// Vectors of four of each point of layout::kShadowPoints (shaders/visibility/shadow_points.glsl).
inline constexpr int kShadowPointTexels = 6;

struct PatchSet {
  /// Nothing arrives yet, and none sees another. `patches` is not empty. `throughPanes`: some may see others through
  /// what lets light through.
  PatchSet(std::vector<Patch> patches, const Grid& grid, bool throughPanes);

  layout::PatchParams params() const;

  std::vector<Patch> source;
  int count;
  gpu::Buffer patches;   ///< as shaders/visibility/patches.glsl has them
  gpu::Buffer exchange;  ///< layout::kPatchExchange
  gpu::Buffer shares;    ///< layout::kPatchShares; empty without panes
  gpu::Buffer points;    ///< all patches, as a list of points to be evaluated (layout::kNearFieldPoints)
  gpu::Buffer shadows;   ///< layout::kShadowPoints
  gpu::Buffer lights;    ///< what they send, as shaders/visibility/light_points.glsl has points
  gpu::BufferTexture lightTexels;
};

}  // namespace lpv
