#pragma once
// The lights as receivers look at them without a grid (MATHS.md 3c): on the GPU for frames, and for the CPU's probes.

#include <map>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "lpv/cached.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/light_voxels.h"
#include "lpv/resources/lights.h"
#include "scene/emitter_list.h"
#include "scene/emitter_tree.h"

namespace lpv {

/// Which lights receivers look at as triangles, and how. `k`: the distance rule of the trees.
void chooseTriangles(std::vector<EmittingLight>& lights, Transport transport, double k);

/// What the list is made from.
struct EmitterListInputs {
  Stamp lights = 0;  ///< and with them their trees
  double openingRatio = 0.0;  ///< k; which lights are polygons follows from both
  bool everywhere = false;    ///< receivers look at nothing else

  bool operator==(const EmitterListInputs&) const = default;
};

struct EmitterBufferList {
  gpu::Buffer texels;  ///< as shaders/transport/emitter_list.glsl has them
  gpu::BufferTexture view;
  std::size_t count = 0;
  bool everywhere = false;  ///< receivers look at all of it
  std::size_t lookedAt = 0;  ///< else, at some lights' shares, wherever they are

  GpuTask make(const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels,
               const EmitterListInputs& inputs);

 private:
  /// One light's texels: some of its own, then a buffer's.
  struct Part {
    std::vector<glm::vec4> before;
    const gpu::Buffer* from = nullptr;
    EmitterTreePtr tree;  ///< where that is a tree's
    std::size_t texels = 0;
    std::size_t entries = 0;
    int texelsOfEntry = 0;
  };
  Part partOf(const PlacedEmitterTree& placed) const;
  Part partOf(const LightVoxels& voxels) const;
  void fill(const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels,
            const std::vector<PlacedEmitterTree>& placed, double k);
  void makeRoom();
  void put(const std::vector<Part>& parts, std::size_t at);
  void keepTrees(const std::vector<PlacedEmitterTree>& placed);

  std::map<EmitterTreePtr, gpu::Buffer> trees_;  ///< of the lights that are there
  std::map<std::size_t, EmitterTreePtr>
      lying_;  ///< by first texel: trees that stay there while nothing before them changes
};

}  // namespace lpv
