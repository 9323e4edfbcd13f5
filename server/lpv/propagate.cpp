#include "lpv/propagate.h"

#include <algorithm>

#include "gpu/gl.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

int groupsOf(int cells, int perGroup) { return (cells + perGroup - 1) / perGroup; }

double cellsOf(const CellBox& box) {
  const glm::ivec3 size = box.upper - box.lower;
  return double(size.x) * double(size.y) * double(size.z);
}

void copy(const FieldBuffer& from, const FieldBuffer& to) {
  glCopyNamedBufferSubData(from.buffer.id(), to.buffer.id(), 0, 0, GLsizeiptr(from.buffer.size()));
}

/// Both forms read cells that were never written this tick as zero.
void prepare(LightField& field, bool clampFaces) {
  field.clamped = clampFaces;
  for (FieldBuffer& step : field.steps) step.buffer.clear();
  if (!clampFaces) return;
  if (!field.sum) field.sum.emplace("field, sum", field.grid.dims, field.allChannels());
  copy(field.injected, *field.sum);
}

}  // namespace

Propagator::Propagator() : params_("propagate params", sizeof(layout::PropagateParams), gpu::BufferUse::kDynamic) {}

void Propagator::step(LightField& field, const CellBox& box, int iteration, bool clampFaces) {
  const FieldBuffer& from = iteration == 1 ? field.injected : field.steps[std::size_t(field.result)];
  field.result = 1 - field.result;
  const glm::ivec3 size = box.upper - box.lower;
  const int groupsY = groupsOf(size.y, layout::kFieldGroupY);
  params_.update(0, gpu::bytesOfValue(layout::PropagateParams{glm::ivec4(field.grid.dims, 0), glm::ivec4(box.lower, 0),
                                                              glm::ivec4(box.upper, groupsY)}));
  params_.bindUniform(layout::kParams);
  from.texels.bind(layout::kFieldIn);
  field.injected.texels.bind(layout::kFieldSource);
  field.steps[std::size_t(field.result)].buffer.bindStorage(layout::kFieldOut);
  if (clampFaces) field.sum->buffer.bindStorage(layout::kFieldSum);
  programs_.get({{"LPV_CHANNELS", std::to_string(field.channels)}, {"LPV_CLAMP_FACES", clampFaces ? "1" : "0"}})
      .dispatch(std::uint32_t(groupsOf(size.x, layout::kFieldGroupX)), std::uint32_t(groupsY * field.allChannels()),
                std::uint32_t(groupsOf(size.z, layout::kFieldMarch)));
  gpu::memoryBarrier();
}

Pieces Propagator::run(LightField& field, CellBox box, int iterations, bool clampFaces, Pacing pacing) {
  prepare(field, clampFaces);
  double queued = 0.0;  // cells x channels since the last pause
  for (int i = 1; i <= iterations && !box.empty(); ++i) {
    box = box.grown(field.grid.dims);
    const double cells = cellsOf(box) * field.allChannels();
    if (queued > 0.0 && queued + cells > pacing.unitsFor(Stage::kPropagate, 65536.0)) {
      co_yield piece(Stage::kPropagate, queued);
      queued = 0.0;
    }
    step(field, box, i, clampFaces);
    queued += cells;
  }
  co_yield piece(Stage::kPropagate, queued);
}

}  // namespace lpv
