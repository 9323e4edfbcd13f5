#include "lpv/transport/light_grouping.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <set>

#include "scene/error_goal.h"
#include "scene/lookup.h"
#include "scene/sh.h"

namespace lpv {

namespace {

constexpr int kPoints = 64;
constexpr int kNormals = 6;

/// What a light is from afar: cell units, unit of radiance its radianceScale channel.
struct Outline {
  glm::dvec3 centre{0.0};
  double radius = 0.0;
  glm::dvec3 areaNormal{0.0};
  double area = 0.0;
  double radiance = 0.0;
  bool twoSided = false;
};

Outline outlineOf(const EmittingLight& light) {
  Outline o;
  o.twoSided = light.twoSided;
  o.radiance = std::max({light.radiance.r, light.radiance.g, light.radiance.b});
  std::vector<glm::dvec3> p;
  p.reserve(light.mesh->positions.size());
  for (const glm::vec3& q : light.mesh->positions)
    p.emplace_back(light.gridFromObject * glm::dvec4(glm::dvec3(q), 1.0));
  for (const glm::uvec3& t : light.mesh->triangles) {
    const glm::dvec3 n = (light.mirrored ? -0.5 : 0.5) * glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]);
    const double area = glm::length(n);
    o.areaNormal += n;
    o.area += area;
    o.centre += area / 3.0 * (p[t.x] + p[t.y] + p[t.z]);
  }
  if (o.area > 0.0) o.centre /= o.area;
  for (const glm::dvec3& q : p) o.radius = std::max(o.radius, glm::distance(q, o.centre));
  return o;
}

/// SH of incident radiance at x: a cap as wide as the outline, as much light as its area sends.
sh::Coefficients incidentAt(const Outline& o, const glm::dvec3& x) {
  const glm::dvec3 d = o.centre - x;
  const double distance = std::max(glm::length(d), 0.5);
  const glm::dvec3 w = d / distance;
  const double t = -glm::dot(o.areaNormal, w), spread = std::max(0.0, o.area - glm::length(o.areaNormal));
  const double facing = o.twoSided ? std::abs(t) : std::max(0.0, t);
  const double fluence = o.radiance * (facing + spread / 4.0) / std::max(distance * distance, 0.25);
  const double sine = std::min(1.0, o.radius / distance);
  const double rho = 0.5 * (1.0 + std::sqrt(1.0 - sine * sine));
  return sh::fromBands(sh::kY0 * fluence, sh::kY1 * rho * fluence * w);
}

/// Points spread evenly over the grid: the additive recurrence of the plastic number (Roberts 2018).
glm::dvec3 pointOf(int i, const Grid& grid) {
  constexpr double g = 1.2207440846057594754;
  const glm::dvec3 alpha(1.0 / g, 1.0 / (g * g), 1.0 / (g * g * g));
  return glm::dvec3(grid.dims) * glm::fract(0.5 + alpha * double(i + 1));
}

using Field = std::array<sh::Coefficients, kPoints>;
using Irradiances = std::array<double, std::size_t(kPoints) * kNormals>;

Irradiances lookedUp(const Field& field) {
  Irradiances out{};
  for (int i = 0; i < kPoints; ++i) {
    for (int n = 0; n < kNormals; ++n) {
      glm::dvec3 normal(0.0);
      normal[n / 2] = n % 2 == 0 ? 1.0 : -1.0;
      out[std::size_t(i * kNormals + n)] = irradianceCap(field[std::size_t(i)], normal);
    }
  }
  return out;
}

void add(Irradiances& to, const Irradiances& from, double factor = 1.0) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * from[i];
}

double norm(const Irradiances& e) { return std::sqrt(std::inner_product(e.begin(), e.end(), e.begin(), 0.0)); }

/// Each light's field, and what the lights give when each has a lookup to itself.
struct Apart {
  Apart(const std::vector<EmittingLight>& lights, const Grid& grid) {
    for (const EmittingLight& light : lights) {
      const Outline outline = outlineOf(light);
      Field& field = fields.emplace_back();
      for (int i = 0; i < kPoints; ++i) field[std::size_t(i)] = incidentAt(outline, pointOf(i, grid));
      add(truth, lookedUp(field));
    }
  }
  std::vector<Field> fields;
  Irradiances truth{};
};

double errorOf(const Apart& apart, const std::vector<int>& groups, int count) {
  std::vector<Field> sums(std::size_t(count), Field{});
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (std::size_t p = 0; p < kPoints; ++p) sums[std::size_t(groups[i])][p] += apart.fields[i][p];
  }
  Irradiances e{};
  for (const Field& sum : sums) add(e, lookedUp(sum));
  add(e, apart.truth, -1.0);
  const double whole = norm(apart.truth);
  return whole > 0.0 ? norm(e) / whole : 0.0;
}

/// The radianceScale first, each into the group where it does the least harm.
std::vector<int> dealt(const Apart& apart, const std::vector<std::size_t>& order, int count) {
  std::vector<int> groups(apart.fields.size(), 0);
  std::vector<Field> sums(std::size_t(count), Field{});
  std::vector<Irradiances> alone(std::size_t(count), Irradiances{});
  for (const std::size_t light : order) {
    const Irradiances own = lookedUp(apart.fields[light]);
    double least = 0.0;
    int best = -1;
    for (int g = 0; g < count; ++g) {
      Field sum = sums[std::size_t(g)];
      for (std::size_t p = 0; p < kPoints; ++p) sum[p] += apart.fields[light][p];
      Irradiances harm = lookedUp(sum);
      add(harm, alone[std::size_t(g)], -1.0);
      add(harm, own, -1.0);
      const double size = norm(harm);
      if (best < 0 || size < least) {
        best = g;
        least = size;
      }
    }
    groups[light] = best;
    for (std::size_t p = 0; p < kPoints; ++p) sums[std::size_t(best)][p] += apart.fields[light][p];
    alone[std::size_t(best)] = lookedUp(sums[std::size_t(best)]);
  }
  return groups;
}

int countOf(const std::vector<int>& groups) {
  return groups.empty() ? 1 : 1 + *std::max_element(groups.begin(), groups.end());
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

std::vector<int> chosen(const std::vector<EmittingLight>& lights, const Grid& grid, const std::vector<int>& previous,
                        double goal) {
  const Apart apart(lights, grid);
  if (previous.size() == lights.size() && errorOf(apart, previous, countOf(previous)) <= 2.0 * goal) return previous;
  std::vector<std::size_t> order(lights.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::vector<double> brightness;
  for (const Field& field : apart.fields) brightness.push_back(norm(lookedUp(field)));
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return brightness[a] > brightness[b]; });
  std::vector<int> groups;
  for (int count = 1; count <= std::min(kMaxGroups, int(lights.size())); ++count) {
    groups = dealt(apart, order, count);
    if (errorOf(apart, groups, count) <= goal) break;
  }
  return renumbered(std::move(groups));
}

std::string groupName(const EmittingLight& light) { return light.source == nullptr ? "" : light.source->group; }

std::vector<std::string> byHand(std::vector<EmittingLight>& lights) {
  std::set<std::string> names;
  for (const EmittingLight& light : lights) names.insert(groupName(light));
  if (names.empty()) names.insert("");
  for (EmittingLight& light : lights) light.group = int(std::distance(names.begin(), names.find(groupName(light))));
  return {names.begin(), names.end()};
}

}  // namespace

double groupingError(const std::vector<EmittingLight>& lights, const Grid& grid, const std::vector<int>& groups) {
  return errorOf(Apart(lights, grid), groups, countOf(groups));
}

bool groupsItself(const LightingSettings& o) {
  const bool asked = o.quality == Quality::kAccurate || o.maxError > 0.0;
  return o.transport == Transport::kGather && asked && o.lookup == Lookup::kCap;
}

std::vector<std::string> groupLights(const Scene& scene, std::vector<EmittingLight>& lights,
                                     const std::vector<int>& previous) {
  const bool named = std::any_of(lights.begin(), lights.end(), [](const auto& l) { return !groupName(l).empty(); });
  if (named || !groupsItself(scene.options) || lights.size() < 2) return byHand(lights);
  const glm::ivec3& dims = scene.grid.dims;
  const double goal = groupingGoal(scene.options, std::max({dims.x, dims.y, dims.z}));
  const std::vector<int> groups = chosen(lights, scene.grid, previous, goal);
  for (std::size_t i = 0; i < lights.size(); ++i) lights[i].group = groups[i];
  std::vector<std::string> names = {""};
  for (int i = 2; i <= countOf(groups); ++i) names.push_back("auto " + std::to_string(i));
  return names;
}

}  // namespace lpv
