#include "wire/volume_state.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "wire/brick_transform.h"
#include "wire/compact.h"
#include "wire/half.h"

namespace lpv::wire {
namespace {

static_assert(std::endian::native == std::endian::little, "elements are written as the machine holds them");

Status checkGrid(const Grid& grid) {
  for (int axis = 0; axis < 3; ++axis) {
    if (grid.dims[axis] < 1 || grid.dims[axis] > kMaxCellsPerAxis) {
      return invalid("grid.dims", "the volume has " + std::to_string(grid.dims[axis]) + " cells along axis " +
                                      std::to_string(axis) + "; allowed are 1.." + std::to_string(kMaxCellsPerAxis));
    }
    if (!std::isfinite(grid.origin[axis])) return invalid("grid.origin", "the grid's origin is not a finite number");
  }
  if (!std::isfinite(grid.cell) || grid.cell <= 0.0)
    return invalid("grid.cell_size", "the cell size is not a positive number");
  return {};
}

void floatsFrom(Format format, const char* elements, std::size_t count, double scale, float* out) {
  if (format == Format::kHalf) {
    floatsFromHalves(reinterpret_cast<const std::uint16_t*>(elements), count, float(scale), out);
  } else if (format == Format::kCompact) {
    floatsFromCompact(reinterpret_cast<const std::int16_t*>(elements), count / 4, scale, out);
  } else {
    std::memcpy(out, elements, count * sizeof(float));
    for (std::size_t i = 0; i < count; ++i) out[i] *= float(scale);
  }
}

}  // namespace

std::size_t elementBytes(Format format) { return format == Format::kFloat ? 4 : 2; }

Status checkShape(const VolumeShape& shape) {
  if (Status s = checkGrid(shape.grid); !s.ok()) return s;
  if (shape.groups.empty() || shape.groups.size() > kMaxLayers || shape.scales.size() != shape.groups.size()) {
    return invalid("layers", "the volume has " + std::to_string(shape.groups.size()) + " layers and " +
                                 std::to_string(shape.scales.size()) + " scales; both must be 1..8 and equal");
  }
  for (const double scale : shape.scales) {
    if (!(scale > 0.0) || !std::isfinite(float(scale)))
      return invalid("layers.scale", "a layer's scale is not a positive number");
  }
  return {};
}

std::uint64_t checksumOf(const VolumeState& state) {
  const VolumeShape& shape = state.shape;
  const std::size_t cellBytes = kCellElements * elementBytes(shape.format);
  const std::size_t layerBytes = shape.grid.cells() * cellBytes;
  std::string all(layerBytes * shape.layers(), '\0');
  for (std::size_t i = 0; i < state.bricks.size(); ++i) {
    if (!state.bricks[i]) continue;
    const char* from = state.bricks[i]->elements.data();
    for (std::size_t layer = 0; layer < shape.layers(); ++layer) {
      forEachRow(shape.grid, brickBox(shape.grid.dims, int(i)), [&](std::size_t cell, std::size_t cells) {
        std::memcpy(all.data() + layer * layerBytes + cell * cellBytes, from, cells * cellBytes);
        from += cells * cellBytes;
      });
    }
  }
  return checksumBytes(all.data(), all.size());
}

std::vector<float> brickFloats(const VolumeShape& shape, const Brick* brick, std::size_t cells) {
  const std::size_t count = cells * kCellElements;
  std::vector<float> out(count * shape.layers(), 0.0F);
  if (brick == nullptr) return out;
  for (std::size_t layer = 0; layer < shape.layers(); ++layer) {
    floatsFrom(shape.format, brick->elements.data() + layer * count * elementBytes(shape.format), count,
               shape.scales[layer], out.data() + layer * count);
  }
  return out;
}

void setCompactElements(const glm::ivec3& size, std::size_t layers, Brick* brick) {
  const auto cells = std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z);
  brick->elements.resize(layers * cells * kCellElements * sizeof(std::int16_t));
  auto* out = reinterpret_cast<std::int16_t*>(brick->elements.data());
  Coefficients<std::int16_t> planes;
  for (std::size_t layer = 0; layer < layers; ++layer) {
    elementsFrom(brick->coefficients.data() + layer * planes.size(), &planes);
    for (std::size_t i = 0; i < kBrickCells; ++i) {
      if (int(i % 8) >= size.x || int(i / 8 % 8) >= size.y || int(i / 64) >= size.z) continue;
      for (std::size_t colour = 0; colour < 3; ++colour) {
        for (std::size_t e = 0; e < 4; ++e) *out++ = planes[(e * 3 + colour) * kBrickCells + i];
      }
    }
  }
}

Volume volumeFrom(const VolumeState& state) {
  const VolumeShape& shape = state.shape;
  Volume volume{shape.grid, shape.stage, {}, nullptr};
  for (const std::string& group : shape.groups) {
    volume.layers.push_back({group, std::vector<float>(shape.grid.cells() * kCellElements, 0.0F)});
  }
  for (std::size_t i = 0; i < state.bricks.size(); ++i) {
    if (!state.bricks[i]) continue;
    const BrickBox box = brickBox(shape.grid.dims, int(i));
    const std::vector<float> floats = brickFloats(shape, state.bricks[i].get(), box.cells());
    const float* from = floats.data();
    for (VolumeLayer& layer : volume.layers) {
      forEachRow(shape.grid, box, [&](std::size_t cell, std::size_t cells) {
        std::memcpy(layer.coefficients.data() + cell * kCellElements, from, cells * kCellElements * sizeof(float));
        from += cells * kCellElements;
      });
    }
  }
  return volume;
}

VolumeState onlyBricks(const VolumeState& state, const std::vector<bool>& chosen) {
  VolumeState out = state;
  for (std::size_t i = 0; i < out.bricks.size(); ++i) {
    if (!chosen[i]) out.bricks[i] = nullptr;
  }
  return out;
}

}  // namespace lpv::wire
