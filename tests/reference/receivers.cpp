#include "reference/receivers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "reference/ground_truth.h"
#include "reference/volume.h"

namespace lpv::reference {
namespace {

constexpr int kAcross = 12;
constexpr double kWall = 0.1;  // of the grid's edge

glm::dvec3 inRoom(const Grid& grid, const glm::dvec3& share) {
  return grid.worldFromGrid(glm::mix(glm::dvec3(kWall), glm::dvec3(1.0 - kWall), share) * glm::dvec3(grid.dims));
}

double distanceToSegment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
  return glm::length(p - a - t * along);
}

double dotOf(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += glm::dot(a[i], b[i]);
  return sum;
}

/// ||scale a - b|| / ||b||
double relative(const std::vector<glm::dvec3>& a, double scale, const std::vector<glm::dvec3>& b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) squares += glm::dot(scale * a[i] - b[i], scale * a[i] - b[i]);
  return std::sqrt(squares / dotOf(b, b));
}

}  // namespace

std::vector<Receiver> wallReceivers(const Grid& grid) {
  std::vector<Receiver> out;
  for (int wall = 0; wall < 6; ++wall) {
    const int axis = wall / 2;
    const int upper = wall % 2;
    glm::dvec3 normal(0.0);
    normal[axis] = upper ? -1.0 : 1.0;
    for (int i = 0; i < kAcross * kAcross; ++i) {
      glm::dvec3 share;
      share[axis] = upper;
      share[(axis + 1) % 3] = (i % kAcross + 0.5) / kAcross;
      share[(axis + 2) % 3] = (i / kAcross + 0.5) / kAcross;
      out.push_back({inRoom(grid, share), normal});
    }
  }
  return out;
}

std::vector<Receiver> objectReceivers(const Grid& grid, const std::vector<Emitter>& emitters, std::size_t count,
                                      std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::normal_distribution<double> normal;
  std::vector<Receiver> out;
  for (std::size_t tries = 0; out.size() < count; ++tries) {
    if (tries > 1000 * count) throw std::invalid_argument("objectReceivers: no room two cells away from the emitters");
    const double x = share(random), y = share(random), z = share(random);
    const double nx = normal(random), ny = normal(random), nz = normal(random);
    const glm::dvec3 p = inRoom(grid, {x, y, z});
    const bool close = std::any_of(emitters.begin(), emitters.end(), [&](const Emitter& e) {
      return distanceToTriangle(p, e.corners) < 2.0 * grid.cell;
    });
    if (!close) out.push_back({p, glm::normalize(glm::dvec3(nx, ny, nz))});
  }
  return out;
}

double distanceToTriangle(const glm::dvec3& p, const std::array<glm::dvec3, 3>& c) {
  const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
  bool above = glm::length(normal) > 0.0;  // over the triangle itself rather than beyond an edge
  double nearest = std::abs(glm::dot(p - c[0], normal)) / glm::length(normal);
  for (std::size_t k = 0; k < 3; ++k) {
    above = above && glm::dot(glm::cross(normal, c[(k + 1) % 3] - c[k]), p - c[k]) >= 0.0;
  }
  if (above) return nearest;
  nearest = distanceToSegment(p, c[0], c[1]);
  return std::min({nearest, distanceToSegment(p, c[1], c[2]), distanceToSegment(p, c[2], c[0])});
}

std::vector<glm::dvec3> irradiances(const std::vector<Emitter>& emitters, const std::vector<Receiver>& receivers) {
  std::vector<glm::dvec3> out;
  for (const Receiver& r : receivers) out.push_back(irradianceOf(emitters, r.position, r.normal));
  return out;
}

std::vector<glm::dvec3> irradiances(const Grid& grid, const Field& field, Lookup how,
                                    const std::vector<Receiver>& receivers) {
  std::vector<glm::dvec3> out;
  for (const Receiver& r : receivers)
    out.push_back(lookup(grid, field, how, r.position, r.normal).value_or(glm::dvec3(0.0)));
  return out;
}

namespace {

/// |ln(a / b)|, sorted.
std::vector<double> logRatios(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b) {
  const auto sum = [](const glm::dvec3& c) { return c.r + c.g + c.b; };
  double mean = 0.0;
  for (const glm::dvec3& c : b) mean += sum(c) / double(b.size());
  std::vector<double> out;
  for (std::size_t i = 0; i < a.size(); ++i) {
    out.push_back(std::abs(std::log(std::max(sum(a[i]), 0.01 * mean) / std::max(sum(b[i]), 0.01 * mean))));
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

Errors errors(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b) {
  if (a.size() != b.size()) throw std::invalid_argument("errors: lists of different lengths");
  const double own = dotOf(a, a);
  Errors out{relative(a, 1.0, b), relative(a, own > 0.0 ? dotOf(a, b) / own : 0.0, b)};
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const glm::dvec3 apart = glm::abs(a[i] - b[i]);
    for (int k = 0; k < 3; ++k) {
      // A NaN must not pass for agreement.
      out.worst = std::isnan(apart[k]) ? std::numeric_limits<double>::infinity() : std::max(out.worst, apart[k]);
      largest = std::max(largest, b[i][k]);
    }
  }
  out.worst /= largest;
  const std::vector<double> ratios = logRatios(a, b);
  if (ratios.empty()) return out;
  out.logRatio95 = ratios[std::size_t(0.95 * double(ratios.size() - 1))];
  out.logRatio99 = ratios[std::size_t(0.99 * double(ratios.size() - 1))];
  return out;
}

}  // namespace lpv::reference
