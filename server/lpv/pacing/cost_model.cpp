#include "lpv/pacing/cost_model.h"

namespace lpv {
namespace {

/// Seconds per unit, seen on llvmpipe with two cores by tests/bench/fairness_bench; in the order of Stage.
constexpr std::array<double, kStages> kOnSoftware = {5e-10, 6e-7, 1e-7, 1.2e-8, 2.5e-8, 2e-8, 3e-8, 3e-8, 1e-7, 6e-9};
/// A graphics card is assumed to be so much faster while nothing was measured: too little only makes first pieces
/// small.
constexpr double kHardwareIsFaster = 20.0;
/// Work that counts as much as everything known before it, seconds: one odd piece changes little.
constexpr double kMemory = 0.25;

}  // namespace

CostModel::CostModel(bool software) {
  for (std::size_t i = 0; i < kStages; ++i)
    secondsPerUnit_[i] = software ? kOnSoftware[i] : kOnSoftware[i] / kHardwareIsFaster;
}

void CostModel::learn(Stage stage, double seconds, double units) {
  if (units <= 0.0 || seconds <= 0.0) return;
  std::atomic<double>& rate = secondsPerUnit_[std::size_t(stage)];
  rate = rate + seconds / (seconds + kMemory) * (seconds / units - rate);
}

}  // namespace lpv
