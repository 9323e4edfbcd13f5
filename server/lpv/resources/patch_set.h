#pragma once
// The surfaces' patches on the GPU: what reaches them, what they exchange, and what they reflect (MATHS.md
// 3d; scene/patches.h).

#include <vector>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "lpv/resources/shadow_points.h"
#include "scene/grid.h"
#include "scene/patches.h"
#include "scene/scene.h"
#include "shaders/layout.h"

namespace lpv {

/// Some of the patches and pieces, as many as a dispatch should have.
struct PatchList {
  gpu::Buffer points;  ///< layout::kNearFieldPoints
  int count = 0;
};

struct PatchSet {
  /// Nothing arrives yet, and none sees another. There are patches. `throughPanes`: some may see others through what
  /// lets light through.
  PatchSet(PatchedScenePtr patched, const Scene& scene, const Grid& grid, bool throughPanes);

  layout::PatchParams params() const;
  /// For receivers.
  void bind() const;
  /// Whether receivers near them may look for their pieces.
  bool folded() const { return pieces > 0; }
  /// Of the patches alone, in `patches`.
  std::size_t bytesOfPatches() const;
  /// How what each patch sends changes across it per metre, over what it sends, by a copy of these bytes.
  std::vector<glm::dvec3> slopesIn(std::span<const std::byte> copied) const;
  /// Before pieces look for each other by so many turns of rays.
  void forgetFoldHits(int foldTurns);

  PatchedScenePtr source;
  double cell;  ///< metres
  int count;
  int pieces;
  gpu::Buffer patches;  ///< as shaders/visibility/patches.glsl has them: all patches, then the pieces of their folds
  gpu::Buffer exchange;  ///< layout::kPatchExchange
  gpu::BufferTexture exchangeTexels;
  gpu::Buffer sent;  ///< layout::kPatchSent
  gpu::BufferTexture sentTexels;
  gpu::Buffer shares;  ///< layout::kPatchShares; empty without panes
  std::vector<PatchList> points;  ///< all patches
  std::vector<PatchList> piecePoints;  ///< the pieces; empty without
  ShadowPoints shadows;  ///< of one list
  gpu::Buffer lights;  ///< what they send, as shaders/visibility/light_points.glsl has points
  gpu::BufferTexture lightTexels;
  gpu::Buffer pieceLights;  ///< layout::kPieceLights; empty without pieces
  gpu::Buffer foldHits;  ///< layout::kFoldHits; empty until pieces look for each other
  gpu::Buffer foldTriangles;  ///< layout::kFoldTriangles; empty without pieces
};

}  // namespace lpv
