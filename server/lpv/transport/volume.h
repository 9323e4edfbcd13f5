#pragma once
// Stage: the volume (MATHS.md 1, 3a), for frames as textures and for clients as a buffer.

#include "gpu/program.h"
#include "lpv/cached.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/palette.h"

namespace lpv {

/// What can be made of a field.
enum class VolumeTarget {
  kTextures,     ///< LightField::textures
  kTransported,  ///< as it is read back
  kInjected,     ///< as it is read back
};

/// What textures and volumes that leave the engine are made from.
struct VolumeInputs {
  Stamp transported = 0;  ///< with it grid, palette and groups
  Stamp emitters = 0;     ///< the list that goes along; textures: none
  bool guarded = false;   ///< guard cells go along; textures: whatever the field has
  Stamp reflected = 0;    ///< what surfaces send, which goes along; textures: none

  bool operator==(const VolumeInputs&) const = default;
};

/// Work of the stage: the same for pieces and for admission, which counts one volume.
struct VolumeWork {
  double cells = 0.0;
  double groups = 0.0;

  double units() const { return cells * groups; }
};

class VolumeMaker {
 public:
  VolumeMaker();

  /// Slab by slab, out of `from`: into field.textures, or for the other targets into field.incidentVolume.
  GpuTask run(LightField& field, const FieldBuffer& from, const Palette& palette, VolumeTarget target, Pacing pacing);

 private:
  struct Variant {
    int channels = 1;
    VolumeTarget target = VolumeTarget::kTextures;
    bool emitterDistance = false;
    bool operator==(const Variant&) const = default;
    gpu::Defines defines() const;
  };
  gpu::Programs<Variant> programs_{{"transport/volume.comp"}};
  gpu::Buffer params_;
};

}  // namespace lpv
