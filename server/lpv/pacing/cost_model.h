#pragma once

#include <array>
#include <atomic>

#include "engine/stage.h"

namespace lpv {

/// What a unit of each stage takes on a device, in seconds: before anything was measured what was seen on a machine of
/// its kind, then more and more what is measured. Sizes a session's first pieces and predicts whole ticks. Units are
/// those of kStageTable. One thread learns, any thread asks.
class CostModel {
 public:
  explicit CostModel(bool software = true);

  void learn(Stage stage, double seconds, double units);
  double secondsPerUnit(Stage stage) const { return secondsPerUnit_[std::size_t(stage)]; }

 private:
  std::array<std::atomic<double>, kStages> secondsPerUnit_;
};

}  // namespace lpv
