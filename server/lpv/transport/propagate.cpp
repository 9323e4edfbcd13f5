#include "lpv/transport/propagate.h"

#include <algorithm>

#include "gpu/gl.h"
#include "lpv/pacing/chunked.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

int groupsOf(int cells, int perGroup) { return (cells + perGroup - 1) / perGroup; }

double cellsOf(const CellBox& box) {
  const glm::ivec3 size = box.upper - box.lower;
  return double(size.x) * double(size.y) * double(size.z);
}

GpuTask copy(const gpu::Buffer& from, const gpu::Buffer& to) {
  for (const Chunk& part : chunksOf(from.size())) {
    glCopyNamedBufferSubData(from.id(), to.id(), GLintptr(part.offset), GLintptr(part.offset), GLsizeiptr(part.bytes));
    co_yield yield();
  }
}

/// Both forms read cells that were never written this tick as zero.
GpuTask prepare(LightField& field, bool clampFaces) {
  field.clamped = clampFaces;
  for (FieldBuffer& step : field.pingPong) co_await fillChunked(step.buffer);
  if (!clampFaces) co_return;
  if (!field.sum) field.sum.emplace("field, sum", field.grid.dims, field.allChannels());
  co_await copy(field.injected.buffer, field.sum->buffer);
}

/// Layers of cells that a piece may take: whole marches of a group where there is room for one.
int layersFor(double cellsPerLayer, double room) {
  const int layers = std::max(1, int(room / cellsPerLayer + 1e-9));
  return layers < layout::kFieldMarch ? layers : layers / layout::kFieldMarch * layout::kFieldMarch;
}

}  // namespace

gpu::Defines Propagator::Variant::defines() const {
  return {gpu::define("LPV_CHANNELS", channels), gpu::define("LPV_CLAMP_FACES", clampFaces)};
}

Propagator::Propagator() : params_("propagate params", sizeof(layout::PropagateParams), gpu::BufferUse::kDynamic) {}

void Propagator::step(LightField& field, const CellBox& box, int iteration, bool clampFaces) {
  const FieldBuffer& from = iteration == 1 ? field.injected : field.pingPong[std::size_t(1 - field.result)];
  const glm::ivec3 size = box.upper - box.lower;
  const int groupsY = groupsOf(size.y, layout::kFieldGroupY);
  params_.update(0, gpu::bytesOfValue(layout::PropagateParams{
                        .dims = field.grid.dims, .lower = box.lower, .upper = box.upper, .groupsPerChannel = groupsY}));
  params_.bindUniform(layout::kParams);
  from.texels.bind(layout::kFieldIn);
  field.injected.texels.bind(layout::kFieldSource);
  field.pingPong[std::size_t(field.result)].buffer.bindStorage(layout::kFieldOut);
  if (clampFaces) field.sum->buffer.bindStorage(layout::kFieldSum);
  programs_.get({.channels = field.channels, .clampFaces = clampFaces})
      .dispatch(std::uint32_t(groupsOf(size.x, layout::kFieldGroupX)), std::uint32_t(groupsY * field.allChannels()),
                std::uint32_t(groupsOf(size.z, layout::kFieldMarch)));
  gpu::memoryBarrier();
}

GpuTask Propagator::run(LightField& field, CellBox box, int iterations, bool clampFaces, Pacing pacing) {
  co_await prepare(field, clampFaces);
  double queued = 0.0;  // units since the last pause
  for (int i = 1; i <= iterations && !box.empty(); ++i) {
    box = box.grown(field.grid.dims);
    field.result = 1 - field.result;
    const double layer = cellsOf(box) / (box.upper.z - box.lower.z);
    const double perLayer = PropagateWork{layer, double(field.allChannels())}.units();
    for (CellBox slab = box; slab.lower.z < box.upper.z; slab.lower.z = slab.upper.z) {
      const double room = pacing.unitsFor(Stage::kPropagate) - queued;
      if (queued > 0.0 && room < perLayer) {
        co_yield submitted(Stage::kPropagate, queued);
        queued = 0.0;
      }
      slab.upper.z =
          std::min(box.upper.z, slab.lower.z + layersFor(perLayer, pacing.unitsFor(Stage::kPropagate) - queued));
      step(field, slab, i, clampFaces);
      queued += perLayer * (slab.upper.z - slab.lower.z);
    }
  }
  co_yield submitted(Stage::kPropagate, queued);
}

}  // namespace lpv
