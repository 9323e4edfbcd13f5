#include "wire/volume_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "wire/half.h"

namespace lpv::wire {
namespace {

static_assert(std::endian::native == std::endian::little, "elements are written as the machine holds them");

/// Elements of one cell: 3 colours x 4 coefficients.
constexpr std::size_t kCellElements = 12;
/// The largest magnitude of a layer maps to (kHalfTarget / 2, kHalfTarget].
constexpr double kHalfTarget = 1024.0;
constexpr int kMinScaleExponent = -120;  // 1 / scale is still a float

glm::ivec3 brickDims(const glm::ivec3& dims) { return (dims + (kBrickEdge - 1)) / kBrickEdge; }

/// The cells of one brick: [first, end).
struct BrickBox {
  glm::ivec3 first{0};
  glm::ivec3 end{0};

  std::size_t cells() const {
    const glm::ivec3 n = end - first;
    return std::size_t(n.x) * std::size_t(n.y) * std::size_t(n.z);
  }
};

BrickBox brickBox(const glm::ivec3& dims, int brick) {
  const glm::ivec3 n = brickDims(dims);
  const glm::ivec3 first = glm::ivec3(brick % n.x, brick / n.x % n.y, brick / (n.x * n.y)) * kBrickEdge;
  return {first, glm::min(first + kBrickEdge, dims)};
}

/// Calls row(first cell's index, number of cells) for each row of the brick in the payload's order.
template <typename Row>
void forEachRow(const Grid& grid, const BrickBox& box, const Row& row) {
  const auto cells = std::size_t(box.end.x - box.first.x);
  for (int z = box.first.z; z < box.end.z; ++z) {
    for (int y = box.first.y; y < box.end.y; ++y) row(grid.index({box.first.x, y, z}), cells);
  }
}

double scaleFor(const std::vector<float>& coefficients) {
  float largest = 0.0F;
  for (const float c : coefficients) {
    const float magnitude = std::abs(c);
    if (std::isfinite(magnitude)) largest = std::max(largest, magnitude);
  }
  if (largest == 0.0F) return 1.0;
  int exponent = 0;
  const double mantissa = std::frexp(double(largest) / kHalfTarget, &exponent);  // in [.5, 1)
  if (mantissa == 0.5) --exponent;                                               // exactly a power of two
  return std::ldexp(1.0, std::max(exponent, kMinScaleExponent));
}

/// All layers as elements, in the checksum's order.
std::string elementsOf(const Volume& volume, Element element, const std::vector<double>& scales) {
  const std::size_t count = volume.grid.cells() * kCellElements;
  std::string out(volume.layers.size() * count * elementBytes(element), '\0');
  char* to = out.data();
  std::vector<std::uint16_t> halves(element == Element::kHalf ? count : 0);
  for (std::size_t layer = 0; layer < volume.layers.size(); ++layer) {
    const void* from = volume.layers[layer].coefficients.data();
    if (element == Element::kHalf) {
      halvesFromFloats(volume.layers[layer].coefficients.data(), count, float(1.0 / scales[layer]), halves.data());
      from = halves.data();
    }
    std::memcpy(to, from, count * elementBytes(element));
    to += count * elementBytes(element);
  }
  return out;
}

void appendBrick(const Grid& grid, std::size_t layers, std::size_t cellBytes, const std::string& elements, int brick,
                 std::string& payload) {
  const BrickBox box = brickBox(grid.dims, brick);
  for (std::size_t layer = 0; layer < layers; ++layer) {
    const char* from = elements.data() + layer * grid.cells() * cellBytes;
    forEachRow(grid, box, [&](std::size_t cell, std::size_t cells) {
      payload.append(from + cell * cellBytes, cells * cellBytes);
    });
  }
}

Status checkGrid(const Grid& grid) {
  for (int axis = 0; axis < 3; ++axis) {
    if (grid.dims[axis] < 1 || grid.dims[axis] > kMaxCellsPerAxis) {
      return invalid("grid.dims", "the volume has " + std::to_string(grid.dims[axis]) + " cells along axis " +
                                      std::to_string(axis) + "; 1.." + std::to_string(kMaxCellsPerAxis) +
                                      " are possible");
    }
    if (!std::isfinite(grid.origin[axis])) return invalid("grid.origin", "the volume's origin is not finite");
  }
  if (!std::isfinite(grid.cell) || grid.cell <= 0.0) return invalid("grid.cell_size", "the volume's cell has no size");
  return {};
}

Status checkLayers(const std::vector<std::string>& groups, const std::vector<double>& scales) {
  if (groups.empty() || groups.size() > kMaxLayers || scales.size() != groups.size()) {
    return invalid("layers", "the volume has " + std::to_string(groups.size()) + " layers and " +
                                 std::to_string(scales.size()) + " scales; 1..8 of both are possible");
  }
  for (const double scale : scales) {
    if (!(scale > 0.0) || !std::isfinite(float(scale)))
      return invalid("layers.scale", "a layer's scale is not positive");
  }
  return {};
}

}  // namespace

std::size_t elementBytes(Element element) { return element == Element::kHalf ? 2 : 4; }

int brickCount(const glm::ivec3& dims) {
  const glm::ivec3 n = brickDims(dims);
  return n.x * n.y * n.z;
}

EncodedVolume encodeVolume(const Volume& volume, Element element, std::size_t maxPayloadBytes) {
  EncodedVolume out;
  for (const VolumeLayer& layer : volume.layers) {
    out.scales.push_back(element == Element::kHalf ? scaleFor(layer.coefficients) : 1.0);
  }
  const std::string elements = elementsOf(volume, element, out.scales);
  out.checksum = checksumBytes(elements.data(), elements.size());

  const std::size_t cellBytes = kCellElements * elementBytes(element);
  const int bricks = brickCount(volume.grid.dims);
  for (int brick = 0; brick < bricks; ++brick) {
    const std::size_t bytes = brickBox(volume.grid.dims, brick).cells() * volume.layers.size() * cellBytes;
    if (out.parts.empty() || out.parts.back().payload.size() + bytes > maxPayloadBytes) {
      out.parts.push_back({{{brick, 0}}, {}});
      out.parts.back().payload.reserve(std::min(maxPayloadBytes, elements.size()));
    }
    ++out.parts.back().bricks.back().count;
    appendBrick(volume.grid, volume.layers.size(), cellBytes, elements, brick, out.parts.back().payload);
  }
  return out;
}

VolumeDecoder::VolumeDecoder(Grid grid, VolumeStage stage, Element element, std::vector<std::string> groups,
                             std::vector<double> scales)
    : grid_(grid), stage_(stage), element_(element), groups_(std::move(groups)), scales_(std::move(scales)) {
  status_ = checkGrid(grid_);
  if (status_.ok()) status_ = checkLayers(groups_, scales_);
  if (!status_.ok()) return;
  missing_ = brickCount(grid_.dims);
  seen_.assign(std::size_t(missing_), false);
  elements_ = std::make_unique_for_overwrite<unsigned char[]>(layerBytes() * groups_.size());
}

std::size_t VolumeDecoder::layerBytes() const { return grid_.cells() * kCellElements * elementBytes(element_); }

/// Marks the bricks as seen, or changes nothing.
Status VolumeDecoder::claim(const std::vector<BrickRun>& bricks, std::size_t payloadBytes) {
  const int total = int(seen_.size());
  std::vector<bool> seen = seen_;
  std::size_t cells = 0;
  int claimed = 0;
  for (const BrickRun& run : bricks) {
    if (run.first < 0 || run.count < 1 || run.first >= total || run.count > total - run.first) {
      return invalid("part.bricks", "bricks " + std::to_string(run.first) + " + " + std::to_string(run.count) +
                                        " are outside the volume's " + std::to_string(total));
    }
    for (int brick = run.first; brick < run.first + run.count; ++brick) {
      if (seen[std::size_t(brick)]) return invalid("part.bricks", "brick " + std::to_string(brick) + " comes twice");
      seen[std::size_t(brick)] = true;
      cells += brickBox(grid_.dims, brick).cells();
      ++claimed;
    }
  }
  const std::size_t wanted = cells * groups_.size() * kCellElements * elementBytes(element_);
  if (payloadBytes != wanted) {
    return invalid("part.payload", "the payload has " + std::to_string(payloadBytes) + " bytes, its bricks need " +
                                       std::to_string(wanted));
  }
  seen_ = std::move(seen);
  missing_ -= claimed;
  return {};
}

Status VolumeDecoder::add(const std::vector<BrickRun>& bricks, const std::string& payload) {
  if (!status_.ok()) return status_;
  if (Status claimed = claim(bricks, payload.size()); !claimed.ok()) return claimed;
  const std::size_t cellBytes = kCellElements * elementBytes(element_);
  const char* from = payload.data();
  for (const BrickRun& run : bricks) {
    for (int brick = run.first; brick < run.first + run.count; ++brick) {
      const BrickBox box = brickBox(grid_.dims, brick);
      for (std::size_t layer = 0; layer < groups_.size(); ++layer) {
        unsigned char* to = elements_.get() + layer * layerBytes();
        forEachRow(grid_, box, [&](std::size_t cell, std::size_t cells) {
          std::memcpy(to + cell * cellBytes, from, cells * cellBytes);
          from += cells * cellBytes;
        });
      }
    }
  }
  return {};
}

Expected<Volume> VolumeDecoder::finish(std::uint64_t checksum) {
  if (!status_.ok()) return status_;
  if (missing_ != 0) return invalid("part.bricks", std::to_string(missing_) + " bricks of the volume did not come");
  if (checksumBytes(elements_.get(), layerBytes() * groups_.size()) != checksum) {
    return invalid("result.checksum", "the volume's bytes do not give the checksum sent with it");
  }
  Volume volume{grid_, stage_, {}, nullptr};
  const std::size_t count = grid_.cells() * kCellElements;
  for (std::size_t layer = 0; layer < groups_.size(); ++layer) {
    VolumeLayer& out = volume.layers.emplace_back(VolumeLayer{std::move(groups_[layer]), {}});
    out.coefficients.resize(count);
    const unsigned char* from = elements_.get() + layer * layerBytes();
    if (element_ == Element::kHalf) {
      floatsFromHalves(reinterpret_cast<const std::uint16_t*>(from), count, float(scales_[layer]),
                       out.coefficients.data());
    } else {
      std::memcpy(out.coefficients.data(), from, layerBytes());
      for (float& c : out.coefficients) c *= float(scales_[layer]);
    }
  }
  status_ = Status(Code::kFailedPrecondition, "the volume has been taken");
  elements_.reset();
  return volume;
}

}  // namespace lpv::wire
