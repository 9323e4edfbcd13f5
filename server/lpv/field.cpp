#include "lpv/field.h"

#include "shaders/layout.h"

namespace lpv {

namespace {

std::size_t haloCells(const glm::ivec3& dims) {
  return std::size_t(dims.x + 2) * std::size_t(dims.y + 2) * std::size_t(dims.z + 2);
}

gpu::Buffer cellList(const std::string& label, std::size_t capacity) {
  return {label, (std::size_t(layout::kListHeaderWords) + capacity) * sizeof(std::uint32_t), gpu::BufferUse::kDynamic};
}

}  // namespace

FieldBuffer::FieldBuffer(const std::string& label, const glm::ivec3& dims, int channels)
    : buffer(label, haloCells(dims) * std::size_t(channels) * sizeof(glm::vec4)), texels(label, buffer) {}

LightField::LightField(const Grid& g, int c)
    : grid(g),
      channels(c),
      accumulators("accumulators", g.cells() * std::size_t(layout::kAccumulatorWords) * sizeof(std::int32_t)),
      touched{cellList("touched cells, even", g.cells()), cellList("touched cells, odd", g.cells())},
      counters("counters", sizeof(layout::Counters), gpu::BufferUse::kDynamic),
      injected("injected field", g.dims, c),
      steps{FieldBuffer("field, even steps", g.dims, c), FieldBuffer("field, odd steps", g.dims, c)} {
  const layout::uvec4 emptyList(0, 1, 1, 0);
  for (gpu::Buffer& list : touched) list.update(0, gpu::bytesOfValue(emptyList));
}

}  // namespace lpv
