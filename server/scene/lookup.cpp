#include "scene/lookup.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lpv {
namespace {

using ColourCoefficients = std::array<sh::Coefficients, 3>;

ColourCoefficients cellAt(const VolumeLayer& layer, const Grid& grid, const glm::ivec3& cell) {
  return {Volume::at(layer, grid, cell, 0), Volume::at(layer, grid, cell, 1), Volume::at(layer, grid, cell, 2)};
}

/// Trilinear between cell centres, clamped to the outermost ones. `g` in grid space.
ColourCoefficients trilinear(const VolumeLayer& layer, const Grid& grid, const glm::dvec3& g) {
  const glm::dvec3 top(grid.dims - 1);
  const glm::dvec3 centred = glm::clamp(g - 0.5, glm::dvec3(0.0), top);
  const glm::ivec3 low = glm::min(glm::ivec3(glm::floor(centred)), glm::max(grid.dims - 2, glm::ivec3(0)));
  const glm::dvec3 f = centred - glm::dvec3(low);
  ColourCoefficients sum{};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 offset(corner & 1, (corner >> 1) & 1, corner >> 2);
    const glm::dvec3 axis = glm::mix(1.0 - f, f, glm::dvec3(offset));
    const double weight = axis.x * axis.y * axis.z;
    if (weight == 0.0) continue;
    const ColourCoefficients cell = cellAt(layer, grid, glm::min(low + offset, grid.dims - 1));
    for (int colour = 0; colour < 3; ++colour) sum[std::size_t(colour)] += weight * cell[std::size_t(colour)];
  }
  return sum;
}

/// What a cap that the horizon cuts gives beyond D max(0, cos tilt), as a share of |D|: nothing where it is all above
/// or all below. With a its half-angle, m = |cos tilt| / sin a and q = sqrt(1 - m^2), MATHS.md 4 becomes, for both
/// signs of cos tilt, ((atan2(q sin a, cos a) - q sin a cos a) / sin^2 a - |cos tilt| atan2(q, m cos a)) / pi: neither
/// the tilt's sine nor an arc cosine, which lose digits where little light is left.
double shareAcrossHorizon(double sine2, double cosine, double cosTilt) {
  if (sine2 < 1e-6 || cosTilt * cosTilt >= sine2) return 0.0;
  const double sine = std::sqrt(sine2);
  const double m = std::abs(cosTilt) / sine;
  const double q = std::sqrt((1.0 - m) * (1.0 + m));
  const double segment = (std::atan2(q * sine, cosine) - q * sine * cosine) / sine2;
  return std::max(0.0, segment - std::abs(cosTilt) * std::atan2(q, m * cosine)) / sh::kPi;
}

/// Whether nothing has to be clamped.
bool isBetweenCentres(const Grid& grid, const glm::dvec3& p) {
  const glm::dvec3 g = grid.gridFromWorld(p);
  return glm::all(glm::greaterThanEqual(g, glm::dvec3(0.5))) &&
         glm::all(glm::lessThanEqual(g, glm::dvec3(grid.dims) - 0.5));
}

double irradiance(Lookup lookup, const sh::Coefficients& incident, const glm::dvec3& n) {
  return lookup == Lookup::kCap ? irradianceCap(incident, n) : irradianceSh2(incident, n);
}

}  // namespace

double irradianceSh2(const sh::Coefficients& incident, const glm::dvec3& n) {
  return std::max(0.0, sh::fluence(incident) / 4.0 + glm::dot(sh::vectorIrradiance(incident), n) / 2.0);
}

double irradianceCap(const sh::Coefficients& incident, const glm::dvec3& n) {
  const double phi = sh::fluence(incident);
  if (!(phi > 0.0)) return 0.0;
  const glm::dvec3 d = sh::vectorIrradiance(incident);
  const double length = glm::length(d);
  // A hemisphere about D and the rest from everywhere: (|D| + D.n)/2 + (phi - 2 |D|)/4.
  if (length < 0.5 * phi) return irradianceSh2(incident, n);
  const double rho = length / phi;  // above 1: as 1, a point
  const double along = glm::dot(d, n);
  return std::max(0.0, along) + length * shareAcrossHorizon(4.0 * rho * (1.0 - rho), 2.0 * rho - 1.0, along / length);
}

namespace {

/// Calls use(coefficients) for each layer; false where the volume has no answer.
template <typename Use>
bool lookUp(const Volume& volume, const std::vector<VolumeLayer>& layers, Lookup lookup, const glm::dvec3& p,
            const Use& use) {
  const glm::dvec3 g = volume.grid.gridFromWorld(p);
  const glm::dvec3 far(volume.grid.dims);
  if (!glm::all(glm::greaterThanEqual(g, glm::dvec3(-0.5))) || !glm::all(glm::lessThanEqual(g, far + 0.5)))
    return false;
  const glm::ivec3 nearest = glm::clamp(glm::ivec3(glm::floor(g)), glm::ivec3(0), volume.grid.dims - 1);
  for (const VolumeLayer& layer : layers)
    use(lookup == Lookup::kNearest ? cellAt(layer, volume.grid, nearest) : trilinear(layer, volume.grid, g));
  return true;
}

Irradiance lookedUp(const Volume& volume, const std::vector<VolumeLayer>& layers, Lookup lookup, const glm::dvec3& p,
                    const glm::dvec3& n) {
  Irradiance out;
  out.valid = lookUp(volume, layers, lookup, p, [&](const ColourCoefficients& c) {
    for (int colour = 0; colour < 3; ++colour) out.rgb[colour] += irradiance(lookup, c[std::size_t(colour)], n);
  });
  return out;
}

}  // namespace

std::optional<std::array<sh::Coefficients, 3>> incidentAt(const Volume& volume, Lookup lookup, const glm::dvec3& p) {
  ColourCoefficients sum{};
  const bool valid = lookUp(volume, volume.layers, lookup, p, [&](const ColourCoefficients& c) {
    for (std::size_t colour = 0; colour < 3; ++colour) sum[colour] += c[colour];
  });
  return valid ? std::optional(sum) : std::nullopt;
}

Irradiance irradianceAt(const Volume& volume, Lookup lookup, const glm::dvec3& p, const glm::dvec3& n) {
  return lookedUp(volume, volume.layers, lookup, p, n);
}

Irradiance irradianceWithNearField(const Volume& volume, Lookup lookup, const glm::dvec3& p, const glm::dvec3& n) {
  double far = 1.0;
  if (volume.direct != nullptr) far = isBetweenCentres(volume.grid, p) ? volume.direct->farFromEmitters(p) : 0.0;
  Irradiance out;
  if (far > 0.0) {
    const bool apart = !volume.lookedUp.empty();
    out = lookedUp(volume, apart ? volume.lookedUp : volume.layers, lookup, p, n);
    if (apart) out.rgb += volume.direct->lookedAt(p, n);
  }
  if (far == 1.0) return out;
  out.rgb = far * out.rgb + (1.0 - far) * volume.direct->irradiance(p, n);
  out.valid = true;
  return out;
}

}  // namespace lpv
