#pragma once
// A published volume: bit for bit the same at the server and at every subscriber that holds it, whichever sequence of
// deltas it arrived by. Deltas are differences between two published volumes.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/status.h"
#include "scene/grid.h"
#include "scene/volume.h"
#include "wire/bricks.h"

namespace lpv::wire {

/// Largest number of layers.
inline constexpr int kMaxLayers = 8;
/// Elements of one cell: 3 colours x 4.
inline constexpr std::size_t kCellElements = 12;

/// Type of an element on the wire, little-endian (VolumeFormat of result.proto).
enum class Format {
  kHalf,     ///< IEEE half; value = half x the layer's scale
  kFloat,    ///< float32; scale 1
  kCompact,  ///< int16: a level and three ratios (wire/compact.h)
};

/// Bytes of one element: 2 or 4.
std::size_t elementBytes(Format format);

/// Everything that a volume and its base must have in common.
struct VolumeShape {
  Format format = Format::kHalf;
  Grid grid;
  VolumeStage stage = VolumeStage::kTransported;
  std::vector<std::string> groups;  ///< 1..8 layers
  std::vector<double> scales;       ///< per layer, > 0

  bool operator==(const VolumeShape&) const = default;
  std::size_t layers() const { return groups.size(); }
};

/// INVALID_ARGUMENT if the grid, the number of layers or a scale is out of range.
Status checkShape(const VolumeShape& shape);

/// The content of one brick.
struct Brick {
  std::string elements;                    ///< per layer, per cell (x fastest), per colour: 4 elements
  std::vector<std::int32_t> coefficients;  ///< kCompact: per layer, the transform's input (brick_transform.h)
};
using BrickPtr = std::shared_ptr<const Brick>;

/// kCompact: computes a brick's elements from its coefficients. `size`: the brick's cells along x, y, z.
void setCompactElements(const glm::ivec3& size, std::size_t layers, Brick* brick);

/// Immutable. Bricks that did not change are shared with the state before. A null brick stands for zeros.
struct VolumeState {
  VolumeShape shape;
  std::vector<BrickPtr> bricks;
};
using VolumeStatePtr = std::shared_ptr<const VolumeState>;

/// XXH64 (seed 0) of all elements in order of layer, cell (x fastest), colour, element; null bricks count as zeros.
std::uint64_t checksumOf(const VolumeState& state);

/// The SH coefficients that the state decodes to.
Volume volumeFrom(const VolumeState& state);

/// One brick decoded: 12 SH coefficients per layer and cell, as in Volume. A null brick gives zeros.
std::vector<float> brickFloats(const VolumeShape& shape, const Brick* brick, std::size_t cells);

/// A copy in which all bricks but the chosen ones are null.
VolumeState onlyBricks(const VolumeState& state, const std::vector<bool>& chosen);

/// XXH64, seed 0.
std::uint64_t checksumBytes(const void* data, std::size_t size);

}  // namespace lpv::wire
