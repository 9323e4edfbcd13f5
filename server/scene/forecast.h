#pragma once
// What a session is told of the choices made for it: the error that its scene is expected to have, and a sentence or
// two on the grid.

#include <optional>
#include <string>

#include "scene/grid_choice.h"
#include "scene/scene.h"

namespace lpv {

struct Forecast {
  double error = 0.0;  ///< raw relative L2 of irradiance
  std::string choice;
};

/// For a scene with the grid in use, and settings as they were asked for; follows from these alone. GATHER: the
/// prediction (scene/predicted_error.h), or where frames and probes look at the lights as with DIRECT; DIRECT: next to
/// nothing where all lights are polygons; else the table (scene/error_goal.h). Of light with nothing in its way.
/// `correction`: that the grid has seen.
Forecast forecast(const Scene& scene, const LightingSettings& asked,
                  const std::optional<GridCorrection>& correction = std::nullopt);

}  // namespace lpv
