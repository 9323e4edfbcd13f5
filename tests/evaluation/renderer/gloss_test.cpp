// Lobes in reference pictures, against energy and against the formula by hand.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "reference/meshes.h"
#include "reference/textures.h"
#include "renderer/picture.h"
#include "renderer/test_scenes.h"
#include "scene/gloss.h"

namespace lpv::evaluation {
namespace {

Camera askew() {
  Camera camera;
  camera.eye = {0.0, -1.2, 1.6};
  camera.target = {0.0, 0.0, 0.0};
  camera.fovDegrees = 10.0;
  return camera;
}

/// The one pixel of a picture.
glm::dvec3 seen(const Scene& scene, const Camera& camera, PixelFilter filter = PixelFilter::kCentre,
                int samples = 1 << 15) {
  const TracedScene traced(scene);
  Sampling sampling;
  sampling.samples = samples;
  sampling.threads = 2;
  const Picture p = renderPicture(traced, PathTracer(traced, {0}), camera, {1, 1}, filter, sampling, nullptr, true);
  return p.radiance[0][0];
}

Surface& addFloor(Scene& scene, double roughness, double metalness, const glm::dvec3& albedo) {
  Surface& floor = addSurface(scene, reference::quad(), movedTo({0, 0, 0}, {0, 0, 0}, {2, 2, 1}), albedo);
  floor.roughness = roughness;
  floor.metalness = metalness;
  return floor;
}

// Red without the gain, or with all of the diffuse light beneath a lobe.
TEST(ReferenceGloss, WhiteIsWhiteInAFurnace) {
  for (const double metalness : {0.0, 1.0}) {
    for (const double roughness : {0.0, 0.1, 0.3, 0.6, 0.99}) {
      Scene scene;
      addLight(scene, reference::box(glm::dvec3(-3.0), glm::dvec3(3.0), true), Transform(), glm::dvec3(1.0));
      addFloor(scene, roughness, metalness, glm::dvec3(1.0));
      EXPECT_NEAR(seen(scene, askew(), PixelFilter::kCentre, 2048).y, 1.0, 0.01) << roughness << ", " << metalness;
      EXPECT_NEAR(seen(scene, askew(), PixelFilter::kBox, 2048).y, 1.0, 0.01) << roughness << ", " << metalness;
    }
  }
}

// Red with either half of the power heuristic alone, or a density per triangle.
TEST(ReferenceGloss, AFarSquareIsTheLobeTimesItsSolidAngle) {
  for (const double roughness : {0.3, 0.6, 1.0}) {
    Scene scene;
    const glm::dvec3 from(0.3, 10.0, 13.0);
    addLight(scene, reference::quad(), movedTo(from, {0.0, 180.0, 0.0}, glm::dvec3(0.2)), glm::dvec3(100.0));
    const glm::dvec3 albedo(0.9, 0.5, 0.2), n(0.0, 0.0, 1.0);
    addFloor(scene, roughness, 1.0, albedo);
    const glm::dvec3 v = glm::normalize(askew().eye), l = glm::normalize(from);
    const GlossLobe lobe = GlossLobe::of(albedo, roughness, 1.0);
    const double solidAngle = 0.04 * l.z / glm::dot(from, from);
    const glm::dvec3 want = lobe.single(n, v, l) * glossShare(v.z, lobe.alpha).gain(lobe.straight) *
                            (100.0 * l.z * solidAngle),
                     got = seen(scene, askew());
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], want[c], 0.02 * want[c]) << roughness;
  }
}

TEST(ReferenceGloss, AMirrorShowsALightAsItIsAndSurfacesAsTheyAreLit) {
  Scene scene;
  addLight(scene, reference::quad(), movedTo({0, 1.2, 1.6}, {180.0 - 37.0, 0.0, 0.0}, glm::dvec3(0.5)),
           glm::dvec3(7.0, 5.0, 3.0));
  Surface& floor = addFloor(scene, 0.0, 1.0, glm::dvec3(1.0));
  EXPECT_NEAR(seen(scene, askew()).x, 7.0, 1e-3);
  floor.roughness = 0.5;
  floor.glossTexture = reference::textureOf(1, 1, [](int, int) { return glm::dvec3(1.0, 0.0, 1.0); });
  EXPECT_NEAR(seen(scene, askew()).x, 7.0, 1e-3);
  floor.glossTexture = reference::textureOf(1, 1, [](int, int) { return glm::dvec3(0.0, 0.0, 0.0); });
  floor.albedo = glm::dvec3(0.0);
  const double mu = glm::normalize(askew().eye).z;
  EXPECT_NEAR(seen(scene, askew()).x, 7.0 * (0.04 + 0.96 * std::pow(1.0 - mu, 5.0)), 5e-3);
}

}  // namespace
}  // namespace lpv::evaluation
