// What a tick of a document costs the device, as far as it is known before one runs.

#include <cstdio>

#include "scene/error_goal.h"
#include "session/document/document.h"

namespace lpv {

Status checkTickSeconds(const Prediction& tick, const Limits& limits) {
  if (tick.seconds <= limits.maxTickSeconds) return {};
  char text[256];
  std::snprintf(text, sizeof text,
                "max_tick_seconds: on this device a tick of the session is predicted to take %.1f s, most of it to %s; "
                "allowed are %g s; use a coarser grid, fewer iterations, smaller lights or fewer light groups",
                tick.seconds, nameOf(tick.mostly), limits.maxTickSeconds);
  return exhausted(Reason::kMaxTickSeconds, "max_tick_seconds", text);
}

void Document::predictWith(std::function<Prediction(const Workload&)> predict) {
  predict_ = std::move(predict);
  admittedWorkload_ = workload(options_, grid_);
}

Workload Document::workload(const LightingSettings& options, const Grid& grid) const {
  Workload out(resolved(options), grid);
  for (const auto& [name, light] : lights_) out.add(*light.object);
  for (const auto& [name, surface] : surfaces_) out.add(*surface.object);
  return out;
}

/// A change that makes nothing dearer is accepted: what was admitted once, when the device seemed faster, can be
/// edited.
Status Document::checkCost(const LightingSettings& options, const Grid& grid) {
  if (!predict_) return {};
  Workload after = workload(options, grid);
  if (Status s = checkTickSeconds(predict_(after), limits_); !s.ok()) {
    if (predict_(after).seconds > predict_(admittedWorkload_).seconds) return s;
  }
  admittedWorkload_ = std::move(after);
  return {};
}

/// Whether every object that the edit replaced asks for as much work as before, as one that was moved does: then the
/// whole does too, and need not be added up again.
bool Document::sameWorkload(const Rollback& rollback) const {
  if (!(rollback.grid == grid_)) return false;
  const LightingSettings options = resolved(options_);
  bool same = true;
  const auto compare = [&](const auto& objects, const auto& before) {
    for (const auto& [name, was] : before) {
      const auto now = objects.find(name);
      if (!was || now == objects.end()) {
        same = false;
        return;
      }
      Workload then(options, grid_), after(options, grid_);
      then.add(*was->object);
      after.add(*now->second.object);
      same = same && then == after;
    }
  };
  compare(lights_, rollback.lights);
  compare(surfaces_, rollback.surfaces);
  return same;
}

}  // namespace lpv
