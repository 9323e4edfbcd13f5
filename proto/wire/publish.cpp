#include "wire/publish.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "wire/brick_transform.h"
#include "wire/compact.h"
#include "wire/half.h"

namespace lpv::wire {
namespace {

/// The largest magnitude of a layer of halves maps to (kHalfTarget / 2, kHalfTarget].
constexpr double kHalfTarget = 1024.0;
constexpr int kMinScaleExponent = -120;  // smallest for which 1 / scale is finite as a float
/// The previous scale is kept while it is within this factor of the one the volume would get by itself.
constexpr double kScaleSlack = 2.0;
/// log2 of the step of COMPACT's coefficients, by tolerance class; a brick that needs finer steps gets them.
constexpr int kStepShift[kToleranceClasses] = {2, 3, 4, 5};

/// Rounds to the nearest integer, ties to even, for magnitudes below 2^51: the sum's last bit is worth 1.
double nearestInteger(double value) {
  constexpr double kRounder = 1.5 * 4503599627370496.0;
  return (value + kRounder) - kRounder;
}

double halfScale(double largest) {
  if (largest == 0.0) return 1.0;
  int exponent = 0;
  const double mantissa = std::frexp(largest / kHalfTarget, &exponent);  // in [.5, 1)
  if (mantissa == 0.5) --exponent;                                       // exactly a power of two
  return std::ldexp(1.0, std::max(exponent, kMinScaleExponent));
}

/// Largest magnitude among every stride-th coefficient; infinities and NaN are ignored.
double largestOf(const std::vector<float>& coefficients, std::size_t stride) {
  float largest = 0.0F;
  for (std::size_t i = 0; i < coefficients.size(); i += stride) {
    const float magnitude = std::abs(coefficients[i]);
    if (std::isfinite(magnitude)) largest = std::max(largest, magnitude);
  }
  return double(largest);
}

double scaleFor(const VolumeLayer& layer, Format format) {
  if (format == Format::kHalf) return halfScale(largestOf(layer.coefficients, 1));
  return format == Format::kCompact ? compactScale(largestOf(layer.coefficients, 4)) : 1.0;
}

VolumeShape shapeFor(const Volume& volume, Format format) {
  VolumeShape shape{format, volume.grid, volume.stage, {}, {}};
  for (const VolumeLayer& layer : volume.layers) {
    shape.groups.push_back(layer.group);
    shape.scales.push_back(scaleFor(layer, format));
  }
  return shape;
}

/// `shape` with the scales of `previous` if the two differ in scales only and the old ones are still usable.
VolumeShape keptScales(const VolumeShape& shape, const VolumeShape& previous) {
  VolumeShape kept = shape;
  kept.scales = previous.scales;
  if (kept != previous) return shape;
  for (std::size_t i = 0; i < kept.scales.size(); ++i) {
    const double ratio = shape.scales[i] / kept.scales[i];
    if (ratio > kScaleSlack || ratio < 1.0 / kScaleSlack) return shape;
  }
  return kept;
}

std::vector<float> gather(const Volume& volume, const BrickBox& box) {
  std::vector<float> out;
  out.reserve(box.cells() * kCellElements * volume.layers.size());
  for (const VolumeLayer& layer : volume.layers) {
    forEachRow(volume.grid, box, [&](std::size_t cell, std::size_t cells) {
      const float* from = layer.coefficients.data() + cell * kCellElements;
      out.insert(out.end(), from, from + cells * kCellElements);
    });
  }
  return out;
}

/// Publishes the bricks of one volume.
class Publisher {
 public:
  Publisher(const Volume& volume, VolumeShape shape, int toleranceClass)
      : volume_(volume),
        shape_(std::move(shape)),
        tolerance_(toleranceOf(shape_.format, toleranceClass)),
        class_(toleranceClass) {
    for (const VolumeLayer& layer : volume.layers) dark_.push_back(kDarkest * largestOf(layer.coefficients, 4));
  }

  BrickPtr brick(int index, const BrickPtr& held) const {
    const BrickBox box = brickBox(volume_.grid.dims, index);
    const std::vector<float> truth = gather(volume_, box);
    const bool holds = held != nullptr && class_ > 0 && within(truth, *held, box.cells());
    if (holds) return held;
    BrickPtr next = shape_.format == Format::kCompact ? compact(truth, box, held.get()) : plain(truth);
    return held != nullptr && next->elements == held->elements && next->coefficients == held->coefficients ? held
                                                                                                           : next;
  }

 private:
  /// True when every cell of the brick is within the tolerance.
  bool within(const std::vector<float>& truth, const Brick& brick, std::size_t cells) const {
    const std::vector<float> held = brickFloats(shape_, &brick, cells);
    const std::size_t perLayer = cells * kCellElements;
    for (std::size_t i = 0; i < truth.size(); i += 4) {
      const double allowed = tolerance_ * std::max(double(truth[i]), dark_[i / perLayer]);
      double band1 = 0.0;
      for (std::size_t m = 1; m < 4; ++m) {
        const double off = double(truth[i + m]) - double(held[i + m]);
        band1 += off * off;
      }
      if (std::abs(double(truth[i]) - double(held[i])) > allowed || band1 > 3.0 * allowed * allowed) return false;
    }
    return true;
  }

  BrickPtr plain(const std::vector<float>& truth) const {
    auto brick = std::make_shared<Brick>();
    brick->elements.resize(truth.size() * elementBytes(shape_.format));
    if (shape_.format == Format::kFloat) {
      std::memcpy(brick->elements.data(), truth.data(), brick->elements.size());
      return brick;
    }
    const std::size_t perLayer = truth.size() / shape_.layers();
    for (std::size_t layer = 0; layer < shape_.layers(); ++layer) {
      halvesFromFloats(truth.data() + layer * perLayer, perLayer, float(1.0 / shape_.scales[layer]),
                       reinterpret_cast<std::uint16_t*>(brick->elements.data()) + layer * perLayer);
    }
    return brick;
  }

  /// Moves each coefficient by whole steps to within half a step of its wanted value. Halves the step until every cell
  /// is within the tolerance.
  BrickPtr compact(const std::vector<float>& truth, const BrickBox& box, const Brick* held) const {
    const std::vector<double> wanted = wantedCoefficients(truth, box);
    for (int shift = kStepShift[class_];; --shift) {
      auto brick = std::make_shared<Brick>();
      brick->coefficients.resize(wanted.size());
      const std::int32_t* from = held != nullptr ? held->coefficients.data() : brick->coefficients.data();
      for (std::size_t i = 0; i < wanted.size(); ++i) brick->coefficients[i] = moved(from[i], wanted[i], 1 << shift);
      setCompactElements(box.size(), shape_.layers(), brick.get());
      if (shift == 0 || within(truth, *brick, box.cells())) return brick;
    }
  }

  /// `from` plus the whole number of steps that brings it within half a step of `to`.
  static std::int32_t moved(std::int32_t from, double to, int step) {
    const double steps = (to - from) * (1.0 / step);  // a power of two
    const double next = from + step * nearestInteger(steps);
    return std::int32_t(std::min(std::max(next, -double(kMaxCoefficient)), double(kMaxCoefficient)));
  }

  /// Coefficients of the volume, not rounded. Cells beyond the grid repeat the last cells inside: the fewest bytes.
  std::vector<double> wantedCoefficients(const std::vector<float>& truth, const BrickBox& box) const {
    std::vector<double> out(shape_.layers() * kChannels * kBrickCells);
    Coefficients<double> elements;
    Coefficients<double> coefficients;
    for (std::size_t layer = 0; layer < shape_.layers(); ++layer) {
      const float* cells = truth.data() + layer * box.cells() * kCellElements;
      for (std::size_t i = 0; i < kBrickCells; ++i) {
        const glm::ivec3 at = glm::min(glm::ivec3(i % 8, i / 8 % 8, i / 64), box.size() - 1);
        const auto cell = std::size_t((at.z * box.size().y + at.y) * box.size().x + at.x);
        for (std::size_t colour = 0; colour < 3; ++colour) {
          double four[4];
          compactFrom(cells + cell * kCellElements + colour * 4, shape_.scales[layer], four);
          for (std::size_t e = 0; e < 4; ++e) elements[(e * 3 + colour) * kBrickCells + i] = four[e];
        }
      }
      coefficientsFrom(elements, &coefficients);
      std::copy(coefficients.begin(), coefficients.end(), out.begin() + std::ptrdiff_t(layer * coefficients.size()));
    }
    return out;
  }

  const Volume& volume_;
  VolumeShape shape_;
  double tolerance_;
  int class_;
  std::vector<double> dark_;  ///< per layer
};

}  // namespace

double toleranceOf(Format format, int toleranceClass) {
  const double exact = format == Format::kCompact ? 0.01 : 0.0;
  return toleranceClass == 0 ? exact : 0.01 * double(1 << toleranceClass);
}

VolumeStatePtr publish(const Volume& volume, Format format, int toleranceClass, const VolumeState* previous) {
  VolumeShape shape = shapeFor(volume, format);
  if (previous != nullptr) shape = keptScales(shape, previous->shape);
  const bool follows = previous != nullptr && previous->shape == shape;
  const Publisher publisher(volume, shape, toleranceClass);
  const int bricks = brickCount(volume.grid.dims);
  auto state = std::make_shared<VolumeState>();
  state->bricks.reserve(std::size_t(bricks));
  for (int i = 0; i < bricks; ++i) {
    state->bricks.push_back(publisher.brick(i, follows ? previous->bricks[std::size_t(i)] : nullptr));
  }
  state->shape = std::move(shape);
  return state;
}

}  // namespace lpv::wire
