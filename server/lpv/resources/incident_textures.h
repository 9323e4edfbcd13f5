#pragma once

#include <array>
#include <glm/glm.hpp>

#include "gpu/texture.h"

namespace lpv {

/// SH of incident radiance at cell centres, to be read with trilinear filtering at gridPosition / dims.
struct IncidentTextures {
  IncidentTextures(const glm::ivec3& dims, int channels, int groups = 1, bool near = false);
  glm::ivec3 dims;
  int channels;
  int groups;  ///< one behind the other along z, dims.z texels each
  /// RGBA32F (L00, L1-1, L10, L11). One channel: colours[0] of unit palette radiance. Else one per colour.
  std::array<gpu::Texture, 3> colours;
  gpu::Texture emitterDistance;  ///< R32F: cells from a cell's centre to the nearest VPL; GATHER only
};

}  // namespace lpv
