#pragma once
// Stage: the volume (MATHS.md 1, 3a), for frames as textures and for clients as a buffer.

#include <array>
#include <optional>

#include "gpu/program.h"
#include "gpu/texture.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/palette.h"

namespace lpv {

/// What can be made of a field.
enum class VolumeTarget {
  kTextures,  ///< IncidentTextures::colours
  kTransported,  ///< as it is read back
  kInjected,     ///< as it is read back
};

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

class VolumeMaker {
 public:
  VolumeMaker();

  /// Slab by slab. `textures` is written for kTextures, `volume` (layout::kIncidentVolume) otherwise.
  GpuTask run(const LightField& field, const Palette& palette, VolumeTarget target, const IncidentTextures* textures,
              const gpu::Buffer* volume, Pacing pacing);

 private:
  gpu::ProgramVariants programs_{{"transport/volume.comp"}};
  gpu::Buffer params_;
};

}  // namespace lpv
