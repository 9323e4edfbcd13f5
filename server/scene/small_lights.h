#pragma once
// What follows from a light's size beside a cell: how finely it is voxelized, and whether receivers look at it wherever
// they are. The one rule for the device and for predictions.

#include <cstddef>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace lpv {

/// Cells along the diagonal of a light's box. Up to the first it is small beside a cell: what it sends to surfaces far
/// away changes within a cell, so receivers look at it. From the second on they look it up; in between both have a
/// share of it.
inline constexpr double kSmallBesideACell = 1.0;
inline constexpr double kNotSmall = 1.5;
/// What looking at a tree over triangles (scene/emitter_tree.h) costs from afar, in polygons.
inline constexpr std::size_t kPolygonsOfTree = 16;
/// Polygons that receivers look at wherever they are, at most.
inline constexpr std::size_t kMostLookedAt = 32;
/// Cells along the diagonal of a light that receivers see as VPLs, at least: where the field's cells are larger than
/// that, its own are smaller;
inline constexpr double kLeastCellsAcross = 4.0;
/// by 2^-kMostHalvings at the least.
inline constexpr int kMostHalvings = 10;

/// What says how a light may be looked at.
struct LightSize {
  std::size_t triangles = 0;  ///< flat patches merged
  bool constant = true;  ///< without texture and emission directions
  double cellsAcross = 0.0;  ///< along the diagonal of its box
};

/// Of the scene's emitting lights, in the order of names.
std::vector<LightSize> lightSizes(const Scene& scene, const Grid& grid);

/// Per light, the share of it that receivers get by looking at it, wherever they are; the rest is gathered. Smallest
/// first, while kMostLookedAt lasts: the size of the first light that finds none left is the size from which on nothing
/// is looked at, if that is less than kNotSmall, so that shares are continuous in all sizes.
std::vector<double> lookedAtShares(std::span<const LightSize> lights);

/// Whether nothing is left to gather. Without lights nobody looks.
bool areLookedAtEverywhere(std::span<const double> shares);

/// Whether all lights together are no more than kMostLookedAt, whatever their size.
bool areCheapToLookAt(std::span<const LightSize> lights);

/// Edge of the cells that a light is voxelized in for VPLs, in cells of the field, as far as it goes by size alone.
double voxelEdge(double cellsAcross);

}  // namespace lpv
