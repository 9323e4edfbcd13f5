#include "scene/options.h"

#include <algorithm>
#include <cmath>

#include "scene/error_goal.h"

namespace lpv {
namespace {

Status checkRange(const char* field, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  return invalid(field, std::string(field) + " is " + std::to_string(value) + ", allowed are " + std::to_string(low) +
                            " to " + std::to_string(high));
}

Status checkRanges(const LightingSettings& o) {
  if (o.iterations < 0 || o.iterations > kMaxIterations) {
    return invalid("iterations", "iterations is " + std::to_string(o.iterations) + ", allowed are 0 (automatic) to " +
                                     std::to_string(kMaxIterations));
  }
  if (o.k != 0.0) {
    if (Status s = checkRange("k", o.k, 1.0, 64.0); !s.ok()) return s;
  }
  if (o.maxError != 0.0) {
    if (Status s = checkRange("max_error", o.maxError, 1e-4, 1.0); !s.ok()) return s;
  }
  if (o.bounces < kAutoBounces || o.bounces > kMaxBounces) {
    return invalid("bounces", "bounces is " + std::to_string(o.bounces) + ", allowed are 0 to " +
                                  std::to_string(kMaxBounces) + ", or -1 for as many as the wanted error asks for");
  }
  if (o.method == InjectionMethod::kDense && (o.denseSamples < 1 || o.denseSamples > 100000)) {
    return invalid("dense_samples", "dense_samples is " + std::to_string(o.denseSamples) + ", allowed are 1 to 100000");
  }
  if (Status s = checkRange("haze", o.haze, 0.0, kMaxHaze); !s.ok()) return s;
  if (Status s = checkRange("haze_absorption", o.hazeAbsorption, 0.0, 1.0); !s.ok()) return s;
  return checkRange("haze_anisotropy", o.hazeAnisotropy, -kMaxHazeAnisotropy, kMaxHazeAnisotropy);
}

Status checkTogether(const LightingSettings& o) {
  const bool propagates = o.transport == Transport::kPropagate;
  if (o.bounces != 0 && propagates) {
    return invalid("bounces", "bounces is " + std::to_string(o.bounces) +
                                  ", but transport PROPAGATE reflects nothing: choose GATHER or DIRECT, or bounces 0");
  }
  if (o.visibility == Visibility::kOn && propagates) {
    return invalid("visibility",
                   "visibility is ON, but transport PROPAGATE has no shadows: choose GATHER or DIRECT, or AUTO or OFF");
  }
  if (o.gloss == Gloss::kOn && propagates) {
    return invalid("gloss", "gloss is ON, but transport PROPAGATE has no reflections: choose GATHER or DIRECT, or OFF");
  }
  if (o.haze != 0.0 && propagates) {
    return invalid("haze", "haze is " + std::to_string(o.haze) +
                               ", but transport PROPAGATE has none: choose GATHER or DIRECT, or haze 0");
  }
  if (o.haze != 0.0 && o.visibility == Visibility::kOff) {
    return invalid("haze", "haze is " + std::to_string(o.haze) +
                               ", which is found along the rays that visibility OFF leaves out: choose AUTO or ON, or "
                               "haze 0");
  }
  if (propagates) return {};
  const std::string transport = o.transport == Transport::kGather   ? "GATHER"
                                : o.transport == Transport::kDirect ? "DIRECT"
                                                                    : "AUTO";
  if (o.injection == Injection::kCount) {
    return invalid("injection", "injection is COUNT, which transport " + transport +
                                    " cannot take: it needs areas; use injection FLUX, or transport PROPAGATE");
  }
  if (o.method == InjectionMethod::kDense) {
    return invalid("method", "method is DENSE, which transport " + transport +
                                 " cannot take: it needs areas; use COMPUTE or RASTER, or transport PROPAGATE");
  }
  return {};
}

}  // namespace

LightingSettings LightingSettings::paper() {
  LightingSettings options;
  options.transport = Transport::kPropagate;
  options.followTransport();
  return options;
}

void LightingSettings::followTransport() {
  const bool propagate = transport == Transport::kPropagate;
  injection = propagate ? Injection::kCount : Injection::kFlux;
  lookup = propagate ? Lookup::kSh2 : Lookup::kCap;
}

int LightingSettings::iterationsFor(const Grid& g) const {
  return iterations > 0 ? iterations : std::max({g.dims.x, g.dims.y, g.dims.z});
}

double LightingSettings::openingRatio() const {
  if (k > 0.0) return k;
  return quality == Quality::kAccurate ? kAccurateOpeningRatio : kFastOpeningRatio;
}

Status checkOptions(const LightingSettings& o) {
  const Status saved = checkSavedOptions(o);
  return saved.ok() ? checkErrorGoal(o) : saved;
}

Status checkSavedOptions(const LightingSettings& o) {
  if (Status s = checkRanges(o); !s.ok()) return s;
  return checkTogether(o);
}

}  // namespace lpv
