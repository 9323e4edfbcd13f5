#include "wire/brick_transform.h"

#include <algorithm>
#include <glm/glm.hpp>

namespace lpv::wire {
namespace {

/// First half of each basis row; the second half follows by symmetry. Row k approximates 90.5 cos(pi (i + .5) k / 8):
/// the 8-point core transform of ITU-T H.265, 8.6.4.2.
constexpr int kBasis[8][4] = {{64, 64, 64, 64},   {89, 75, 50, 18},  {83, 36, -36, -83}, {75, -18, -89, -50},
                              {64, -64, -64, 64}, {50, -89, 18, 75}, {36, -83, 83, -36}, {18, -50, 75, -89}};
/// Elements are the inverse transform's sums divided by 2^kShift.
constexpr int kShift = 23;

/// Half of the 8 x 8 matrix, because basis(k, 7 - i) = basis(k, i) for even k and -basis(k, i) for odd k.
/// Indices: [parity of k][k / 2][i].
using Halves = std::array<std::array<std::array<double, 4>, 4>, 2>;

/// value_i = sum over k of basis(k, i) coefficient_k.
Halves synthesis() {
  Halves out;
  for (std::size_t k = 0; k < 8; ++k) {
    for (std::size_t i = 0; i < 4; ++i) out[k % 2][k / 2][i] = kBasis[k][i];
  }
  return out;
}

/// Exact inverse of synthesis(): adding and subtracting the signal's halves leaves one 4 x 4 system per parity of k.
Halves analysis() {
  Halves out;
  for (std::size_t parity = 0; parity < 2; ++parity) {
    glm::dmat4 half;  // column k, row i
    for (int k = 0; k < 4; ++k) {
      for (int i = 0; i < 4; ++i) half[k][i] = kBasis[2 * std::size_t(k) + parity][i];
    }
    const glm::dmat4 inverse = glm::inverse(half);
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t i = 0; i < 4; ++i) out[parity][k][i] = 0.5 * inverse[int(i)][int(k)];
    }
  }
  return out;
}

/// Eight values along an axis, for `Lanes` neighbouring lines.
template <std::size_t Lanes>
using Lines = double[8][Lanes];

struct Synthesis {
  Halves halves = synthesis();

  template <std::size_t Lanes>
  void operator()(const Lines<Lanes>& in, Lines<Lanes>& out) const {
    for (std::size_t i = 0; i < 4; ++i) {
      double even[Lanes] = {};
      double odd[Lanes] = {};
      for (std::size_t k = 0; k < 4; ++k) {
        const double evenFactor = halves[0][k][i];
        const double oddFactor = halves[1][k][i];
        for (std::size_t lane = 0; lane < Lanes; ++lane) even[lane] += evenFactor * in[2 * k][lane];
        for (std::size_t lane = 0; lane < Lanes; ++lane) odd[lane] += oddFactor * in[2 * k + 1][lane];
      }
      for (std::size_t lane = 0; lane < Lanes; ++lane) out[i][lane] = even[lane] + odd[lane];
      for (std::size_t lane = 0; lane < Lanes; ++lane) out[7 - i][lane] = even[lane] - odd[lane];
    }
  }
};

struct Analysis {
  Halves halves = analysis();

  template <std::size_t Lanes>
  void operator()(const Lines<Lanes>& in, Lines<Lanes>& out) const {
    double sum[4][Lanes];
    double difference[4][Lanes];
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t lane = 0; lane < Lanes; ++lane) sum[i][lane] = in[i][lane] + in[7 - i][lane];
      for (std::size_t lane = 0; lane < Lanes; ++lane) difference[i][lane] = in[i][lane] - in[7 - i][lane];
    }
    for (std::size_t k = 0; k < 4; ++k) {
      double even[Lanes] = {};
      double odd[Lanes] = {};
      for (std::size_t i = 0; i < 4; ++i) {
        const double evenFactor = halves[0][k][i];
        const double oddFactor = halves[1][k][i];
        for (std::size_t lane = 0; lane < Lanes; ++lane) even[lane] += evenFactor * sum[i][lane];
        for (std::size_t lane = 0; lane < Lanes; ++lane) odd[lane] += oddFactor * difference[i][lane];
      }
      std::copy_n(even, Lanes, out[2 * k]);
      std::copy_n(odd, Lanes, out[2 * k + 1]);
    }
  }
};

constexpr std::size_t kLanes = 8;

/// Transforms eight neighbouring lines along the axis with this stride.
template <typename Transform>
void alongLanes(const Transform& transform, std::size_t stride, double* values) {
  Lines<kLanes> in;
  Lines<kLanes> out;
  for (std::size_t i = 0; i < 8; ++i) std::copy_n(values + i * stride, kLanes, in[i]);
  transform(in, out);
  for (std::size_t i = 0; i < 8; ++i) std::copy_n(out[i], kLanes, values + i * stride);
}

/// Transforms eight rows along x, where neighbouring values are adjacent in memory.
template <typename Transform>
void alongRows(const Transform& transform, double* rows) {
  Lines<kLanes> in;
  Lines<kLanes> out;
  for (std::size_t row = 0; row < kLanes; ++row) {
    for (std::size_t i = 0; i < 8; ++i) in[i][row] = rows[row * 8 + i];
  }
  transform(in, out);
  for (std::size_t row = 0; row < kLanes; ++row) {
    for (std::size_t i = 0; i < 8; ++i) rows[row * 8 + i] = out[i][row];
  }
}

template <typename Transform>
void alongAllAxes(const Transform& transform, double* plane) {
  for (std::size_t y = 0; y < 8; ++y) alongLanes(transform, 64, plane + y * 8);
  for (std::size_t z = 0; z < 8; ++z) alongLanes(transform, 8, plane + z * 64);
  for (std::size_t z = 0; z < 8; ++z) alongRows(transform, plane + z * 64);
}

/// value / 2^kShift rounded to the nearest integer, ties to even, by adding a number whose last bit is worth 2^kShift.
double rounded(double value) {
  constexpr double kRounder = 1.5 * 4503599627370496.0 * double(1 << kShift);
  return ((value + kRounder) - kRounder) * (1.0 / double(1 << kShift));
}

}  // namespace

void elementsFrom(const std::int32_t* coefficients, Coefficients<std::int16_t>* elements) {
  static const Synthesis kSynthesis;
  double planes[3 * kBrickCells];
  for (std::size_t element = 0; element < 4; ++element) {
    const std::int32_t* in = coefficients + element * 3 * kBrickCells;
    for (std::size_t i = 0; i < kBrickCells; ++i) {
      const double y = in[i];
      const double u = in[i + kBrickCells];
      const double v = in[i + 2 * kBrickCells];
      planes[i] = 2.0 * y + 2.0 * u + v;
      planes[i + kBrickCells] = 2.0 * y - 2.0 * v;
      planes[i + 2 * kBrickCells] = 2.0 * y - 2.0 * u + v;
    }
    const double low = element == 0 ? 0.0 : -kMaxRatio;
    const double high = element == 0 ? kMaxLevel : kMaxRatio;
    for (std::size_t colour = 0; colour < 3; ++colour) alongAllAxes(kSynthesis, planes + colour * kBrickCells);
    std::int16_t* out = elements->data() + element * 3 * kBrickCells;
    for (std::size_t i = 0; i < 3 * kBrickCells; ++i) {
      out[i] = std::int16_t(int(std::min(std::max(rounded(planes[i]), low), high)));
    }
  }
}

void coefficientsFrom(const Coefficients<double>& elements, Coefficients<double>* coefficients) {
  static const Analysis kAnalysis;
  constexpr double kScale = double(1 << kShift);
  for (std::size_t element = 0; element < 4; ++element) {
    const double* in = elements.data() + element * 3 * kBrickCells;
    double* out = coefficients->data() + element * 3 * kBrickCells;
    for (std::size_t i = 0; i < kBrickCells; ++i) {
      const double r = in[i] * kScale;
      const double g = in[i + kBrickCells] * kScale;
      const double b = in[i + 2 * kBrickCells] * kScale;
      out[i] = (r + g + b) / 6.0;
      out[i + kBrickCells] = (r - b) / 4.0;
      out[i + 2 * kBrickCells] = (r - 2.0 * g + b) / 6.0;
    }
    for (std::size_t component = 0; component < 3; ++component) alongAllAxes(kAnalysis, out + component * kBrickCells);
  }
}

}  // namespace lpv::wire
