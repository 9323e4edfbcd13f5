#pragma once
// Owen-scrambled Sobol' points in two dimensions, padded: each pair of numbers of a path is a (0,2)-sequence of its own
// scrambling and order (Burley 2020).

#include <cstdint>
#include <glm/glm.hpp>

namespace lpv::evaluation {

/// A well mixed hash of 32 bits.
inline std::uint32_t hashed(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  return x ^ (x >> 16);
}

/// Numbers in [0, 1). Sequences of different seeds are independent; the first 2^k points of one are stratified.
class Sampler {
 public:
  explicit Sampler(std::uint32_t seed) : seed_(seed) {}

  /// Begins the path of this index.
  void start(std::uint32_t index) {
    index_ = index;
    dimension_ = 0;
  }

  glm::dvec2 pair() {
    const std::uint32_t seed = hashed(seed_ ^ hashed(++dimension_));
    const std::uint32_t i = scrambled(index_, seed);
    return {fraction(scrambled(reversed(i), hashed(seed + 1))), fraction(scrambled(secondSobol(i), hashed(seed + 2)))};
  }

  double one() { return pair().x; }

 private:
  static double fraction(std::uint32_t bits) { return double(bits) * 0x1p-32; }

  static std::uint32_t reversed(std::uint32_t x) {
    x = ((x >> 1) & 0x55555555U) | ((x & 0x55555555U) << 1);
    x = ((x >> 2) & 0x33333333U) | ((x & 0x33333333U) << 2);
    x = ((x >> 4) & 0x0f0f0f0fU) | ((x & 0x0f0f0f0fU) << 4);
    return __builtin_bswap32(x);
  }

  /// Owen's nested scrambling by a hash whose low bits touch only higher ones (Laine & Karras 2011).
  static std::uint32_t scrambled(std::uint32_t x, std::uint32_t seed) {
    x = reversed(x) + seed;
    x ^= x * 0x6c50b47cU;
    x ^= x * 0xb82f1e52U;
    x ^= x * 0xc7afe638U;
    x ^= x * 0x8d22f6e6U;
    return reversed(x);
  }

  /// The second dimension of Sobol's sequence.
  static std::uint32_t secondSobol(std::uint32_t index) {
    std::uint32_t bits = 0;
    for (std::uint32_t direction = 0x80000000U; index != 0; index >>= 1, direction ^= direction >> 1) {
      if (index & 1U) bits ^= direction;
    }
    return bits;
  }

  std::uint32_t seed_;
  std::uint32_t index_ = 0;
  std::uint32_t dimension_ = 0;
};

}  // namespace lpv::evaluation
