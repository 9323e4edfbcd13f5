#include "lpv/resources/light_field.h"

#include "shaders/layout.h"

namespace lpv {

namespace {

std::size_t haloCells(const glm::ivec3& dims) {
  return std::size_t(dims.x + 2) * std::size_t(dims.y + 2) * std::size_t(dims.z + 2);
}

}  // namespace

FieldBuffer::FieldBuffer(const std::string& label, const glm::ivec3& dims, int channels)
    : buffer(label, haloCells(dims) * std::size_t(channels) * sizeof(glm::vec4), gpu::BufferUse::kDevice,
             gpu::Undefined{}),
      texels(label, buffer) {}

LightField::LightField(const Grid& g, int c, int n, Transport t, int b, int a)
    : grid(g),
      guard(b),
      channels(c),
      groups(n),
      apart(a),
      counters("counters", sizeof(layout::Counters), gpu::BufferUse::kDynamic),
      transport(t) {
  pingPong[0] = FieldBuffer("field, even steps", grid.dims, allChannels());
  if (transport != Transport::kPropagate) {
    emitterDistance =
        gpu::Buffer("nearest VPL", grid.cells() * sizeof(float), gpu::BufferUse::kDevice, gpu::Undefined{});
    return;
  }
  pingPong[1] = FieldBuffer("field, odd steps", grid.dims, allChannels());
  lobeCounts = gpu::Buffer("lobe counts", grid.cells() * std::size_t(groups) * sizeof(float), gpu::BufferUse::kDevice,
                           gpu::Undefined{});
  makeInjected();
}

void LightField::resetCounters() { counters.update(0, gpu::bytesOfValue(layout::Counters{})); }

void LightField::makeInjected() {
  if (!injected.buffer) injected = FieldBuffer("injected field", grid.dims, allChannels());
}

void LightField::makeTextures() {
  if (!textures) textures.emplace(grid.dims, channels, lookedUpGroups(), transport == Transport::kGather);
}

void LightField::makeIncidentVolume() {
  if (incidentVolume) return;
  const std::size_t floats = grid.cells() * std::size_t(groups) * layout::kVolumeFloats;
  incidentVolume = gpu::Buffer("incident volume", floats * sizeof(float), gpu::BufferUse::kDevice, gpu::Undefined{});
}

}  // namespace lpv
