#include "lpv/field.h"

#include "shaders/layout.h"

namespace lpv {

namespace {

std::size_t haloCells(const glm::ivec3& dims) {
  return std::size_t(dims.x + 2) * std::size_t(dims.y + 2) * std::size_t(dims.z + 2);
}

}  // namespace

FieldBuffer::FieldBuffer(const std::string& label, const glm::ivec3& dims, int channels)
    : buffer(label, haloCells(dims) * std::size_t(channels) * sizeof(glm::vec4)), texels(label, buffer) {}

LightField::LightField(const Grid& g, int c)
    : grid(g),
      channels(c),
      lobeCounts("lobe counts", g.cells() * sizeof(float)),
      counters("counters", sizeof(layout::Counters), gpu::BufferUse::kDynamic),
      injected("injected field", g.dims, c),
      steps{FieldBuffer("field, even steps", g.dims, c), FieldBuffer("field, odd steps", g.dims, c)} {}

}  // namespace lpv
