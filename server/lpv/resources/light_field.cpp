#include "lpv/resources/light_field.h"

#include "lpv/pacing/chunked.h"
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

LightField::LightField(const Grid& g, int c, int n, Transport t)
    : grid(g),
      channels(c),
      groups(n),
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

GpuTask LightField::clear() {
  if (cleared) co_return;
  co_await fillChunked(injected.buffer);
  co_await fillChunked(lobeCounts);
  cleared = true;
}

void LightField::makeInjected() {
  if (!injected.buffer) injected = FieldBuffer("injected field", grid.dims, allChannels());
}

}  // namespace lpv
