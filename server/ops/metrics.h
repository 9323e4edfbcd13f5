#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "engine/engine.h"
#include "session/answer_room.h"
#include "session/counters.h"
#include "session/damaged_sessions.h"
#include "session/registry.h"

namespace lpv::ops {

/// Sources of the metrics.
struct MetricSources {
  const Counters* counters = nullptr;
  const AnswerRoom* answers = nullptr;
  const DamagedSessions* damaged = nullptr;
  const Registry* registry = nullptr;
  const Journal* journal = nullptr;
  std::function<std::int64_t()> storeQueue;  ///< changes waiting to be committed
  const Engine* engine = nullptr;
  DeviceInfo device;
  std::string version;
  std::chrono::system_clock::time_point started;
};

/// Renders all metrics in Prometheus' text format 0.0.4; deploy/METRICS.md says what each means. Labels never contain a
/// session or client. Locks each session for microseconds.
std::string renderMetrics(const MetricSources& sources);

}  // namespace lpv::ops
