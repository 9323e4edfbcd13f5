#pragma once
// A published volume as everybody who has it holds it: bit for bit the same at the server, which made it, and at every
// client, whichever results it took to get there. What deltas are relative to.

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

/// Layers of a volume at most.
inline constexpr int kMaxLayers = 8;
/// Elements of one cell: 3 colours x 4.
inline constexpr std::size_t kCellElements = 12;

/// What an element is on the wire, little-endian (VolumeFormat of result.proto).
enum class Format {
  kHalf,     ///< IEEE half; value = half x the layer's scale
  kFloat,    ///< float32; scale 1
  kCompact,  ///< int16: a level and three ratios (wire/compact.h)
};

/// Bytes of one element: 2 or 4.
std::size_t elementBytes(Format format);

/// What two volumes must share for one to be relative to the other.
struct VolumeShape {
  Format format = Format::kHalf;
  Grid grid;
  VolumeStage stage = VolumeStage::kTransported;
  std::vector<std::string> groups;  ///< 1..8 layers
  std::vector<double> scales;       ///< per layer, > 0

  bool operator==(const VolumeShape&) const = default;
  std::size_t layers() const { return groups.size(); }
};

/// INVALID_ARGUMENT for a grid, layers or scales out of range.
Status checkShape(const VolumeShape& shape);

/// The content of one brick.
struct Brick {
  std::string elements;                    ///< per layer, per cell (x fastest), per colour: 4 elements
  std::vector<std::int32_t> coefficients;  ///< kCompact: per layer, what the elements come from (brick_transform.h)
};
using BrickPtr = std::shared_ptr<const Brick>;

/// kCompact: sets a brick's elements, cells of `size` each, to what its coefficients give.
void setCompactElements(const glm::ivec3& size, std::size_t layers, Brick* brick);

/// Immutable; bricks that did not change are shared with the state before. A null brick is all zeros.
struct VolumeState {
  VolumeShape shape;
  std::vector<BrickPtr> bricks;
};
using VolumeStatePtr = std::shared_ptr<const VolumeState>;

/// XXH64 (seed 0) of all elements: layers in order, cells x fastest, colour, element; zeros where no brick is.
std::uint64_t checksumOf(const VolumeState& state);

/// The light it stands for.
Volume volumeFrom(const VolumeState& state);

/// Coefficients, as in Volume, of one brick's cells: per layer, per cell: 12.
std::vector<float> brickFloats(const VolumeShape& shape, const Brick* brick, std::size_t cells);

/// The same state with only the chosen bricks; the others are zeros.
VolumeState onlyBricks(const VolumeState& state, const std::vector<bool>& chosen);

/// XXH64, seed 0.
std::uint64_t checksumBytes(const void* data, std::size_t size);

}  // namespace lpv::wire
