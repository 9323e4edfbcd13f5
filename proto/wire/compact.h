#pragma once
// The elements of VOLUME_FORMAT_COMPACT, four per cell and colour: a level, which is the logarithm of L00, and three
// ratios of band 1 to it.

#include <cstddef>
#include <cstdint>

namespace lpv::wire {

/// Levels per octave, ratios per unit: one step of either is .05 % of the light.
inline constexpr double kLevelsPerOctave = 1440.0;
inline constexpr double kRatiosPerUnit = 2048.0;

/// Elements, unrounded, of one colour of one cell: level = 1440 log2(1 + L00 / scale), ratio = 2048 L1m / (sqrt 3
/// (L00 + scale)). Negative or undefined light counts as none.
void compactFrom(const float coefficients[4], double scale, double elements[4]);

/// Coefficients of `count` colours of cells, 4 each, from as many elements.
void floatsFromCompact(const std::int16_t* elements, std::size_t count, double scale, float* coefficients);

/// Scale of a layer whose largest L00 is `largest`: a power of two for which that lies in (2^20, 2^21] x scale, so
/// that light of a millionth of the largest still has half a percent of its own. 1 where there is no light.
double compactScale(double largest);

}  // namespace lpv::wire
