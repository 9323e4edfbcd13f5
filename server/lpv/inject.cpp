#include "lpv/inject.h"

#include <cmath>

#include "shaders/layout.h"

namespace lpv {

Injector::Injector() : params_("inject params", sizeof(layout::InjectParams), gpu::BufferUse::kDynamic) {}

void Injector::dispatch(LightField& field, const gpu::Buffer& cells, bool retire) {
  cells.bindStorage(layout::kTouchedCells);
  cells.bindAsDispatchArguments();
  programs_.get({{"LPV_CHANNELS", std::to_string(field.channels)}, {"LPV_RETIRE", retire ? "1" : "0"}})
      .dispatchIndirect(0);
  gpu::memoryBarrier();
}

Pieces Injector::run(LightField& field, int shift) {
  layout::InjectParams params{};
  params.dims = glm::ivec4(field.grid.dims, 0);
  params.scale.x = float(std::ldexp(field.grid.cell * field.grid.cell, -shift));
  params_.update(0, gpu::bytesOfValue(params));
  params_.bindUniform(layout::kParams);
  field.accumulators.bindStorage(layout::kAccumulators);
  field.injected.buffer.bindStorage(layout::kFieldOut);
  dispatch(field, field.touched[std::size_t(1 - field.current)], true);
  dispatch(field, field.touched[std::size_t(field.current)], false);
  co_yield piece(Stage::kInject);
}

}  // namespace lpv
