#pragma once
// The stages of a tick, in physical order.

#include <array>
#include <cstddef>

namespace lpv {

enum class Stage { kUpload, kVoxelize, kInject, kPropagate, kGather, kVolume, kGbuffer, kEmitters, kShade, kReadback };
inline constexpr std::size_t kStages = 10;

/// As TickReport names them.
inline constexpr std::array<const char*, kStages> kStageNames = {
    "upload", "voxelize", "inject", "propagate", "gather", "volume", "gbuffer", "emitters", "shade", "readback"};

}  // namespace lpv
