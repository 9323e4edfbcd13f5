#include "lpv/transport/volume.h"

#include <algorithm>
#include <cmath>

#include "gpu/gl.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

layout::VolumeParams paramsOf(const LightField& field, const Palette& palette) {
  layout::VolumeParams params{};
  for (std::size_t k = 0; k < layout::kColours; ++k) params.palette[k] = glm::vec4(palette.radiance[k], 0.0);
  const double factor = 1.0 / (1.5 * field.grid.cell * field.grid.cell);
  const bool flux = field.transport == Transport::kPropagate;
  params.band0Factor = flux ? float(factor) : 1.0F;
  params.band1Factor = flux ? float(-factor) : 1.0F;
  return params;
}

void bindOutputs(const LightField& field, VolumeTarget target) {
  if (target != VolumeTarget::kTextures) {
    field.incidentVolume.bindStorage(layout::kIncidentVolume);
    return;
  }
  const IncidentTextures& textures = *field.textures;
  const int count = textures.channels == 1 ? 1 : 3;
  for (int i = 0; i < count; ++i)
    textures.colours[std::size_t(i)].bindImage(std::uint32_t(layout::kIncidentOut + i), GL_WRITE_ONLY);
  if (textures.emitterDistance) textures.emitterDistance.bindImage(layout::kEmitterDistanceOut, GL_WRITE_ONLY);
}

std::uint32_t groups(int cells, int perGroup) { return std::uint32_t((cells + perGroup - 1) / perGroup); }

}  // namespace

gpu::Defines VolumeMaker::Variant::defines() const {
  const bool toTextures = target == VolumeTarget::kTextures;
  return {gpu::define("LPV_CHANNELS", channels), gpu::define("LPV_TEXTURES", toTextures),
          gpu::define("LPV_BUFFER", !toTextures), gpu::define("LPV_INJECTED", target == VolumeTarget::kInjected),
          gpu::define("LPV_EMITTER_DISTANCE", emitterDistance)};
}

VolumeMaker::VolumeMaker() : params_("volume params", sizeof(layout::VolumeParams), gpu::BufferUse::kDynamic) {}

GpuTask VolumeMaker::run(LightField& field, const FieldBuffer& from, const Palette& palette, VolumeTarget target,
                         Pacing pacing) {
  const glm::ivec3 dims = field.grid.dims;
  layout::VolumeParams params = paramsOf(field, palette);
  const bool toTextures = target == VolumeTarget::kTextures;
  if (toTextures) {
    field.makeTextures();
  } else {
    field.makeIncidentVolume();
  }
  const bool near = toTextures && bool(field.textures->emitterDistance);
  gpu::Program& program = programs_.get({.channels = field.channels, .target = target, .emitterDistance = near});
  const double slabCells = double(dims.x) * double(dims.y);
  const int groupsWanted = toTextures ? field.lookedUpGroups() : field.groups;
  for (int slab = 0; slab < dims.z * groupsWanted;) {
    const int group = slab / dims.z, z = slab % dims.z;
    const int slabs = std::clamp(int(pacing.unitsFor(Stage::kVolume) / slabCells), 1, dims.z - z);
    params.dims = dims;
    params.firstSlice = z;
    params.group = group;
    params.firstChannel = group * field.channels;
    params_.update(0, gpu::bytesOfValue(params));
    params_.bindUniform(layout::kParams);
    from.texels.bind(layout::kFieldIn);
    field.counters.bindStorage(layout::kCounters);
    bindOutputs(field, target);
    if (near) field.emitterDistance.bindStorage(layout::kEmitterDistanceBuffer);
    program.dispatch(groups(dims.x, layout::kFieldGroupX), groups(dims.y, layout::kFieldGroupY), std::uint32_t(slabs));
    gpu::memoryBarrier();
    slab += slabs;
    co_yield submitted(Stage::kVolume, VolumeWork{slabCells * slabs, 1.0}.units());
  }
}

}  // namespace lpv
