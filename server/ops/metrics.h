#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "engine/engine.h"
#include "session/counters.h"
#include "session/registry.h"

namespace lpv::ops {

/// Where metrics come from.
struct MetricSources {
  const Counters* counters = nullptr;
  const Registry* registry = nullptr;
  const Journal* journal = nullptr;
  std::function<std::int64_t()> storeQueue;  ///< changes that wait for the disk
  const Engine* engine = nullptr;
  DeviceInfo device;
  std::string version;
  std::chrono::system_clock::time_point started;
};

/// All metrics in Prometheus' text format 0.0.4; deploy/METRICS.md says what each means. No session or client is named
/// in a label. Takes each session's lock for microseconds.
std::string renderMetrics(const MetricSources& sources);

}  // namespace lpv::ops
