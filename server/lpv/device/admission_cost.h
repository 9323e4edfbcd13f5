#pragma once
// What a tick is predicted to take: a session's work in the units of the stages, times what a unit takes on the device.

#include "engine/engine.h"
#include "lpv/pacing/cost_model.h"

namespace lpv {

Prediction predict(const CostModel& costs, const Workload& workload);

}  // namespace lpv
