#pragma once
// What a tick is predicted to take: a session's work in the units of the stages, times what a unit takes on the device.

#include <array>

#include "engine/engine.h"
#include "lpv/pacing/cost_model.h"

namespace lpv {

/// Units of every stage, as pieces count them: upload: bytes; voxelize: small triangles; inject: cells of lights;
/// propagate: cells x channels; gather: entries that blocks of cells visit; volume: cells; gbuffer, emitters, shade,
/// readback: pixels.
std::array<double, kStages> unitsOf(const Workload& workload);
Prediction predict(const CostModel& costs, const Workload& workload);

}  // namespace lpv
