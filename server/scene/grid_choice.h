#pragma once
// The grid that a scene gets where its settings leave the number of cells to the server: the same for the same scene
// and settings, whatever the device takes for it.

#include <optional>
#include <vector>

#include "scene/scene.h"

namespace lpv {

/// Wanted error where none is asked for.
inline constexpr double kWantedError = 0.03;
double wantedError(const LightingSettings& options);

/// Whether the number of cells is left to the server: grid.automatic, or nothing said.
bool choosesCells(const GridOptions& grid);

struct GridChoice {
  struct Tried {
    int cells = 0;  ///< along the longest edge
    double error = 0.0;
  };

  Grid grid;
  std::vector<Tried> tried;  ///< by cells; empty where nothing was predicted
  bool reached = false;      ///< by the last of them
};

/// What a measurement has made of a choice.
struct GridCorrection {
  int missed = 0;      ///< cells along the longest edge that were measured,
  double error = 0.0;  ///< and found to be so far off
  int least = 0;       ///< cells from then on
};

/// Fewest cells of those that are tried which would have the wanted error where `cells` were measured to have `error`:
/// it goes with the square of a cell's edge. The most that are tried where none would; no fewer than `cells`.
int cellsForMeasured(const LightingSettings& options, int cells, double error);

/// The grid for a scene, whose own grid and settings do not matter, with `options` as they are asked for. GATHER: of 16
/// (nothing said: 32), 24, .. 128 (64) cells along the longest edge the fewest that are predicted to have the wanted
/// error; where none has, of those up to 64 the fewest within a tenth of the best. Else, and where nothing can be
/// predicted, gridFor (scene/error_goal.h).
/// No fewer cells than `least`, where they are left to the server.
Expected<GridChoice> chooseGrid(const Scene& scene, const LightingSettings& options, int least = 0);

/// The cells from `least` to `most` that chooseGrid tries, with their predicted errors, up to the first that has the
/// wanted error.
Expected<GridChoice> tryGrids(const Scene& scene, const LightingSettings& options, int least, int most);

}  // namespace lpv
