#pragma once

#include <chrono>
#include <string>

#include "lpv/engine.h"
#include "session/registry.h"

namespace lpv::api {

/// What every call can reach. Outlives the doors.
struct Context {
  Registry* registry = nullptr;
  WorkerPool* pool = nullptr;
  Timers* timers = nullptr;
  Counters* counters = nullptr;
  Limits limits;
  DeviceInfo device;
  std::string version;
  std::chrono::system_clock::time_point started;
};

}  // namespace lpv::api
