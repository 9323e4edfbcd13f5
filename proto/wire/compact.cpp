#include "wire/compact.h"

#include <algorithm>
#include <cmath>

#include "wire/brick_transform.h"

namespace lpv::wire {
namespace {

constexpr double kSqrt3 = 1.7320508075688772;
constexpr int kLargestExponent = 21;
constexpr int kMinScaleExponent = -120;  // smallest for which 1 / scale is finite as a float

}  // namespace

void compactFrom(const float coefficients[4], double scale, double elements[4]) {
  const double light = coefficients[0] > 0.0F ? double(coefficients[0]) : 0.0;
  elements[0] = std::min(kLevelsPerOctave * std::log2(1.0 + light / scale), double(kMaxLevel));
  const double factor = kRatiosPerUnit / (kSqrt3 * (light + scale));
  for (int m = 1; m < 4; ++m) {
    const double ratio = factor * double(coefficients[m]);
    elements[m] = std::abs(ratio) <= double(kMaxRatio) ? ratio : 0.0;
  }
}

void floatsFromCompact(const std::int16_t* elements, std::size_t count, double scale, float* coefficients) {
  const auto unit = float(scale);
  constexpr auto kOctaves = float(1.0 / kLevelsPerOctave);
  constexpr auto kRatio = float(kSqrt3 / kRatiosPerUnit);
  for (std::size_t i = 0; i < count; ++i, elements += 4, coefficients += 4) {
    const float light = unit * std::exp2(float(elements[0]) * kOctaves);  // L00 + scale
    coefficients[0] = light - unit;
    for (int m = 1; m < 4; ++m) coefficients[m] = light * kRatio * float(elements[m]);
  }
}

double compactScale(double largest) {
  if (!(largest > 0.0) || !std::isfinite(largest)) return 1.0;
  int exponent = 0;
  const double mantissa = std::frexp(largest, &exponent);  // in [.5, 1)
  if (mantissa == 0.5) --exponent;                         // exactly a power of two
  return std::ldexp(1.0, std::max(exponent - kLargestExponent, kMinScaleExponent));
}

}  // namespace lpv::wire
