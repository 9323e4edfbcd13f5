#pragma once
// The lights as receivers look at them without a grid (MATHS.md 3c): on the GPU for frames, and for the CPU's probes.

#include <vector>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "lpv/cached.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/light_voxels.h"
#include "lpv/resources/lights.h"

namespace lpv {

/// A light of constant radiance without directions is looked at as polygons, which is exact, while it has no more
/// triangles than this, its flat patches merged; other lights are their trees. The near field of GATHER, and DIRECT
/// with a rule below kAccurateOpeningRatio, where time counts;
inline constexpr std::size_t kFewPolygons = 32;
/// DIRECT with kAccurateOpeningRatio or above: 720 triangles cost a receiver 2-3x the walk through their tree.
inline constexpr std::size_t kMostPolygons = 1024;
/// All lights together, smallest first: a thread's loops have an end on llvmpipe (kMaxRounds).
inline constexpr std::size_t kMostPolygonsOfAll = 4096;

/// Which lights are polygons. `k`: the distance rule of the trees.
void choosePolygons(std::vector<EmittingLight>& lights, Transport transport, double k);

/// What the list is made from.
struct EmitterListInputs {
  Stamp lights = 0;           ///< and with them their trees
  double openingRatio = 0.0;  ///< k; which lights are polygons follows from both

  bool operator==(const EmitterListInputs&) const = default;
};

struct EmitterBufferList {
  gpu::Buffer texels;  ///< as shaders/transport/emitter_list.glsl has them
  gpu::BufferTexture view;
  std::size_t count = 0;

  /// `k`: the distance rule of the trees.
  void make(const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels, double k);
};

}  // namespace lpv
