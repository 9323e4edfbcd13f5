#include "wire/brick_transform.h"

#include <algorithm>
#include <glm/glm.hpp>

namespace lpv::wire {
namespace {

/// Even rows' first halves, then odd rows'; the rest by symmetry. Row k: 90.5 cos(pi (i + .5) k / 8), near enough
/// (the 8-point core transform of ITU-T H.265, 8.6.4.2).
constexpr int kBasis[8][4] = {{64, 64, 64, 64},   {89, 75, 50, 18},  {83, 36, -36, -83}, {75, -18, -89, -50},
                              {64, -64, -64, 64}, {50, -89, 18, 75}, {36, -83, 83, -36}, {18, -50, 75, -89}};
/// Elements are sums over 2^kShift.
constexpr int kShift = 23;

using Matrix = std::array<std::array<double, 8>, 8>;  // [out][in]

int basis(int k, int i) { return i < 4 ? kBasis[k][i] : (k % 2 == 0 ? 1 : -1) * kBasis[k][7 - i]; }

/// out_i = sum over k of basis(k, i) in_k.
Matrix synthesis() {
  Matrix out;
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 8; ++k) out[std::size_t(i)][std::size_t(k)] = basis(k, i);
  }
  return out;
}

/// Its exact inverse. With the halves of the signal added and subtracted, even and odd rows are 4 x 4 systems.
Matrix analysis() {
  Matrix out;
  for (int parity = 0; parity < 2; ++parity) {
    glm::dmat4 half;  // column k, row i
    for (int k = 0; k < 4; ++k) {
      for (int i = 0; i < 4; ++i) half[k][i] = kBasis[2 * k + parity][i];
    }
    const glm::dmat4 inverse = glm::inverse(half);
    for (int k = 0; k < 4; ++k) {
      for (int i = 0; i < 8; ++i) {
        const double sign = i >= 4 && parity == 1 ? -1.0 : 1.0;
        out[std::size_t(2 * k + parity)][std::size_t(i)] = 0.5 * sign * inverse[i < 4 ? i : 7 - i][k];
      }
    }
  }
  return out;
}

/// Applies `m` along the axis of that stride to Lanes neighbouring lines.
template <std::size_t Lanes, std::size_t Stride>
void alongLanes(const Matrix& m, double* values) {
  double in[8 * Lanes];
  for (std::size_t k = 0; k < 8; ++k) std::copy_n(values + k * Stride, Lanes, in + k * Lanes);
  for (std::size_t i = 0; i < 8; ++i) {
    double sum[Lanes] = {};
    for (std::size_t k = 0; k < 8; ++k) {
      const double factor = m[i][k];
      for (std::size_t lane = 0; lane < Lanes; ++lane) sum[lane] += factor * in[k * Lanes + lane];
    }
    std::copy_n(sum, Lanes, values + i * Stride);
  }
}

/// The same along x, where the values of a line are neighbours. `transposed` is [in][out].
void alongRow(const Matrix& transposed, double* row) {
  double sum[8] = {};
  for (std::size_t k = 0; k < 8; ++k) {
    const double value = row[k];
    for (std::size_t i = 0; i < 8; ++i) sum[i] += value * transposed[k][i];
  }
  std::copy_n(sum, 8, row);
}

Matrix transpose(const Matrix& m) {
  Matrix out;
  for (std::size_t i = 0; i < 8; ++i) {
    for (std::size_t k = 0; k < 8; ++k) out[k][i] = m[i][k];
  }
  return out;
}

void alongAllAxes(const Matrix& m, const Matrix& transposed, double* plane) {
  for (std::size_t part = 0; part < 64; part += 16) alongLanes<16, 64>(m, plane + part);
  for (std::size_t z = 0; z < 8; ++z) alongLanes<8, 8>(m, plane + z * 64);
  for (std::size_t row = 0; row < 64; ++row) alongRow(transposed, plane + row * 8);
}

/// value / 2^kShift to the nearest integer, ties to even: adding a number whose last bit is 2^kShift rounds.
double rounded(double value) {
  constexpr double kRounder = 1.5 * 4503599627370496.0 * double(1 << kShift);
  return ((value + kRounder) - kRounder) * (1.0 / double(1 << kShift));
}

}  // namespace

void elementsFrom(const std::int32_t* coefficients, Planes<std::int16_t>* elements) {
  static const Matrix kSynthesis = synthesis();
  static const Matrix kTransposed = transpose(kSynthesis);
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
    for (std::size_t colour = 0; colour < 3; ++colour) {
      alongAllAxes(kSynthesis, kTransposed, planes + colour * kBrickCells);
    }
    std::int16_t* out = elements->data() + element * 3 * kBrickCells;
    for (std::size_t i = 0; i < 3 * kBrickCells; ++i) {
      out[i] = std::int16_t(int(std::min(std::max(rounded(planes[i]), low), high)));
    }
  }
}

void coefficientsFrom(const Planes<double>& elements, Planes<double>* coefficients) {
  static const Matrix kAnalysis = analysis();
  static const Matrix kTransposed = transpose(kAnalysis);
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
    for (std::size_t component = 0; component < 3; ++component) {
      alongAllAxes(kAnalysis, kTransposed, out + component * kBrickCells);
    }
  }
}

}  // namespace lpv::wire
