// Small triangles in pools that are close together and face alike.

#include "scene/triangle_pools.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace lpv {
namespace {

/// Four bars of square section, 1 m long and 2 m apart, of 20 triangles a side, their sides one after the other.
std::vector<PooledTriangle> bars() {
  std::vector<PooledTriangle> out;
  for (const glm::vec3& n : {glm::vec3(0, 0, 1), glm::vec3(0, 1, 0), glm::vec3(0, 0, -1), glm::vec3(0, -1, 0)}) {
    for (int bar = 0; bar < 4; ++bar)
      for (int i = 0; i < 20; ++i) out.push_back({glm::vec3(i / 20.0F, 2.0F * float(bar), 0.0F) + 0.02F * n, n, 0.001});
  }
  return out;
}

/// The largest distance of two triangles of a pool, and the least cosine of their normals.
struct Widest {
  float apart = 0.0F, cosine = 1.0F;
};

Widest widest(const std::vector<PooledTriangle>& triangles, const std::vector<std::uint32_t>& pools) {
  Widest out;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (pools[i] != pools[k]) continue;
      out.apart = std::max(out.apart, glm::distance(triangles[i].middle, triangles[k].middle));
      out.cosine = std::min(out.cosine, glm::dot(triangles[i].normal, triangles[k].normal));
    }
  }
  return out;
}

std::size_t countOf(const std::vector<std::uint32_t>& pools) { return std::set(pools.begin(), pools.end()).size(); }

// Red where triangles are pooled in the order of the mesh: its sides are on four bars.
TEST(TrianglePools, AreOfOneBarWhereThereAreEnough) {
  const std::vector<PooledTriangle> triangles = bars();
  const std::vector<std::uint32_t> few = poolsOf(triangles, 4, 0.1).poolOf, more = poolsOf(triangles, 16, 1.0).poolOf;
  EXPECT_EQ(countOf(few), 4U);
  EXPECT_LE(widest(triangles, few).apart, 1.0F);
  EXPECT_EQ(countOf(more), 16U);
  EXPECT_LE(widest(triangles, more).apart, 1.0F);
  EXPECT_GE(widest(triangles, more).cosine, 0.99F);
}

// In the middle of a bar, of the side that faces as the mean does.
TEST(TrianglePools, HaveOneNearTheirMean) {
  const std::vector<PooledTriangle> triangles = bars();
  const TrianglePools pools = poolsOf(triangles, 16, 1.0);
  ASSERT_EQ(pools.central.size(), 16U);
  for (std::uint32_t pool = 0; pool < 16; ++pool) {
    EXPECT_EQ(pools.poolOf[pools.central[pool]], pool);
    EXPECT_NEAR(triangles[pools.central[pool]].middle.x, 0.475F, 0.03F);
  }
}

// How they face counts for as much as is said.
TEST(TrianglePools, FaceAlikeBeforeTheyAreClose) {
  const std::vector<PooledTriangle> triangles = bars();
  EXPECT_GE(widest(triangles, poolsOf(triangles, 4, 20.0).poolOf).cosine, 0.99F);
}

TEST(TrianglePools, AreNoMoreThanAskedForOrThanDiffer) {
  std::vector<PooledTriangle> same(7, {glm::vec3(1.0F), glm::vec3(0.0F, 1.0F, 0.0F), 0.5});
  EXPECT_EQ(countOf(poolsOf(same, 5, 1.0).poolOf), 1U);
  EXPECT_TRUE(poolsOf({}, 5, 1.0).central.empty());
  const std::vector<PooledTriangle> triangles = bars();
  EXPECT_EQ(countOf(poolsOf(triangles, 1, 1.0).poolOf), 1U);
  EXPECT_EQ(countOf(poolsOf(triangles, 1000, 1.0).poolOf), triangles.size());
  const std::vector<std::uint32_t> pools = poolsOf(triangles, 9, 1.0).poolOf;
  EXPECT_EQ(countOf(pools), 9U);
  EXPECT_EQ(*std::ranges::max_element(pools), 8U);
}

}  // namespace
}  // namespace lpv
