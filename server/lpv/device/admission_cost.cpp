#include "lpv/device/admission_cost.h"

#include "shaders/layout.h"

namespace lpv {

std::array<double, kStages> unitsOf(const Workload& w) {
  const double fieldCells = w.cells * w.groups() * w.channels();
  const double blocks = w.cells / double(layout::kBlockX * layout::kBlockY * layout::kBlockZ);
  std::array<double, kStages> units{};
  const auto of = [&units](Stage stage) -> double& { return units[std::size_t(stage)]; };
  of(Stage::kUpload) = w.bytes;
  of(Stage::kVoxelize) = w.lightTriangles + 0.5 * w.columns;
  if (w.transport == Transport::kPropagate) {
    of(Stage::kInject) = 1000.0 * w.lights + w.litCells;
    of(Stage::kPropagate) = w.iterations * fieldCells;
  } else {
    of(Stage::kGather) = blocks * (16.0 * w.lights + 8.0 * w.rootsOfEntries);
  }
  of(Stage::kVolume) = w.cells * w.groups();
  return units;
}

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
