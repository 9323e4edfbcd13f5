#pragma once
// The stages of a tick.

#include <array>
#include <cstddef>

namespace lpv {

/// In physical order; kStageTable has a row for each.
enum class Stage {
  kUpload,
  kVoxelize,
  kInject,
  kPropagate,
  kVisibility,
  kGather,
  kReflect,
  kVolume,
  kGbuffer,
  kEmitters,
  kShade,
  kReadback
};
inline constexpr std::size_t kStages = std::size_t(Stage::kReadback) + 1;

struct StageRow {
  Stage stage;
  const char* name;               ///< in reports, metrics and the protocol
  double
      softwareSecondsPerUnit;  ///< on llvmpipe with two cores (tests/bench/fairness_bench), while nothing is measured
};

/// The unit of a stage stands behind its row; how many units its work has is said beside the stage.
inline constexpr std::array<StageRow, kStages> kStageTable = {{
    {Stage::kUpload, "upload", 5e-10},  // byte
    {Stage::kVoxelize, "voxelize", 6e-7},  // small triangle
    {Stage::kInject, "inject", 1e-7},  // cell of a light
    {Stage::kPropagate, "propagate", 1.2e-8},  // cell, channel and iteration
    {Stage::kVisibility, "visibility", 1e-6},  // ray from a cell to a light
    {Stage::kGather, "gather", 2.5e-8},  // entry of a tree that a block of cells visits
    {Stage::kReflect, "reflect", 1e-8},  // pair of patches and bounce
    {Stage::kVolume, "volume", 2e-8},  // cell and group of lights
    {Stage::kGbuffer, "gbuffer", 3e-8},  // pixel
    {Stage::kEmitters, "emitters", 3e-8},  // pixel
    {Stage::kShade, "shade", 1e-7},  // pixel
    {Stage::kReadback, "readback", 6e-9},  // pixel
}};

constexpr bool rowsAreInOrder() {
  for (std::size_t i = 0; i < kStages; ++i) {
    if (kStageTable[i].stage != Stage(i)) return false;
  }
  return true;
}
static_assert(rowsAreInOrder());

constexpr const char* nameOf(Stage stage) { return kStageTable[std::size_t(stage)].name; }

}  // namespace lpv
