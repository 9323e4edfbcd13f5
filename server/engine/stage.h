#pragma once
// The stages of a tick, in physical order.

#include <array>
#include <cstddef>

namespace lpv {

enum class Stage { kUpload, kVoxelize, kInject, kPropagate, kGather, kVolume, kGbuffer, kEmitters, kShade, kReadback };
inline constexpr std::size_t kStages = 10;

/// As reports, metrics and the protocol name them.
inline constexpr std::array<const char*, kStages> kStageNames = {
    "upload", "voxelize", "inject", "propagate", "gather", "volume", "gbuffer", "emitters", "shade", "readback"};
constexpr const char* nameOf(Stage stage) { return kStageNames[std::size_t(stage)]; }

}  // namespace lpv
