#pragma once
// The transform of VOLUME_FORMAT_COMPACT (COMPACT.md 3): an integer cosine transform of one brick and layer along x, y,
// z and across the colours. Light is smooth almost everywhere, so most coefficients are small, and few change when a
// light moves. The inverse uses integers only, so every machine gets the same elements.

#include <array>
#include <cstddef>
#include <cstdint>

namespace lpv::wire {

/// Cells of a whole brick.
inline constexpr std::size_t kBrickCells = 512;
/// Channels of a brick: 4 elements x 3 colours, or x 3 colour components after the transform.
inline constexpr std::size_t kChannels = 12;
/// Largest magnitude of a coefficient: sums over it stay exact in a double's 53 bits.
inline constexpr std::int32_t kMaxCoefficient = 1 << 22;
/// Range of elements: levels 0..kMaxLevel, ratios -kMaxRatio..kMaxRatio.
inline constexpr int kMaxLevel = 32767;
inline constexpr int kMaxRatio = 4096;

/// 12 channels of 512 numbers, x fastest: channel = element * 3 + colour, or element * 3 + component.
template <typename T>
using Coefficients = std::array<T, kChannels * kBrickCells>;

/// Inverse transform of coefficients of magnitude <= kMaxCoefficient, bit for bit as result.proto defines it.
void elementsFrom(const std::int32_t* coefficients, Coefficients<std::int16_t>* elements);

/// Forward transform, not rounded: elementsFrom of the rounded result gives these elements up to rounding.
void coefficientsFrom(const Coefficients<double>& elements, Coefficients<double>* coefficients);

}  // namespace lpv::wire
