#include "lpv/pacing/cost_model.h"

namespace lpv {
namespace {

/// A graphics card is assumed to be so much faster while nothing was measured: too little only makes first pieces
/// small.
constexpr double kHardwareIsFaster = 20.0;
/// What was known counts as so much work, seconds: one odd piece changes little. Half a second for a few units, as a
/// thread that was not scheduled or a program that had to be compiled takes, makes it three times as much.
constexpr double kMemory = 0.25;

}  // namespace

CostModel::CostModel(bool software) {
  for (std::size_t i = 0; i < kStages; ++i)
    secondsPerUnit_[i] = kStageTable[i].softwareSecondsPerUnit / (software ? 1.0 : kHardwareIsFaster);
}

void CostModel::learn(Stage stage, double seconds, double units) {
  if (units <= 0.0 || seconds <= 0.0) return;
  std::atomic<double>& rate = secondsPerUnit_[std::size_t(stage)];
  rate = (kMemory + seconds) / (kMemory / rate + units);
}

}  // namespace lpv
