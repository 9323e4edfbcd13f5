#pragma once
// What reflections, and rays through haze, meet of a scene, on the GPU (MATHS.md 3e, 3g): what its surfaces reflect and
// its lights send, with their pictures, coarsely. Shapes are those of shadow rays (lpv/resources/occluders.h).

#include <map>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "gpu/texture.h"
#include "lpv/cached.h"
#include "lpv/resources/light_pools.h"
#include "lpv/resources/lights.h"
#include "scene/scene.h"

namespace lpv {

/// Boxes of a picture along an edge, at most.
inline constexpr int kMostReflectedBoxes = 256;

class GlossScene {
 public:
  /// Makes what differs from the last scene. `pooled`: of `pools`, which are those of `lights`. `surfaces`: that rays
  /// ask what they reflect; else lights alone are here.
  void update(const Scene& scene, bool surfaces, const std::vector<EmittingLight>& lights, const LightPools& pools,
              Stamp pooled);
  void bind() const;

 private:
  struct Inputs {
    std::vector<SurfacePtr> surfaces;
    Stamp pooled = 0;

    bool operator==(const Inputs&) const = default;
  };
  using Packed = std::vector<std::uint32_t>;
  const Packed& pictureOf(const TexturePtr& texture);

  gpu::Buffer texels_;  ///< as shaders/frame/gloss_scene.glsl has them
  gpu::BufferTexture view_;
  gpu::Texture shares_;  ///< RG32F: scene/gloss.h's table
  std::map<TexturePtr, Packed> pictures_;  ///< of textures in use
  Cached<Inputs> made_;
};

}  // namespace lpv
