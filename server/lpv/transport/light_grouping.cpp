#include "lpv/transport/light_grouping.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "lpv/transport/grouping_error.h"
#include "scene/error_goal.h"

namespace lpv {

namespace {

/// How far off a grouping in use may be, as a multiple of the goal, and of what another would reach.
constexpr double kStanding = 2.0, kNearlyAsGood = 1.5;

int countOf(const std::vector<int>& groups) {
  return groups.empty() ? 1 : 1 + *std::max_element(groups.begin(), groups.end());
}

double errorOf(const GroupingError& error, const Grouping& grouping) {
  if (grouping.sectors != Sectors::kNone) return error.of(grouping.sectors);
  return error.of(grouping.groups, countOf(grouping.groups));
}

/// Groups are numbered in the order of their first lights.
std::vector<int> renumbered(std::vector<int> groups) {
  std::vector<int> names(kMaxGroups, -1);
  int next = 0;
  for (int& group : groups) {
    int& name = names[std::size_t(group)];
    if (name < 0) name = next++;
    group = name;
  }
  return groups;
}

struct Candidate {
  Grouping grouping;
  double error = 0.0;
};

/// The fewest groups of lights that reach the goal; where none does, the most that are tried.
Candidate byLight(const GroupingError& error, double goal) {
  const int most = error.lights() > kMostDealt ? 1 : std::min(kMaxGroups, int(error.lights()));
  const auto candidate = [&](int count) {
    Candidate out{{count == 1 ? std::vector<int>(error.lights(), 0) : renumbered(error.dealt(count))}};
    out.error = errorOf(error, out.grouping);
    return out;
  };
  const Candidate last = candidate(most);
  for (int count = 1; count < most && (last.error <= goal || count == 1); ++count) {
    Candidate fewer = candidate(count);
    if (fewer.error <= goal) return fewer;
  }
  return last;
}

Candidate byDirection(const GroupingError& error) {
  Candidate best;
  for (const Sectors sectors : kAllSectors) {
    const double e = error.of(sectors);
    if (best.grouping.sectors == Sectors::kNone || e < best.error)
      best = {{std::vector<int>(error.lights(), 0), sectors}, e};
  }
  return best;
}

Grouping chosen(const std::vector<EmittingLight>& lights, const CellBox& cells, Grouping previous, double goal) {
  const GroupingError error(lights, cells);
  const bool sectored = previous.sectors != Sectors::kNone;
  if (sectored) previous.groups.assign(lights.size(), 0);  // whichever lights there are
  const bool known = previous.groups.size() == lights.size();
  const double standing = known ? errorOf(error, previous) : 0.0;
  if (known && !sectored && standing <= kStanding * goal) return previous;
  Candidate best = byLight(error, goal);
  if (best.error <= goal) return best.grouping;
  if (known && sectored && standing <= kStanding * goal) return previous;
  const Candidate directions = byDirection(error);
  if (directions.error < best.error) best = directions;
  return known && standing <= kNearlyAsGood * best.error ? previous : best.grouping;
}

std::string groupName(const EmittingLight& light) { return light.source == nullptr ? "" : light.source->group; }

Grouped byHand(std::vector<EmittingLight>& lights) {
  std::set<std::string> names;
  for (const EmittingLight& light : lights) names.insert(groupName(light));
  if (names.empty()) names.insert("");
  for (EmittingLight& light : lights) light.group = int(std::distance(names.begin(), names.find(groupName(light))));
  return {{names.begin(), names.end()}};
}

}  // namespace

double groupingError(const std::vector<EmittingLight>& lights, const CellBox& cells, const Grouping& grouping) {
  return errorOf(GroupingError(lights, cells), grouping);
}

Grouped groupLights(const Scene& scene, const CellBox& cells, std::vector<EmittingLight>& lights,
                    const Grouping& previous) {
  const bool named = std::any_of(lights.begin(), lights.end(), [](const auto& l) { return !groupName(l).empty(); });
  if (named || !scene.options.groupsItself() || lights.size() < 2) return byHand(lights);
  const glm::ivec3& dims = scene.grid.dims;
  const double goal = groupingGoal(scene.options, std::max({dims.x, dims.y, dims.z}));
  const Grouping grouping = chosen(lights, cells, previous, goal);
  for (std::size_t i = 0; i < lights.size(); ++i) lights[i].group = grouping.groups[i];
  Grouped out;
  out.sectors = grouping.sectors;
  if (grouping.sectors != Sectors::kNone) {
    for (int i = 1; i <= kSectors; ++i) out.names.push_back("direction " + std::to_string(i));
    return out;
  }
  out.names = {""};
  for (int i = 2; i <= countOf(grouping.groups); ++i) out.names.push_back("auto " + std::to_string(i));
  return out;
}

}  // namespace lpv
