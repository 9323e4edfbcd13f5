#include "lpv/transport/sectors.h"

#include <algorithm>
#include <cmath>

#include "shaders/layout.h"

namespace lpv {

static_assert(kSectors == layout::kSectors && int(Sectors::kAroundZ) == LPV_SECTORS_AROUND_Z);

namespace {

/// Of the light at this sine above a border, what is in the upper sector.
double upperShare(double sine) {
  const double t = std::clamp(0.5 + 0.5 / double(layout::kSectorBorder) * sine, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

std::array<double, kSectors> sectorShares(Sectors how, const glm::dvec3& towards) {
  const glm::dvec3 w = glm::normalize(towards);
  glm::dvec3 sides = w;
  if (how == Sectors::kAroundX) sides = {w.y, w.z, w.x};
  if (how == Sectors::kAroundY) sides = {w.z, w.x, w.y};
  if (how != Sectors::kOctants) sides.z = std::sqrt(0.5) * (std::abs(sides.x) - std::abs(sides.y));
  const glm::dvec3 upper(upperShare(sides.x), upperShare(sides.y), upperShare(sides.z));
  std::array<double, kSectors> shares{};
  for (int sector = 0; sector < kSectors; ++sector) {
    const glm::dvec3 of = glm::mix(1.0 - upper, upper, glm::dvec3(sector & 1, sector >> 1 & 1, sector >> 2));
    shares[std::size_t(sector)] = of.x * of.y * of.z;
  }
  return shares;
}

}  // namespace lpv
