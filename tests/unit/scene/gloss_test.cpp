// Lobes of glossy surfaces: their energy, and the table of it.

#include "scene/gloss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "reference/meshes.h"
#include "reference/sh.h"

namespace lpv {
namespace {

constexpr glm::dvec3 kUp(0.0, 0.0, 1.0);

glm::dvec3 seenUnder(double mu) { return {std::sqrt(1.0 - mu * mu), 0.0, mu}; }

/// What a lobe without gain reflects of even light, by the midpoint rule about the mirror's direction, where it is
/// narrow: independent of how its rays are chosen.
glm::dvec3 reflectedOfEvenLight(const GlossLobe& lobe, double mu) {
  const glm::dvec3 v = seenUnder(mu), mirror(-v.x, 0.0, v.z), across(0.0, 1.0, 0.0), up = glm::cross(mirror, across);
  constexpr int kRings = 2000, kTurns = 512;
  glm::dvec3 sum(0.0);
  for (int i = 0; i < kRings; ++i) {
    const double s = (i + 0.5) / kRings, angle = glm::pi<double>() * s * s * s;  // more of them near the middle
    const double width = glm::pi<double>() * 3.0 * s * s / kRings;
    for (int j = 0; j < kTurns; ++j) {
      const double turn = 2.0 * glm::pi<double>() * (j + 0.5) / kTurns;
      const glm::dvec3 l = std::cos(angle) * mirror + std::sin(angle) * (std::cos(turn) * across + std::sin(turn) * up);
      if (l.z <= 0.0) continue;
      sum += lobe.single(kUp, v, l) * (l.z * std::sin(angle) * width * 2.0 * glm::pi<double>() / kTurns);
    }
  }
  return sum;
}

// Red with Smith's masking left out of the weight, or facets that are not those seen.
TEST(Gloss, SharesAreWhatTheLobeReflectsOfEvenLight) {
  for (const double roughness : {0.3, 0.6, 1.0}) {
    for (const double mu : {0.2, 0.6, 0.95}) {
      const GlossLobe lobe = GlossLobe::of({0.9, 0.5, 0.1}, roughness, 1.0);
      const GlossShare share = glossShare(mu, lobe.alpha);
      const glm::dvec3 want = reflectedOfEvenLight(lobe, mu), got = lobe.straight * share.straight + share.edge;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], want[c], 0.005 * want[c]) << roughness << ", " << mu;
    }
  }
}

TEST(Gloss, NoEnergyIsLostBetweenWhiteFacetsNorMade) {
  for (const double roughness : {0.0, 0.1, 0.3, 0.6, 1.0}) {
    for (const double mu : {0.05, 0.3, 0.7, 1.0}) {
      const GlossShare share = glossShare(mu, std::max(roughness * roughness, kLeastAlpha));
      EXPECT_NEAR(share.of(glm::dvec3(1.0)).x, 1.0, 1e-6) << roughness << ", " << mu;
      EXPECT_GE(share.of(glm::dvec3(kDielectricReflectance)).x, 0.0);
      EXPECT_LE(share.of(glm::dvec3(0.5)).x, 1.0);
    }
  }
}

TEST(Gloss, ItsReciprocal) {
  const GlossLobe lobe = GlossLobe::of({0.9, 0.5, 0.1}, 0.4, 0.5);
  const glm::dvec3 v = glm::normalize(glm::dvec3(0.3, -0.5, 0.4)), l = glm::normalize(glm::dvec3(-0.7, 0.1, 0.9));
  EXPECT_NEAR(lobe.single(kUp, v, l).y, lobe.single(kUp, l, v).y, 1e-12);
  EXPECT_EQ(lobe.single(kUp, v, -l).y, 0.0);
}

TEST(Gloss, TheTableIsNearTheShares) {
  const std::vector<glm::vec2>& table = glossTable();
  ASSERT_EQ(table.size(), std::size_t(kGlossTable * kGlossTable));
  for (const glm::ivec2 at : {glm::ivec2(3, 5), glm::ivec2(20, 10), glm::ivec2(30, 31)}) {
    const double roughness = (at.y + 0.5) / kGlossTable;
    const GlossShare share = glossShare((at.x + 0.5) / kGlossTable, roughness * roughness);
    EXPECT_NEAR(table[std::size_t(at.y * kGlossTable + at.x)].x, share.straight, 0.003);
    EXPECT_NEAR(table[std::size_t(at.y * kGlossTable + at.x)].y, share.edge, 0.003);
  }
}

TEST(Gloss, IsWhereSurfacesAreMetalOrSmoothAndItIsAskedFor) {
  Scene scene;
  Surface surface;
  surface.mesh = reference::quad();
  const auto shows = [&](double roughness, double metalness, Gloss gloss, bool visible = true) {
    surface.roughness = roughness;
    surface.metalness = metalness;
    surface.visibleToCamera = visible;
    scene.surfaces["wall"] = std::make_shared<Surface>(surface);
    scene.options.gloss = gloss;
    return showsGloss(scene);
  };
  EXPECT_FALSE(shows(1.0, 0.0, Gloss::kOn));
  EXPECT_TRUE(shows(0.9, 0.0, Gloss::kOn));
  EXPECT_TRUE(shows(1.0, 0.1, Gloss::kOn));
  EXPECT_FALSE(shows(0.9, 0.0, Gloss::kOff));
  EXPECT_FALSE(shows(0.9, 0.0, Gloss::kOn, false));
  scene.options.transport = Transport::kPropagate;
  EXPECT_FALSE(shows(0.9, 0.0, Gloss::kOn));
}

}  // namespace
}  // namespace lpv
