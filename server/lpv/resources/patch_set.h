#pragma once
// The surfaces' patches on the GPU: what reaches them, which of them see each other, and what they reflect (MATHS.md
// 3d; scene/patches.h).

#include <vector>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "scene/grid.h"
#include "scene/patches.h"
#include "shaders/layout.h"

namespace lpv {

struct PatchSet {
  /// Nothing arrives yet, and none sees another. `patches` is not empty. `throughPanes`: pairs may see each other
  /// through something.
  PatchSet(std::vector<Patch> patches, const Grid& grid, bool throughPanes);

  layout::PatchParams params() const;

  std::vector<Patch> source;
  int count;
  bool colours;          ///< of pairs: what light keeps between them, not a bit
  int words;             ///< of 32 bits, of a row of `pairs`
  gpu::Buffer patches;   ///< as shaders/visibility/patches.glsl has them
  gpu::Buffer pairs;     ///< a bit per pair: whether they see each other; or packedShare()
  gpu::Buffer points;    ///< all patches, as a list of points to be evaluated (layout::kNearFieldPoints)
  gpu::Buffer shadows;   ///< layout::kShadowPoints
  gpu::Buffer lights;    ///< what they send, as shaders/visibility/light_points.glsl has points
  gpu::BufferTexture lightTexels;
};

}  // namespace lpv
