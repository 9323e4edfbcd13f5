#include "lpv/resources/incident_textures.h"

#include "gpu/gl.h"

namespace lpv {

IncidentTextures::IncidentTextures(const glm::ivec3& d, int c, int g, bool near) : dims(d), channels(c), groups(g) {
  const glm::ivec3 size(dims.x, dims.y, dims.z * groups);
  const std::size_t count = channels == 1 ? 1 : 3;
  for (std::size_t i = 0; i < count; ++i)
    colours[i] = gpu::Texture::make3d("incident radiance", size, GL_RGBA32F, gpu::Sampling::kLinearClamp);
  if (near) emitterDistance = gpu::Texture::make3d("emitterDistance", dims, GL_R32F, gpu::Sampling::kLinearClamp);
}

}  // namespace lpv
