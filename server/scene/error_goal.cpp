#include "scene/error_goal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace lpv {

namespace {

constexpr std::array kRules = {kFastOpeningRatio, kAccurateOpeningRatio, 6.0};

/// GATHER with CAP.
struct Measured {
  int cells = 0;
  std::array<double, kRules.size()> error;  ///< by rule
};
constexpr std::array kGather = {
    Measured{8, {0.16, 0.16, 0.16}},     Measured{16, {0.0085, 0.0085, 0.0085}}, Measured{24, {0.007, 0.007, 0.007}},
    Measured{32, {0.005, 0.005, 0.005}}, Measured{48, {0.004, 0.0035, 0.003}},   Measured{64, {0.0035, 0.003, 0.002}},
};
constexpr double kTwoBands = 0.25;     ///< lookup SH2 of any field; NEAREST is worse
constexpr double kPropagated = 1.0;    ///< of PROPAGATE, whatever the grid: 37 to 99 %
/// DIRECT through trees of VPLs; polygons are exact. With the rule kAccurateOpeningRatio and above, and below it.
constexpr double kLookedAt = 0.003, kGlancedAt = 0.0045;
constexpr double kNoGrid = 1.0;        ///< below the smallest grid measured
constexpr double kLeastForGroups = 0.002;

double gathered(int cells, double k) {
  double error = kNoGrid;
  for (const Measured& row : kGather) {
    if (row.cells > cells) break;
    error = row.error[0];
    for (std::size_t i = 1; i < kRules.size() && kRules[i] <= k; ++i) error = row.error[i];
  }
  return k < kRules[0] ? std::max(error, 2.0 * gathered(cells, kRules[0])) : error;
}

int cellsOf(const GridOptions& grid) {
  const int most = std::max({grid.dims.x, grid.dims.y, grid.dims.z});
  if (most > 0) return most;
  return grid.longest > 0 ? grid.longest : kDefaultCellsOfLongestEdge;
}

/// Share of an error goal that merging may take: half of its square.
constexpr double kShareOfMerging = 0.7;

/// Settings by rising cost: the number of cells weighs more than the opening ratio.
LightingSettings withRuleFor(LightingSettings o) {
  if (o.k > 0.0 || o.transport == Transport::kPropagate) return o;
  for (const double k : kRules) {
    o.k = k;
    const bool merged = o.transport == Transport::kDirect || mergingError(k) <= kShareOfMerging * o.maxError;
    if (merged && expectedError(o, cellsOf(o.grid)) <= o.maxError) break;
  }
  return o;
}

std::string percent(double error) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g (%.3g %%)", error, 100.0 * error);
  return text;
}

/// Smallest expected error of GATHER.
double best() {
  LightingSettings o;
  o.k = kRules.back();
  return expectedError(o, kMaxCellsPerAxis);
}

}  // namespace

double expectedError(const LightingSettings& o, int longestCells) {
  if (o.transport == Transport::kPropagate) return kPropagated;
  if (o.transport == Transport::kDirect) return o.openingRatio() < kAccurateOpeningRatio ? kGlancedAt : kLookedAt;
  const double volume = gathered(longestCells, o.openingRatio());
  return o.lookup == Lookup::kCap ? volume : std::max(volume, kTwoBands);
}

double mergingError(double openingRatio) { return openingRatio < kAccurateOpeningRatio ? 0.003 : 0.0015; }

LightingSettings resolved(const LightingSettings& asked) {
  LightingSettings options = asked;
  if (options.transport == Transport::kAuto) options.transport = Transport::kGather;
  LightingSettings o = options;
  if (o.grid.automatic) o.grid.longest = kDefaultCellsOfLongestEdge;
  if (o.maxError == 0.0) return o;
  const bool sized = o.grid.longest > 0 || o.grid.dims != glm::ivec3(0);
  if (!options.grid.automatic && sized) return withRuleFor(o);
  for (const Measured& row : kGather) {
    if (!options.grid.automatic && row.cells < kDefaultCellsOfLongestEdge) continue;
    o = options;
    o.grid.longest = row.cells;
    o = withRuleFor(o);
    if (expectedError(o, row.cells) <= o.maxError) break;
  }
  return o;
}

Expected<Grid> gridFor(const LightingSettings& options, const Bounds& content) {
  const GridOptions grid = resolved(options).grid;
  return grid.hasBounds ? makeGrid(grid, grid.bounds) : fitGrid(grid, content);
}

Status checkErrorGoal(const LightingSettings& options) {
  if (options.maxError == 0.0) return {};
  const LightingSettings o = resolved(options);
  const double expected = expectedError(o, cellsOf(o.grid));
  if (expected <= o.maxError) return {};
  const std::string way = "transport GATHER with lookup CAP and grid.automatic reaches " + percent(best());
  return invalid("max_error", "max_error is " + percent(o.maxError) + ", these settings are expected to reach " +
                                  percent(expected) + "; ask for that, or change them: " + way);
}

double groupingGoal(const LightingSettings& o, int longestCells) {
  if (o.maxError == 0.0) return kGroupingError;
  const double expected = expectedError(o, longestCells);
  return std::max(kLeastForGroups, std::sqrt(std::max(0.0, o.maxError * o.maxError - expected * expected)));
}

}  // namespace lpv
