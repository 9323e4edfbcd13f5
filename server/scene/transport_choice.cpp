#include "scene/transport_choice.h"

#include <algorithm>
#include <optional>

#include "scene/grid_choice.h"
#include "scene/patches.h"
#include "scene/predicted_error.h"
#include "scene/shadowing.h"
#include "scene/small_lights.h"

namespace lpv {

TransportChoice chooseTransport(const Scene& scene) {
  LightingSettings gather = scene.options;
  gather.transport = Transport::kGather;
  if (isShadowed(scene) || bouncesFor(scene) > 0)
    return {Transport::kGather, "for shadows and bounces frames look at the lights in any case"};
  const std::optional<double> predicted = predictError(scene, scene.grid, gather);
  if (!predicted) return {Transport::kGather, "the scene gives nothing to predict from"};
  if (*predicted <= wantedError(gather)) return {Transport::kGather, "it is predicted to have the wanted error"};
  if (!areCheapToLookAt(lightSizes(scene, scene.grid)))
    return {Transport::kGather, "its lights are too much to look at from everywhere"};
  return {Transport::kDirect, "GATHER is predicted to miss the wanted error, and its lights are few polygons"};
}

}  // namespace lpv
