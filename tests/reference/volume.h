#pragma once
// From propagated flux to the volume product, and from a volume to irradiance (MATHS.md 1, 3a, 4), in double.

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>

#include "reference/field.h"
#include "scene/grid.h"
#include "scene/options.h"
#include "scene/volume.h"

namespace lpv::reference {

/// SH of incident radiance at cell centres.
struct Product {
  Field incident;
  std::size_t clampedCells = 0;  ///< cells where some colour had phi < 0 or |D| > phi and was cut back
};

/// The volume product of an accumulated propagation: L00 = U0 / (1.5 s^2), L1m = -U1m / (1.5 s^2), then phi >= 0 and
/// |D| <= phi by cutting phi to 0 and shortening D.
Product productOf(const Field& accumulated, double cellEdge);

/// A field as the product's type, rounded to float.
Volume toVolume(const Grid& grid, const Field& field, VolumeStage stage = VolumeStage::kTransported);
/// One layer of a volume as a field.
Field fieldOf(const Volume& volume, std::size_t layer = 0);

/// Fluence and vector irradiance of SH of incident radiance.
double fluenceOf(const Coefficients& incident);
glm::dvec3 vectorIrradianceOf(const Coefficients& incident);

/// E = max(0, phi/4 + D.n/2).
double sh2(const Coefficients& incident, const glm::dvec3& n);
/// E of a uniform cap with the same moments (MATHS.md 4).
double cap(double phi, const glm::dvec3& vectorIrradiance, const glm::dvec3& n);
double cap(const Coefficients& incident, const glm::dvec3& n);

/// Coefficients at a world point: trilinear between cell centres, clamped to the outermost ones up to half a cell
/// outside the grid; nothing beyond.
std::optional<std::array<Coefficients, 3>> trilinear(const Grid& grid, const Field& field, const glm::dvec3& p);
/// Those of the cell that holds p, or of the nearest one within half a cell.
std::optional<std::array<Coefficients, 3>> nearest(const Grid& grid, const Field& field, const glm::dvec3& p);

/// Irradiance at world point p with unit normal n by the chosen lookup (kNearest: nearest cell, then SH2).
std::optional<glm::dvec3> lookup(const Grid& grid, const Field& field, Lookup how, const glm::dvec3& p,
                                 const glm::dvec3& n);

}  // namespace lpv::reference
