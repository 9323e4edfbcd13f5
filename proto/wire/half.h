#pragma once
// IEEE 754 binary16, the element of VOLUME_FORMAT_HALF_FLOAT.

#include <cstddef>
#include <cstdint>

namespace lpv::wire {

/// Largest finite half.
inline constexpr float kMaxHalf = 65504.0F;

/// out[i] = in[i] * factor rounded to the nearest half, ties to even; overflow gives infinity; NaN stays NaN.
void halvesFromFloats(const float* in, std::size_t count, float factor, std::uint16_t* out);

/// out[i] = in[i] * factor.
void floatsFromHalves(const std::uint16_t* in, std::size_t count, float factor, float* out);

}  // namespace lpv::wire
