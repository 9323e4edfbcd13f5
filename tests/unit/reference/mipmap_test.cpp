// The mip chain that COUNT samples (paper 3.3): every level has the mean of level 0.
#include "reference/mipmap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "reference/display.h"
#include "reference/texel.h"
#include "reference/textures.h"

namespace lpv::reference {
namespace {

glm::dvec3 meanOf(const MipLevel& level) {
  glm::dvec3 sum(0.0);
  for (const glm::dvec3& t : level.texels) sum += t;
  return sum / double(level.texels.size());
}

TEST(MipChain, HasHalvedSizesDownToOneTexelAndOneMean) {
  for (const glm::ivec2 size : {glm::ivec2(8, 8), glm::ivec2(13, 6), glm::ivec2(5, 1), glm::ivec2(1, 1)}) {
    const MipChain chain = mipChainOf(*noise(size.x, size.y));
    EXPECT_EQ(chain.levels.size(), 1U + std::size_t(std::log2(std::max(size.x, size.y))));
    for (std::size_t k = 0; k < chain.levels.size(); ++k) {
      const MipLevel& level = chain.levels[k];
      EXPECT_EQ(level.width, std::max(1, size.x >> k));
      EXPECT_EQ(level.height, std::max(1, size.y >> k));
      EXPECT_NEAR(glm::length(meanOf(level) - meanOf(chain.levels[0])), 0.0, 1e-14);
    }
  }
}

TEST(MipChain, EvenSizesAreMeansOfFourTexels) {
  const TexturePtr texture = noise(6, 4);
  const MipChain chain = mipChainOf(*texture);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) {
      const glm::dvec3 four = texel(*texture, 2 * x, 2 * y) + texel(*texture, 2 * x + 1, 2 * y) +
                              texel(*texture, 2 * x, 2 * y + 1) + texel(*texture, 2 * x + 1, 2 * y + 1);
      EXPECT_NEAR(glm::length(chain.levels[1].at(x, y) - four / 4.0), 0.0, 1e-15);
    }
  }
}

// Red with the last column of an odd size dropped.
TEST(MipChain, OddSizesWeighTexelsByWhatIsCovered) {
  const MipChain chain = mipChainOf(*textureOf(5, 1, [](int x, int) { return glm::dvec3(std::pow(10.0, x)); }));
  EXPECT_NEAR(chain.levels[1].at(0, 0).x, (1.0 + 10.0 + 50.0) / 2.5, 1e-12);
  EXPECT_NEAR(chain.levels[1].at(1, 0).x, (50.0 + 1000.0 + 10000.0) / 2.5, 1e-11);
}

TEST(MipChain, DecodesSrgbFirst) {
  const MipChain chain = mipChainOf(*srgbTextureOf(2, 1, [](int x, int) { return glm::u8vec3(x ? 200 : 40); }));
  EXPECT_NEAR(chain.levels[1].at(0, 0).x, 0.5 * (decodeSrgb(200 / 255.0) + decodeSrgb(40 / 255.0)), 1e-12);
}

TEST(MipChain, LevelZeroIsTheTextureAsRead) {
  const TexturePtr texture = noise(7, 3);
  const MipChain chain = mipChainOf(*texture);
  for (const glm::dvec2 uv : {glm::dvec2(0.1, 0.2), glm::dvec2(-3.7, 8.9), glm::dvec2(0.99, 0.01)}) {
    EXPECT_NEAR(glm::length(bilinear(chain.levels[0], uv) - bilinear(*texture, uv)), 0.0, 1e-13);
    EXPECT_NEAR(glm::length(trilinear(chain, uv, 0.0) - bilinear(*texture, uv)), 0.0, 1e-13);
  }
}

// Red without the clamp at either end.
TEST(MipChain, SamplesBetweenLevelsAndNeverBeyondThem) {
  const MipChain chain = mipChainOf(*noise(8, 8));
  const glm::dvec2 uv(0.37, 0.81);
  const glm::dvec3 between = 0.75 * bilinear(chain.levels[1], uv) + 0.25 * bilinear(chain.levels[2], uv);
  EXPECT_NEAR(glm::length(trilinear(chain, uv, 1.25) - between), 0.0, 1e-14);
  const double never = -std::numeric_limits<double>::infinity();
  EXPECT_NEAR(glm::length(trilinear(chain, uv, never) - bilinear(chain.levels[0], uv)), 0.0, 1e-15);
  EXPECT_NEAR(glm::length(trilinear(chain, uv, 30.0) - meanOf(chain.levels[0])), 0.0, 1e-14);
}

}  // namespace
}  // namespace lpv::reference
