#pragma once
// A context on the device that was asked for.

#include "engine/device_choice.h"
#include "gpu/context.h"

namespace lpv {

/// The first device that works, in order of preference; UNAVAILABLE with the reasons of all that do not.
Expected<gpu::Context> openFirst(const DeviceChoice& choice);

}  // namespace lpv
