#pragma once

#include "api/results/delta_chain.h"
#include "api/results/parts.h"

namespace lpv::api {

/// The encodings that calls of one server share. Thread-safe, as its members are.
struct ResultCaches {
  VolumeChains chains;        ///< of live volume subscriptions
  VolumeEncodings encodings;  ///< of calls for one volume
  FrameEncodings frames;      ///< of subscriptions that show the same
};

}  // namespace lpv::api
