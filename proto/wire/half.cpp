#include "wire/half.h"

#include <bit>

namespace lpv::wire {
namespace {

constexpr std::uint32_t kSign = 0x80000000U;
constexpr std::uint32_t kFloatInfinity = 0x7f800000U;
constexpr std::uint32_t kHalfOverflow = 0x47800000U;     // 65536: values from here on become infinity
constexpr std::uint32_t kHalfMinNormal = 0x38800000U;    // 2^-14
constexpr std::uint32_t kSubnormalMagic = 0x3f000000U;   // 0.5: its last bit is worth 2^-24, the smallest half
constexpr std::uint32_t kRebias = (127U - 15U) << 23U;

/// Computes all three cases and selects one, so that the loop below has no branches and vectorizes.
inline std::uint16_t halfFromFloat(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t magnitude = bits & ~kSign;
  const std::uint32_t special = magnitude > kFloatInfinity ? 0x7e00U : 0x7c00U;
  // Adding 0.5 makes the floating-point adder round to the bits of the subnormal half.
  const float shifted = std::bit_cast<float>(magnitude) + std::bit_cast<float>(kSubnormalMagic);
  const std::uint32_t subnormal = std::bit_cast<std::uint32_t>(shifted) - kSubnormalMagic;
  const std::uint32_t odd = (magnitude >> 13U) & 1U;
  const std::uint32_t normal = (magnitude - kRebias + 0xfffU + odd) >> 13U;
  const std::uint32_t finite = magnitude < kHalfMinNormal ? subnormal : normal;
  const std::uint32_t half = magnitude >= kHalfOverflow ? special : finite;
  return static_cast<std::uint16_t>(half | ((bits & kSign) >> 16U));
}

inline float floatFromHalf(std::uint16_t half) {
  const std::uint32_t magnitude = (half & 0x7fffU) << 13U;
  const std::uint32_t exponent = magnitude & (0x7c00U << 13U);
  const std::uint32_t normal = magnitude + kRebias;
  const std::uint32_t special = normal + kRebias;
  // A subnormal is read as 2^-14 (1 + m); subtracting 2^-14 leaves m 2^-14.
  const float renormalised = std::bit_cast<float>(normal + (1U << 23U)) - std::bit_cast<float>(kHalfMinNormal);
  const std::uint32_t finite = exponent == 0 ? std::bit_cast<std::uint32_t>(renormalised) : normal;
  const std::uint32_t bits = exponent == (0x7c00U << 13U) ? special : finite;
  return std::bit_cast<float>(bits | (std::uint32_t(half & 0x8000U) << 16U));
}

}  // namespace

void halvesFromFloats(const float* in, std::size_t count, float factor, std::uint16_t* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = halfFromFloat(in[i] * factor);
}

void floatsFromHalves(const std::uint16_t* in, std::size_t count, float factor, float* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = floatFromHalf(in[i]) * factor;
}

}  // namespace lpv::wire
