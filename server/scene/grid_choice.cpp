#include "scene/grid_choice.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/error_goal.h"
#include "scene/predicted_error.h"

namespace lpv {

namespace {

constexpr std::array kCandidates = {16, 24, 32, 48, 64, 96, kMaxCellsPerAxis};
/// Beyond this many, cells are worth their cost only where they reach the wanted error; and only where asked for.
constexpr int kDear = 64;
constexpr double kNearTheBest = 1.1;

Expected<Grid> gridOf(GridOptions options, int cells, const Bounds& content) {
  options.automatic = false;
  options.longest = cells;
  return options.hasBounds ? makeGrid(options, options.bounds) : fitGrid(options, content);
}

int fewestNearTheBest(const std::vector<GridChoice::Tried>& tried) {
  double best = tried.front().error;
  for (const auto& [cells, error] : tried) {
    if (cells <= kDear) best = std::min(best, error);
  }
  return std::ranges::find_if(tried, [best](const auto& each) { return each.error <= kNearTheBest * best; })->cells;
}

}  // namespace

double wantedError(const LightingSettings& options) { return options.maxError > 0.0 ? options.maxError : kWantedError; }

bool choosesCells(const GridOptions& grid) {
  return grid.automatic || (grid.longest == 0 && grid.dims == glm::ivec3(0));
}

Expected<GridChoice> tryGrids(const Scene& scene, const LightingSettings& options, int least, int most) {
  GridChoice out;
  const ErrorPredictor predictor(scene, resolved(options));
  const Bounds content = contentBounds(scene);
  for (const int cells : kCandidates) {
    if (cells < least || cells > most) continue;
    const Expected<Grid> grid = gridOf(options.grid, cells, content);
    if (!grid) return grid.status();
    const std::optional<double> error = predictor.with(*grid);
    if (!error) break;
    out.grid = *grid;
    out.tried.push_back({cells, *error});
    out.reached = *error <= wantedError(options);
    if (out.reached) break;
  }
  return out;
}

int cellsForMeasured(const LightingSettings& options, int cells, double error) {
  const int most = options.grid.automatic ? kMaxCellsPerAxis : kDear;
  const double needed = cells * std::sqrt(error / wantedError(options));
  int found = cells;
  for (const int candidate : kCandidates) {
    if (candidate > most || found >= needed) break;
    found = std::max(found, candidate);
  }
  return found;
}

Expected<GridChoice> chooseGrid(const Scene& scene, const LightingSettings& options, int least) {
  GridChoice out;
  const Bounds content = contentBounds(scene);
  if (choosesCells(options.grid) && resolved(options).transport == Transport::kGather) {
    const bool automatic = options.grid.automatic;
    const int first = std::max(least, automatic ? kCandidates.front() : kDefaultCellsOfLongestEdge);
    Expected<GridChoice> tried = tryGrids(scene, options, first, automatic ? kMaxCellsPerAxis : kDear);
    if (!tried) return tried.status();
    out = std::move(*tried);
    if (out.reached) return out;
    if (!out.tried.empty()) {
      const Expected<Grid> grid = gridOf(options.grid, fewestNearTheBest(out.tried), content);
      if (!grid) return grid.status();
      out.grid = *grid;
      return out;
    }
  }
  const Expected<Grid> grid = gridFor(options, content);
  if (!grid) return grid.status();
  out.grid = *grid;
  return out;
}

}  // namespace lpv
