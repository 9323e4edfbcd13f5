#include "lpv/pacing/cost_model.h"

namespace lpv {
namespace {

/// A graphics card is assumed to be so much faster while nothing was measured: too little only makes first pieces
/// small.
constexpr double kHardwareIsFaster = 20.0;
/// Work that counts as much as everything known before it, seconds: one odd piece changes little.
constexpr double kMemory = 0.25;

}  // namespace

CostModel::CostModel(bool software) {
  for (std::size_t i = 0; i < kStages; ++i)
    secondsPerUnit_[i] = kStageTable[i].softwareSecondsPerUnit / (software ? 1.0 : kHardwareIsFaster);
}

void CostModel::learn(Stage stage, double seconds, double units) {
  if (units <= 0.0 || seconds <= 0.0) return;
  std::atomic<double>& rate = secondsPerUnit_[std::size_t(stage)];
  rate = rate + seconds / (seconds + kMemory) * (seconds / units - rate);
}

}  // namespace lpv
