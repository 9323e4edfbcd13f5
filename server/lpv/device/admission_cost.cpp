#include "lpv/device/admission_cost.h"

#include "lpv/pipeline.h"

namespace lpv {

Prediction predict(const CostModel& costs, const Workload& workload) {
  const std::array<double, kStages> units = unitsOf(workload);
  Prediction out;
  double most = -1.0;
  for (std::size_t i = 0; i < kStages; ++i) {
    const double seconds = units[i] * costs.secondsPerUnit(Stage(i));
    out.seconds += seconds;
    if (seconds <= most) continue;
    most = seconds;
    out.mostly = Stage(i);
  }
  return out;
}

}  // namespace lpv
