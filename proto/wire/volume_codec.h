#pragma once
// Volumes to and from the parts of lpv/v1/result.proto: bricks of 8^3 cells, cut at the grid's upper borders.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "scene/grid.h"
#include "scene/status.h"
#include "scene/volume.h"

namespace lpv::wire {

/// Edge of a brick, cells.
inline constexpr int kBrickEdge = 8;
/// Layers of a volume at most.
inline constexpr int kMaxLayers = 8;

/// What a coefficient is on the wire, little-endian.
enum class Element {
  kHalf,   ///< IEEE half; value = half x the layer's scale
  kFloat,  ///< float32; scale 1
};

/// Bytes of one element: 2 or 4.
std::size_t elementBytes(Element element);

/// Consecutive bricks; numbered x fastest over ceil(dims / 8).
struct BrickRun {
  int first = 0;
  int count = 0;
};

/// One message's worth of a volume.
struct Part {
  std::vector<BrickRun> bricks;
  std::string payload;  ///< per brick, per layer, per cell (x fastest), per colour: 4 elements
};

struct EncodedVolume {
  std::vector<double> scales;  ///< per layer; a power of two
  std::uint64_t checksum = 0;  ///< XXH64 of all elements: layers in order, cells x fastest, colour, coefficient
  std::vector<Part> parts;     ///< together every brick once, in order
};

/// Number of bricks of a grid.
int brickCount(const glm::ivec3& dims);

/// A volume as parts of at most `maxPayloadBytes` (at least one brick each). Halves are scaled per layer by a power of
/// two so that the largest magnitude lies in (512, 1024]: 24 binary orders below it keep the full 11 bits. A layer of
/// zeros has scale 1. The volume is a valid one: 1..8 layers, each with cells x 12 coefficients.
EncodedVolume encodeVolume(const Volume& volume, Element element, std::size_t maxPayloadBytes);

/// Puts one volume together from its parts, in any order. Checks everything: whatever a server sends, the worst is an
/// error. Memory is touched as parts arrive, whatever the header announced.
class VolumeDecoder {
 public:
  /// `groups` and `scales` name the layers. A grid, layer or scale out of range is reported by add and finish.
  VolumeDecoder(Grid grid, VolumeStage stage, Element element, std::vector<std::string> groups,
                std::vector<double> scales);

  /// INVALID_ARGUMENT for bricks out of range or seen before, and for a payload of another size than theirs.
  Status add(const std::vector<BrickRun>& bricks, const std::string& payload);

  /// The volume; INVALID_ARGUMENT where bricks are missing or the checksum is another. Ends the decoder.
  Expected<Volume> finish(std::uint64_t checksum);

 private:
  Status claim(const std::vector<BrickRun>& bricks, std::size_t payloadBytes);
  std::size_t layerBytes() const;

  Grid grid_;
  VolumeStage stage_;
  Element element_;
  std::vector<std::string> groups_;
  std::vector<double> scales_;
  Status status_;                                ///< why this decoder accepts nothing
  std::vector<bool> seen_;                       ///< per brick
  int missing_ = 0;                              ///< bricks not seen
  std::unique_ptr<unsigned char[]> elements_;    ///< layers in order, in the checksum's order
};

/// XXH64, seed 0.
std::uint64_t checksumBytes(const void* data, std::size_t size);

}  // namespace lpv::wire
