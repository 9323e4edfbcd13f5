#include "lpv/transport/light_grouping.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "lpv/transport/grouping_error.h"
#include "scene/error_goal.h"

namespace lpv {

namespace {

/// Roots of errors, as multiples of the goal's, from where on another grouping takes over from the one in use, and
/// where it has: early, because a receiver may be off by twice the error.
constexpr double kGivingWay = 0.15, kGone = 0.8;
/// Share of the light that moves over in one tick, at most.
constexpr double kMostMoved = 0.35;
/// Errors, as multiples of the goal: what takes over aims at the first; beyond the second all is chosen anew.
constexpr double kFiner = 0.02, kStanding = 2.0;
/// How far off layers in use may be, as a multiple of what others would reach.
constexpr double kNearlyAsGood = 1.5;

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

/// `groups` with other numbers, so that many lights keep those that they had.
std::vector<int> numberedAs(const std::vector<int>& before, const std::vector<int>& groups) {
  std::array<std::array<int, kMaxGroups>, kMaxGroups> common{};
  for (std::size_t i = 0; i < groups.size(); ++i) common[std::size_t(groups[i])][std::size_t(before[i])]++;
  std::vector<int> names(kMaxGroups, -1);
  std::array<bool, kMaxGroups> taken{};
  for (int turn = 0; turn < kMaxGroups; ++turn) {
    int group = -1, name = -1;
    for (int g = 0; g < kMaxGroups; ++g) {
      for (int n = 0; names[std::size_t(g)] < 0 && n < kMaxGroups; ++n) {
        if (taken[std::size_t(n)]) continue;
        const bool more =
            group < 0 || common[std::size_t(g)][std::size_t(n)] > common[std::size_t(group)][std::size_t(name)];
        if (more) std::tie(group, name) = std::pair(g, n);
      }
    }
    names[std::size_t(group)] = name;
    taken[std::size_t(name)] = true;
  }
  std::vector<int> out;
  for (const int group : groups) out.push_back(names[std::size_t(group)]);
  return out;
}

double smoothstep(double begin, double end, double x) {
  const double t = std::clamp((x - begin) / (end - begin), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
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

/// Groups in use that are `standing` off, while they last: light moves over into those that take their place as the
/// error grows, and back as it falls.
std::optional<Grouping> givingWay(const GroupingError& error, Grouping groups, double standing, double goal) {
  const bool under = groups.next.size() == groups.groups.size();
  const double next = under ? error.of(groups.next, countOf(groups.next)) : standing;
  if (standing >= kStanding * goal && next >= kStanding * goal) return std::nullopt;
  const double aim = smoothstep(kGivingWay, kGone, std::sqrt(standing / goal));
  groups.moved = std::clamp(aim, groups.moved - kMostMoved, groups.moved + kMostMoved);
  if (groups.moved <= 0.0) return Grouping{groups.groups};
  if (groups.moved >= 1.0 && under) return Grouping{groups.next};
  if (under) return groups;
  const Candidate finer = byLight(error, kFiner * goal);
  if (finer.error >= standing) return Grouping{groups.groups};
  groups.next = numberedAs(groups.groups, finer.grouping.groups);
  return groups;
}

Grouping chosen(const std::vector<EmittingLight>& lights, const CellBox& cells, Grouping previous, double goal) {
  const GroupingError error(lights, cells);
  const bool sectored = previous.sectors != Sectors::kNone;
  if (sectored) previous.groups.assign(lights.size(), 0);  // whichever lights there are
  const bool known = previous.groups.size() == lights.size();
  const double standing = known ? errorOf(error, previous) : 0.0;
  if (known && !sectored) {
    if (std::optional<Grouping> stands = givingWay(error, previous, standing, goal)) return *stands;
  }
  Candidate best = byLight(error, goal);
  if (best.error <= goal) return best.grouping;
  if (known && sectored && standing <= kStanding * goal) return previous;
  const Candidate directions = byDirection(error);
  if (directions.error < best.error) best = directions;
  const bool stands = known && standing <= kNearlyAsGood * best.error;
  return stands ? Grouping{previous.groups, previous.sectors} : best.grouping;
}

std::string groupName(const EmittingLight& light) { return light.source == nullptr ? "" : light.source->group; }

Grouped byHand(std::vector<EmittingLight>& lights) {
  std::set<std::string> names;
  for (const EmittingLight& light : lights) names.insert(groupName(light));
  if (names.empty()) names.insert("");
  for (EmittingLight& light : lights) {
    light.group = light.nextGroup = int(std::distance(names.begin(), names.find(groupName(light))));
    light.moved = 0.0;
  }
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
  for (std::size_t i = 0; i < lights.size(); ++i) {
    lights[i].group = lights[i].nextGroup = grouping.groups[i];
    if (!grouping.next.empty()) lights[i].nextGroup = grouping.next[i];
    lights[i].moved = grouping.moved;
  }
  Grouped out;
  out.sectors = grouping.sectors;
  if (grouping.sectors != Sectors::kNone) {
    for (int i = 1; i <= kSectors; ++i) out.names.push_back("direction " + std::to_string(i));
    return out;
  }
  out.names = {""};
  const int layers = std::max(countOf(grouping.groups), grouping.next.empty() ? 1 : countOf(grouping.next));
  for (int i = 2; i <= layers; ++i) out.names.push_back("auto " + std::to_string(i));
  return out;
}

}  // namespace lpv
