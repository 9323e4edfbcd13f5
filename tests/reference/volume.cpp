#include "reference/volume.h"

#include <algorithm>
#include <cmath>

#include "reference/sh.h"

namespace lpv::reference {
namespace {

/// Cuts one colour back to what light can be; true when it had to.
bool clampMoments(Coefficients& incident) {
  const double phi = fluenceOf(incident);
  const double d = glm::length(vectorIrradianceOf(incident));
  if (phi < 0.0) {
    incident = Coefficients(0.0);
    return true;
  }
  if (d <= phi) return false;
  incident *= Coefficients(1.0, phi / d, phi / d, phi / d);
  return true;
}

/// Grid coordinates of p, or nothing more than half a cell outside.
std::optional<glm::dvec3> gridPoint(const Grid& grid, const glm::dvec3& p) {
  const glm::dvec3 g = (p - grid.origin) / grid.cell;
  for (int k = 0; k < 3; ++k) {
    if (!(g[k] >= -0.5 && g[k] <= grid.dims[k] + 0.5)) return std::nullopt;
  }
  return g;
}

}  // namespace

Product productOf(const Field& accumulated, double cellEdge) {
  Product out{accumulated, 0};
  const double scale = 1.0 / (1.5 * cellEdge * cellEdge);
  for (auto& cell : out.incident.cells) {
    bool clamped = false;
    for (Coefficients& c : cell) {
      c *= Coefficients(scale, -scale, -scale, -scale);
      clamped = clampMoments(c) || clamped;
    }
    if (clamped) ++out.clampedCells;
  }
  return out;
}

Volume toVolume(const Grid& grid, const Field& field, VolumeStage stage) {
  Volume volume;
  volume.grid = grid;
  volume.stage = stage;
  VolumeLayer layer;
  for (const auto& cell : field.cells) {
    for (const Coefficients& c : cell) {
      for (int k = 0; k < 4; ++k) layer.coefficients.push_back(float(c[k]));
    }
  }
  volume.layers.push_back(std::move(layer));
  return volume;
}

Field fieldOf(const Volume& volume, std::size_t layer) {
  Field field(volume.grid.dims);
  std::size_t i = 0;
  for (auto& cell : field.cells) {
    for (Coefficients& c : cell) {
      for (int k = 0; k < 4; ++k) c[k] = double(volume.layers.at(layer).coefficients.at(i++));
    }
  }
  return field;
}

double fluenceOf(const Coefficients& incident) { return incident.x * std::sqrt(4.0 * pi()); }

glm::dvec3 vectorIrradianceOf(const Coefficients& incident) {
  return glm::dvec3(incident.w, incident.y, incident.z) * std::sqrt(4.0 * pi() / 3.0);
}

double sh2(const Coefficients& incident, const glm::dvec3& n) {
  return std::max(0.0, fluenceOf(incident) / 4.0 + glm::dot(vectorIrradianceOf(incident), n) / 2.0);
}

double cap(double phi, const glm::dvec3& vectorIrradiance, const glm::dvec3& n) {
  if (!(phi > 0.0)) return 0.0;
  const double d = glm::length(vectorIrradiance);
  if (d == 0.0) return phi / 4.0;
  const double rho = std::min(1.0, d / phi);
  const double ct = glm::dot(vectorIrradiance, n) / d;
  double s2 = 1.0;
  double radiance = d / pi();
  double isotropic = 0.0;
  if (rho < 0.5) {
    isotropic = (phi - 2.0 * d) / 4.0;
  } else {
    s2 = 4.0 * rho * (1.0 - rho);
    radiance = d / (pi() * s2);
  }
  if (s2 < 1e-6 || ct * ct >= s2) return std::max(0.0, d * std::max(0.0, ct) + isotropic);
  const double x = std::sqrt(1.0 / s2 - 1.0);
  const double st = std::sqrt(std::max(1.0 - ct * ct, 1e-12));
  const double y = std::clamp(-x * ct / st, -1.0, 1.0);
  const double q = st * std::sqrt(1.0 - y * y);
  const double e = radiance * ((ct * std::acos(y) - x * q) * s2 + std::atan2(q, x));
  return std::max(0.0, e + isotropic);
}

double cap(const Coefficients& incident, const glm::dvec3& n) {
  return cap(fluenceOf(incident), vectorIrradianceOf(incident), n);
}

std::optional<std::array<Coefficients, 3>> trilinear(const Grid& grid, const Field& field, const glm::dvec3& p) {
  const std::optional<glm::dvec3> g = gridPoint(grid, p);
  if (!g) return std::nullopt;
  const glm::dvec3 last = glm::dvec3(grid.dims) - 1.0;
  const glm::dvec3 between = glm::clamp(*g - 0.5, glm::dvec3(0.0), last);
  const glm::ivec3 low(glm::floor(between));
  const glm::dvec3 share = between - glm::dvec3(low);
  std::array<Coefficients, 3> sum{};
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    glm::ivec3 cell(0);
    for (int k = 0; k < 3; ++k) {
      const int up = (corner >> k) & 1;
      weight *= up ? share[k] : 1.0 - share[k];
      cell[k] = std::min(low[k] + up, grid.dims[k] - 1);
    }
    for (std::size_t colour = 0; colour < 3; ++colour) sum[colour] += weight * field.at(cell)[colour];
  }
  return sum;
}

std::optional<std::array<Coefficients, 3>> nearest(const Grid& grid, const Field& field, const glm::dvec3& p) {
  const std::optional<glm::dvec3> g = gridPoint(grid, p);
  if (!g) return std::nullopt;
  return field.at(glm::clamp(glm::ivec3(glm::floor(*g)), glm::ivec3(0), grid.dims - 1));
}

std::optional<glm::dvec3> lookup(const Grid& grid, const Field& field, Lookup how, const glm::dvec3& p,
                                 const glm::dvec3& n) {
  const auto found = how == Lookup::kNearest ? nearest(grid, field, p) : trilinear(grid, field, p);
  if (!found) return std::nullopt;
  glm::dvec3 e(0.0);
  for (int colour = 0; colour < 3; ++colour) {
    const Coefficients& c = (*found)[std::size_t(colour)];
    e[colour] = how == Lookup::kCap ? cap(c, n) : sh2(c, n);
  }
  return e;
}

}  // namespace lpv::reference
