#pragma once
// The lights as receivers look at them without a grid (MATHS.md 3c): on the GPU for frames, and for the CPU's probes.

#include <vector>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "lpv/cached.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/light_voxels.h"
#include "lpv/resources/lights.h"
#include "scene/emitter_list.h"

namespace lpv {

/// Which lights are polygons. `k`: the distance rule of the trees.
void choosePolygons(std::vector<EmittingLight>& lights, Transport transport, double k);

/// What the list is made from.
struct EmitterListInputs {
  Stamp lights = 0;  ///< and with them their trees
  double openingRatio = 0.0;  ///< k; which lights are polygons follows from both

  bool operator==(const EmitterListInputs&) const = default;
};

struct EmitterBufferList {
  gpu::Buffer texels;  ///< as shaders/transport/emitter_list.glsl has them
  gpu::BufferTexture view;
  std::size_t count = 0;
  bool everywhere = false;  ///< lookedAtEverywhere

  /// `k`: the distance rule of the trees.
  void make(const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels, double k);
};

}  // namespace lpv
