#include "reference/ground_truth.h"

#include <cmath>
#include <utility>

#include "reference/sh.h"

namespace lpv::reference {
namespace {

using Polygon = std::vector<glm::dvec3>;

/// Sum over the edges of Theta_i Gamma_i, corners relative to the receiver.
glm::dvec3 edgeSum(const Polygon& polygon) {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 a = glm::normalize(polygon[i]);
    const glm::dvec3 b = glm::normalize(polygon[(i + 1) % polygon.size()]);
    const glm::dvec3 normal = glm::cross(a, b);
    const double sine = glm::length(normal);
    if (sine > 0.0) sum += std::atan2(sine, glm::dot(a, b)) / sine * normal;
  }
  return sum;
}

/// The part of the polygon above the horizon of n.
Polygon aboveHorizon(const Polygon& in, const glm::dvec3& n) {
  Polygon out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const glm::dvec3& p = in[i];
    const glm::dvec3& q = in[(i + 1) % in.size()];
    const double dp = glm::dot(p, n);
    const double dq = glm::dot(q, n);
    if (dp >= 0.0) out.push_back(p);
    if ((dp > 0.0 && dq < 0.0) || (dp < 0.0 && dq > 0.0)) out.push_back((p * dq - q * dp) / (dq - dp));
  }
  return out;
}

/// True when x is strictly in front of the triangle.
bool seesFront(const std::array<glm::dvec3, 3>& c, const glm::dvec3& x) {
  return glm::dot(glm::cross(c[1] - c[0], c[2] - c[0]), c[0] - x) < 0.0;
}

/// Calls visit(corners as seen from their front) for each emitting side of a triangle.
template <typename Visit>
void forEachSide(const Emitter& e, Visit visit) {
  visit(e.corners);
  if (e.twoSided) visit(std::array<glm::dvec3, 3>{e.corners[0], e.corners[2], e.corners[1]});
}

}  // namespace

double triangleSolidAngle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 u = glm::normalize(a);
  const glm::dvec3 v = glm::normalize(b);
  const glm::dvec3 w = glm::normalize(c);
  const double volume = std::abs(glm::dot(u, glm::cross(v, w)));
  return 2.0 * std::atan2(volume, 1.0 + glm::dot(u, v) + glm::dot(v, w) + glm::dot(w, u));
}

Moments triangleMoments(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& x) {
  if (!seesFront(corners, x)) return {};
  const Polygon polygon = {corners[0] - x, corners[1] - x, corners[2] - x};
  return {triangleSolidAngle(polygon[0], polygon[1], polygon[2]), -0.5 * edgeSum(polygon)};
}

double triangleIrradiance(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& x, const glm::dvec3& n) {
  if (!seesFront(corners, x)) return 0.0;
  const Polygon above = aboveHorizon({corners[0] - x, corners[1] - x, corners[2] - x}, n);
  return above.size() < 3 ? 0.0 : -0.5 * glm::dot(edgeSum(above), n);
}

glm::dvec3 irradianceOf(const std::vector<Emitter>& emitters, const glm::dvec3& x, const glm::dvec3& n) {
  glm::dvec3 sum(0.0);
  for (const Emitter& e : emitters) {
    forEachSide(e, [&](const auto& corners) { sum += e.radiance * triangleIrradiance(corners, x, n); });
  }
  return sum;
}

std::array<Coefficients, 3> incidentSh(const std::vector<Emitter>& emitters, const glm::dvec3& x) {
  std::array<Coefficients, 3> out{};
  const Coefficients scale = basis(glm::dvec3(1.0));  // (Y00 factor, Y1 factor three times)
  for (const Emitter& e : emitters) {
    forEachSide(e, [&](const auto& corners) {
      const Moments m = triangleMoments(corners, x);
      const glm::dvec3& d = m.vectorIrradiance;
      const Coefficients c = scale * Coefficients(m.fluence, d.y, d.z, d.x);
      for (int colour = 0; colour < 3; ++colour) out[std::size_t(colour)] += e.radiance[colour] * c;
    });
  }
  return out;
}

}  // namespace lpv::reference
