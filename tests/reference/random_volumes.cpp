#include "reference/random_volumes.h"

#include <cmath>
#include <glm/gtc/packing.hpp>
#include <random>
#include <string>

namespace lpv::reference {

namespace {

constexpr int kVolumes = 12;
constexpr int kPoints = 400;

/// Distributions of the standard library differ from one to the next; these do not.
class Numbers {
 public:
  explicit Numbers(std::uint32_t seed) : bits_(seed) {}
  float between(float low, float high) { return low + (high - low) * float(bits_() >> 8U) / float(1U << 24U); }
  int from1To(int most) { return 1 + int(bits_() % std::uint32_t(most)); }
  glm::vec3 direction() {
    const float z = between(-1.0F, 1.0F), turn = between(0.0F, 6.2831853F), radius = std::sqrt(1.0F - z * z);
    return {radius * std::cos(turn), radius * std::sin(turn), z};
  }

 private:
  std::mt19937 bits_;
};

glm::vec4 randomCell(Numbers& numbers) {
  const float size = std::pow(10.0F, numbers.between(-3.0F, 3.0F)), kind = numbers.between(0.0F, 1.0F);
  if (kind < 0.05F) return glm::vec4(0.0F);
  const float phi = kind < 0.1F ? -0.1F : 1.0F;
  const glm::vec3 d = numbers.between(0.0F, 2.0F) * numbers.direction();
  return size * glm::vec4(phi, d);
}

RandomVolume randomVolume(std::uint32_t seed) {
  Numbers numbers(seed);
  RandomVolume out;
  Grid& grid = out.volume.grid;
  const glm::vec3 origin = 5.0F * numbers.direction();
  grid = {glm::dvec3(origin), double(numbers.between(0.05F, 2.0F)), {1, 1, 1}};
  for (int axis = 0; axis < 3; ++axis) grid.dims[axis] = numbers.from1To(9);
  out.volume.layers.resize(std::size_t(numbers.from1To(3)));
  for (VolumeLayer& layer : out.volume.layers) {
    layer.group = "layer " + std::to_string(out.scales.size());
    out.scales.push_back(std::ldexp(1.0F, numbers.from1To(9) - 5));
    for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
      for (std::vector<std::uint16_t>& colour : out.halves) {
        const glm::vec4 c = randomCell(numbers);
        for (int k = 0; k < 4; ++k) {
          colour.push_back(glm::packHalf1x16(c[k]));
          layer.coefficients.push_back(out.scales.back() * glm::unpackHalf1x16(colour.back()));
        }
      }
    }
  }
  for (int i = 0; i < kPoints; ++i) {
    glm::vec3 at(0.0F);
    for (int axis = 0; axis < 3; ++axis) at[axis] = numbers.between(-0.7F, float(grid.dims[axis]) + 0.7F);
    out.points.push_back({origin + float(grid.cell) * at, numbers.direction()});
  }
  return out;
}

}  // namespace

std::vector<RandomVolume> randomVolumes() {
  std::vector<RandomVolume> out;
  for (std::uint32_t seed = 1; seed <= kVolumes; ++seed) out.push_back(randomVolume(seed));
  return out;
}

}  // namespace lpv::reference
