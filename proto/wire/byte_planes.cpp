#include "wire/byte_planes.h"

#include <cstdint>
#include <cstring>
#include <type_traits>

namespace lpv::wire {
namespace {

/// Elements as unsigned integers of their size; differences wrap around.
template <typename Word>
class PlaneCoder {
 public:
  PlaneCoder(std::size_t layers, const std::vector<PlaneBrick>& bricks) : layers_(layers), bricks_(bricks) {
    for (const PlaneBrick& brick : bricks) cells_ += layers * cellsOf(brick);
  }

  std::string pack() const {
    std::string out(cells_ * kCellElements * sizeof(Word), '\0');
    forEachBlock([&](const PlaneBrick& brick, std::size_t first, std::size_t kind, std::size_t at) {
      const std::vector<Word> now = differences(brick, first, kind);
      for (std::size_t i = 0; i < now.size(); ++i) {
        const Word off = Word(now[i] - neighbour(brick, now, i));
        const auto zigzag = Word(Word(off << 1U) ^ Word(Word(0) - Word(off >> kTopBit)));
        for (std::size_t byte = 0; byte < sizeof(Word); ++byte) {
          out[plane(kind, byte) + at + i] = char(zigzag >> (8 * byte));
        }
      }
    });
    return out;
  }

  void unpack(const std::string& planes) const {
    forEachBlock([&](const PlaneBrick& brick, std::size_t first, std::size_t kind, std::size_t at) {
      std::vector<Word> now(cellsOf(brick));
      for (std::size_t i = 0; i < now.size(); ++i) {
        Word zigzag = 0;
        for (std::size_t byte = 0; byte < sizeof(Word); ++byte) {
          zigzag = Word(zigzag | Word(Word(std::uint8_t(planes[plane(kind, byte) + at + i])) << (8 * byte)));
        }
        const auto off = Word(Word(zigzag >> 1U) ^ Word(Word(0) - Word(zigzag & 1U)));
        now[i] = Word(off + neighbour(brick, now, i));
        const Word value = Word(now[i] + baseAt(brick, first + i, kind));
        std::memcpy(brick.to->data() + offset(first + i, kind), &value, sizeof(Word));
      }
    });
  }

 private:
  static constexpr unsigned kTopBit = 8 * sizeof(Word) - 1;

  static std::size_t cellsOf(const PlaneBrick& b) {
    return std::size_t(b.size.x) * std::size_t(b.size.y) * std::size_t(b.size.z);
  }
  static std::size_t offset(std::size_t cell, std::size_t kind) { return (cell * kCellElements + kind) * sizeof(Word); }
  std::size_t plane(std::size_t kind, std::size_t byte) const { return (kind * sizeof(Word) + byte) * cells_; }

  static Word baseAt(const PlaneBrick& brick, std::size_t cell, std::size_t kind) {
    Word value = 0;
    if (brick.base != nullptr) std::memcpy(&value, brick.base->elements.data() + offset(cell, kind), sizeof(Word));
    return value;
  }

  static std::vector<Word> differences(const PlaneBrick& brick, std::size_t first, std::size_t kind) {
    std::vector<Word> out(cellsOf(brick));
    for (std::size_t i = 0; i < out.size(); ++i) {
      Word value = 0;
      std::memcpy(&value, brick.from->data() + offset(first + i, kind), sizeof(Word));
      out[i] = Word(value - baseAt(brick, first + i, kind));
    }
    return out;
  }

  /// Value that predicts cell `i`: the cell before it along x; for the first cell of a row along y, of a slice along z.
  static Word neighbour(const PlaneBrick& brick, const std::vector<Word>& values, std::size_t i) {
    const auto row = std::size_t(brick.size.x);
    const std::size_t slice = row * std::size_t(brick.size.y);
    const std::size_t back = i % row != 0 ? 1 : i % slice != 0 ? row : slice;
    return i < back ? Word(0) : values[i - back];
  }

  /// Calls block(brick, index of a layer's first cell in the brick, element 0..11, offset of its cells in a plane).
  template <typename Block>
  void forEachBlock(const Block& block) const {
    for (std::size_t kind = 0; kind < kCellElements; ++kind) {
      std::size_t at = 0;
      for (const PlaneBrick& brick : bricks_) {
        for (std::size_t layer = 0; layer < layers_; ++layer, at += cellsOf(brick)) {
          block(brick, layer * cellsOf(brick), kind, at);
        }
      }
    }
  }

  std::size_t layers_;
  const std::vector<PlaneBrick>& bricks_;
  std::size_t cells_ = 0;  ///< of all bricks and layers
};

}  // namespace

std::string planesFrom(const VolumeShape& shape, const std::vector<PlaneBrick>& bricks) {
  return shape.format == Format::kFloat ? PlaneCoder<std::uint32_t>(shape.layers(), bricks).pack()
                                        : PlaneCoder<std::uint16_t>(shape.layers(), bricks).pack();
}

void elementsFromPlanes(const VolumeShape& shape, const std::string& planes, const std::vector<PlaneBrick>& bricks) {
  if (shape.format == Format::kFloat) return PlaneCoder<std::uint32_t>(shape.layers(), bricks).unpack(planes);
  PlaneCoder<std::uint16_t>(shape.layers(), bricks).unpack(planes);
}

}  // namespace lpv::wire
