#include "scene/patches_near_lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <queue>
#include <utility>

#include "scene/emitter_list.h"

namespace lpv {

namespace {

constexpr double kNearRadii = 2.0;  // in radii of a patch, from its middle
constexpr double kUnevenShare = 0.01;  // of what all lights send, that patches may get from near ones

double radiusOf(const Patch& p) {
  double out = 0.0;
  for (const glm::vec3& corner : *p.triangle) out = std::max(out, double(glm::distance(corner, p.position)));
  return out;
}

double brightnessOf(const LightPoint& p) { return double(p.factor.r + p.factor.g + p.factor.b) / 3.0; }

/// W, as if nothing were in the way.
double sentBy(const LightInPoints& light) {
  double sum = 0.0;
  for (const LightPoint& p : light.points) sum += double(p.area) * brightnessOf(p);
  return glm::pi<double>() * light.brightness * sum * (light.twoSided ? 2.0 : 1.0);
}

/// W that a patch gets from near points of a light and does not send straight back to it, by how much of the patch each
/// point has before it.
double unevenFrom(const Patch& patch, double radius, const LightBall& light) {
  const double reach = kNearRadii * radius;
  const glm::dvec3 at(patch.position), n(patch.normal);
  if (glm::distance(at, light.middle) > reach + light.radius) return 0.0;
  double sent = 0.0, covered = 0.0;
  for (const LightPoint& p : light.of.points) {
    const glm::dvec3 from(p.position), d = from - at;
    if (glm::dot(d, d) > reach * reach || !(glm::dot(n, d) > 0.0)) continue;
    glm::dvec3 front(p.direction);
    if (light.of.twoSided && glm::dot(front, d) > 0.0) front = -front;
    const std::array<glm::vec3, 3>& c = *patch.triangle;
    const glm::dvec3 seen[3] = {glm::dvec3(c[0]) - from, glm::dvec3(c[1]) - from, glm::dvec3(c[2]) - from};
    const double share = double(p.area) * triangleIrradiance(seen, front, 1);
    covered += share;
    sent += share * brightnessOf(p);
  }
  const double open = std::max(1.0 - covered / (glm::pi<double>() * double(patch.area)), 0.0);
  return light.of.brightness * open * sent;
}

/// Both halves of a triangle, cut across its longest edge.
std::array<Patch, 2> halvesOf(const Patch& patch) {
  const std::array<glm::vec3, 3>& c = *patch.triangle;
  std::size_t longest = 0;
  for (std::size_t i = 1; i < 3; ++i) {
    const auto length = [&c](std::size_t k) { return glm::distance(c[k], c[(k + 1) % 3]); };
    if (length(i) > length(longest) * (1.0F + 1e-6F)) longest = i;
  }
  const glm::vec3 a = c[longest], b = c[(longest + 1) % 3], top = c[(longest + 2) % 3], half = 0.5F * (a + b);
  std::array<Patch, 2> out = {patch, patch};
  out[0].triangle = {half, b, top};
  out[1].triangle = {a, half, top};
  for (Patch& p : out) {
    p.position = ((*p.triangle)[0] + (*p.triangle)[1] + (*p.triangle)[2]) / 3.0F;
    p.area = 0.5F * patch.area;
  }
  return out;
}

void cutInHalf(std::vector<Patch>& patches, std::uint32_t which) {
  std::array<Patch, 2> halves = halvesOf(patches[which]);
  patches[which] = halves[0];
  patches.push_back(halves[1]);
}

}  // namespace

LightBall::LightBall(const LightInPoints& light) : of(light) {
  for (const LightPoint& p : light.points) middle += glm::dvec3(p.position) / double(light.points.size());
  for (const LightPoint& p : light.points) radius = std::max(radius, glm::distance(glm::dvec3(p.position), middle));
}

std::vector<std::uint32_t> halvingsNearLights(const std::vector<Patch>& patches,
                                              const std::vector<LightInPoints>& lights, std::size_t most) {
  std::vector<LightBall> balls;
  balls.reserve(lights.size());
  double sent = 0.0;
  for (const LightInPoints& light : lights) {
    sent += sentBy(light);
    if (!light.points.empty()) balls.emplace_back(light);
  }
  using Uneven = std::pair<double, std::uint32_t>;  // W, and the patch: of equals the first
  const auto lower = [](const Uneven& a, const Uneven& b) {
    return a.first != b.first ? a.first < b.first : a.second > b.second;
  };
  std::priority_queue<Uneven, std::vector<Uneven>, decltype(lower)> open(lower);
  double uneven = 0.0;
  const auto weigh = [&](const std::vector<Patch>& all, std::size_t i) {
    if (!all[i].triangle) return;
    const double radius = radiusOf(all[i]);
    double watts = 0.0;
    for (const LightBall& ball : balls) watts += unevenFrom(all[i], radius, ball);
    if (!(watts > 0.0)) return;
    uneven += watts;
    open.emplace(watts, std::uint32_t(i));
  };
  for (std::size_t i = 0; i < patches.size(); ++i) weigh(patches, i);
  std::vector<std::uint32_t> out;
  if (open.empty()) return out;
  std::vector<Patch> all = patches;
  while (!open.empty() && out.size() < most && uneven > kUnevenShare * sent) {
    const auto [watts, which] = open.top();
    open.pop();
    uneven -= watts;
    out.push_back(which);
    cutInHalf(all, which);
    weigh(all, which);
    weigh(all, all.size() - 1);
  }
  return out;
}

PatchedScene halved(const PatchedScene& patched, const std::vector<std::uint32_t>& halvings) {
  PatchedScene out = patched;
  for (const std::uint32_t which : halvings) cutInHalf(out.patches, which);
  return out;
}

}  // namespace lpv
