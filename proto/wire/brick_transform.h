#pragma once
// The transform of VOLUME_FORMAT_COMPACT: one brick and layer as coefficients of a cosine transform along x, y, z and
// across the colours. Light is smooth almost everywhere, so most coefficients are small, and few change when a light
// moves. The way back is integers only: the same elements on every machine.

#include <array>
#include <cstddef>
#include <cstdint>

namespace lpv::wire {

/// Cells of a whole brick.
inline constexpr std::size_t kBrickCells = 512;
/// Coefficients: 4 elements x 3 colours (or colour components).
inline constexpr std::size_t kPlanes = 12;
/// No coefficient is larger: sums stay exact in 53 bits.
inline constexpr std::int32_t kMaxCoefficient = 1 << 22;
/// Elements: level 0..kMaxLevel, ratios -kMaxRatio..kMaxRatio.
inline constexpr int kMaxLevel = 32767;
inline constexpr int kMaxRatio = 4096;

/// Plane by plane, each x fastest: plane element * 3 + colour, or element * 3 + component.
template <typename T>
using Coefficients = std::array<T, kPlanes * kBrickCells>;

/// Elements from coefficients of magnitude <= kMaxCoefficient, exactly as result.proto says.
void elementsFrom(const std::int32_t* coefficients, Coefficients<std::int16_t>* elements);

/// The coefficients whose elements, before rounding, are these.
void coefficientsFrom(const Coefficients<double>& elements, Coefficients<double>* coefficients);

}  // namespace lpv::wire
