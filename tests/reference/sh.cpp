#include "reference/sh.h"

#include <cmath>
#include <numbers>

namespace lpv::reference {
namespace {

constexpr int kRings = 24;     // per hemisphere: exact to degree 47 in the cosine
constexpr int kSectors = 48;   // exact to degree 47 in the azimuth

/// Two unit vectors that make a right-handed frame with unit n.
std::pair<glm::dvec3, glm::dvec3> tangents(const glm::dvec3& n) {
  const glm::dvec3 helper = std::abs(n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 t = glm::normalize(glm::cross(helper, n));
  return {t, glm::cross(n, t)};
}

}  // namespace

double pi() { return std::numbers::pi; }

Coefficients basis(const glm::dvec3& w) {
  const double y0 = 1.0 / std::sqrt(4.0 * pi());
  const double y1 = std::sqrt(3.0 / (4.0 * pi()));
  return {y0, y1 * w.y, y1 * w.z, y1 * w.x};
}

Coefficients lobe(const glm::dvec3& n) {
  const double a0 = pi();
  const double a1 = 2.0 * pi() / 3.0;
  return basis(n) * Coefficients(a0, a1, a1, a1);
}

double evaluate(const Coefficients& c, const glm::dvec3& w) { return glm::dot(c, basis(w)); }

std::vector<std::pair<double, double>> gaussLegendre(int n) {
  std::vector<std::pair<double, double>> nodes;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(pi() * (i + 0.75) / (n + 0.5));
    double slope = 1.0;
    for (int step = 0; step < 50; ++step) {
      double p0 = 1.0;
      double p1 = x;
      for (int k = 2; k <= n; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      slope = n * (x * p1 - p0) / (x * x - 1.0);
      const double dx = p1 / slope;
      x -= dx;
      if (std::abs(dx) < 1e-16) break;
    }
    nodes.emplace_back(0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope));
  }
  return nodes;
}

double integrate(const std::function<double(const glm::dvec3&)>& f, const glm::dvec3& axis) {
  static const auto nodes = gaussLegendre(kRings);
  const auto [t, b] = tangents(axis);
  double sum = 0.0;
  for (const auto& [cosine, weight] : nodes) {
    const double sine = std::sqrt(1.0 - cosine * cosine);
    for (int k = 0; k < kSectors; ++k) {
      const double azimuth = 2.0 * pi() * (k + 0.5) / kSectors;
      const glm::dvec3 side = sine * (std::cos(azimuth) * t + std::sin(azimuth) * b);
      sum += weight * (f(side + cosine * axis) + f(side - cosine * axis));
    }
  }
  return sum * 2.0 * pi() / kSectors;
}

Coefficients project(const std::function<double(const glm::dvec3&)>& f, const glm::dvec3& axis) {
  Coefficients c(0.0);
  for (int k = 0; k < 4; ++k) c[k] = integrate([&](const glm::dvec3& w) { return f(w) * basis(w)[k]; }, axis);
  return c;
}

}  // namespace lpv::reference
