#pragma once
// Companding of VOLUME_FORMAT_COMPACT (COMPACT.md 1): per cell and colour a level, the logarithm of L00, and three
// ratios of band 1 to L00.

#include <cstddef>
#include <cstdint>

namespace lpv::wire {

/// Levels per octave and ratio steps per unit: one step of either is 0.05 % of the light.
inline constexpr double kLevelsPerOctave = 1440.0;
inline constexpr double kRatiosPerUnit = 2048.0;

/// Elements, not rounded, of one colour of one cell: level = 1440 log2(1 + L00 / scale), ratio = 2048 L1m / (sqrt 3
/// (L00 + scale)). Negative or NaN L00 is coded as no light.
void compactFrom(const float coefficients[4], double scale, double elements[4]);

/// SH coefficients from elements: `count` groups of 4, one group per cell and colour.
void floatsFromCompact(const std::int16_t* elements, std::size_t count, double scale, float* coefficients);

/// Scale of a layer whose largest L00 is `largest`: the power of two with `largest` in (2^20, 2^21] x scale. Light of a
/// millionth of the largest then still has a resolution of half a percent. 1 if there is no light.
double compactScale(double largest);

}  // namespace lpv::wire
