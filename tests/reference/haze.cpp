#include "reference/haze.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/ground_truth.h"

namespace lpv::reference {

namespace {

constexpr int kViewSteps = 300;
constexpr double kSmallBeside = 0.08;  ///< of its distance: a triangle is looked at as a whole
constexpr int kMostHazeCuts = 16;

bool isInHaze(const Bounds& box, const glm::dvec3& p) {
  return glm::all(glm::greaterThanEqual(p, box.min)) && glm::all(glm::lessThanEqual(p, box.max));
}

using HazeCorners = std::array<glm::dvec3, 3>;

/// Calls visit(corners) for parts of a triangle that are small seen from p.
template <typename Visit>
void cutUntilSmall(const HazeCorners& t, const glm::dvec3& p, int cuts, const Visit& visit) {
  const double edges[3] = {glm::distance(t[0], t[1]), glm::distance(t[1], t[2]), glm::distance(t[2], t[0])};
  const int longest = int(std::max_element(edges, edges + 3) - edges);
  const double near = glm::distance((t[0] + t[1] + t[2]) / 3.0, p);
  if (cuts == 0 || edges[longest] < kSmallBeside * near) return visit(t);
  const glm::dvec3 a = t[std::size_t(longest)], b = t[std::size_t((longest + 1) % 3)],
                   c = t[std::size_t((longest + 2) % 3)];
  const glm::dvec3 middle = 0.5 * (a + b);
  cutUntilSmall({a, middle, c}, p, cuts - 1, visit);
  cutUntilSmall({middle, b, c}, p, cuts - 1, visit);
}

double hazePhase(double g, double cosine) {
  return (1.0 - g * g) / (4.0 * std::numbers::pi * std::pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
}

/// By the closed form of a straight way out of a box, which marches of 400 steps a pixel need; Medium::transmittance is
/// held against it.
double straightThrough(const Medium& medium, const glm::dvec3& from, const glm::dvec3& to) {
  if (isInHaze(medium.box, to)) return std::exp(-medium.extinction * glm::distance(from, to));
  double share = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double way = to[axis] - from[axis];
    if (way > 0.0) share = std::min(share, (medium.box.max[axis] - from[axis]) / way);
    if (way < 0.0) share = std::min(share, (medium.box.min[axis] - from[axis]) / way);
  }
  return std::exp(-medium.extinction * share * glm::distance(from, to));
}

/// At a place in the haze, per metre: light of all emitters, turned into `towards`.
glm::dvec3 hazeSource(const std::vector<Emitter>& emitters, const Medium& medium, const glm::dvec3& p,
                      const glm::dvec3& towards, const LightGets& seen) {
  glm::dvec3 sum(0.0);
  for (const Emitter& e : emitters) {
    if (!e.twoSided && glm::dot(e.areaNormal(), p - e.corners[0]) <= 0.0) continue;
    cutUntilSmall(e.corners, p, kMostHazeCuts, [&](const HazeCorners& t) {
      const glm::dvec3 middle = (t[0] + t[1] + t[2]) / 3.0;
      if (seen && !seen(p, middle)) return;
      const double angle = std::abs(triangleSolidAngle(t[0] - p, t[1] - p, t[2] - p));
      const double turned = glm::dot(glm::normalize(p - middle), towards);
      sum += angle * hazePhase(medium.anisotropy, turned) * straightThrough(medium, p, middle) * e.radiance;
    });
  }
  return medium.scattering * sum;
}

}  // namespace

double Medium::transmittance(const glm::dvec3& a, const glm::dvec3& b) const {
  constexpr int kSteps = 1000;
  int inside = 0;
  for (int i = 0; i < kSteps; ++i) inside += isInHaze(box, glm::mix(a, b, (i + 0.5) / kSteps)) ? 1 : 0;
  return std::exp(-extinction * glm::distance(a, b) * inside / kSteps);
}

glm::dvec3 scattered(const std::vector<Emitter>& emitters, const Medium& medium, const glm::dvec3& eye,
                     const glm::dvec3& direction, double until, const LightGets& seen) {
  // Steps are short where the emitters are near: equal angles about where the view passes their middle.
  glm::dvec3 middle(0.0);
  double area = 0.0;
  for (const Emitter& e : emitters) {
    middle += e.area() * (e.corners[0] + e.corners[1] + e.corners[2]) / 3.0;
    area += e.area();
  }
  middle /= area;
  const double along = glm::dot(middle - eye, direction);
  const double apart = glm::distance(eye + along * direction, middle) + 0.1 * std::sqrt(area);
  double begin = until, end = 0.0;
  constexpr int kLooks = 4000;
  for (int i = 0; i < kLooks; ++i) {
    const double t = until * (i + 0.5) / kLooks;
    if (!isInHaze(medium.box, eye + t * direction)) continue;
    begin = std::min(begin, until * i / kLooks);
    end = std::max(end, until * (i + 1.0) / kLooks);
  }
  if (end <= begin) return glm::dvec3(0.0);
  const double first = std::atan((begin - along) / apart), last = std::atan((end - along) / apart);
  glm::dvec3 sum(0.0);
  for (int i = 0; i < kViewSteps; ++i) {
    const double angle = glm::mix(first, last, (i + 0.5) / kViewSteps), c = std::cos(angle);
    const double t = along + apart * std::tan(angle), step = apart / (c * c) * (last - first) / kViewSteps;
    const glm::dvec3 p = eye + t * direction;
    if (!isInHaze(medium.box, p)) continue;
    sum += step * std::exp(-medium.extinction * (t - begin)) * hazeSource(emitters, medium, p, -direction, seen);
  }
  return sum;
}

glm::dvec3 irradianceThrough(const std::vector<Emitter>& emitters, const Medium& medium, const glm::dvec3& at,
                             const glm::dvec3& n) {
  glm::dvec3 sum(0.0);
  for (const Emitter& e : emitters) {
    if (!e.twoSided && glm::dot(e.areaNormal(), at - e.corners[0]) <= 0.0) continue;
    cutUntilSmall(e.corners, at, kMostHazeCuts, [&](const HazeCorners& t) {
      const glm::dvec3 middle = (t[0] + t[1] + t[2]) / 3.0;
      const double angle = std::abs(triangleSolidAngle(t[0] - at, t[1] - at, t[2] - at));
      sum += angle * std::max(glm::dot(n, glm::normalize(middle - at)), 0.0) * medium.transmittance(at, middle) *
             e.radiance;
    });
  }
  return sum;
}

}  // namespace lpv::reference
