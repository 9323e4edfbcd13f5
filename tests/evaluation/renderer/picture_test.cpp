// Pictures: what is seen, where, and how much light it sends.

#include <gtest/gtest.h>

#include <glm/gtc/constants.hpp>

#include "reference/meshes.h"
#include "renderer/picture.h"
#include "renderer/test_scenes.h"

namespace lpv::evaluation {
namespace {

Camera fromFront() {
  Camera camera;
  camera.eye = {0, 0, 2};
  camera.target = {0, 0, 0};
  camera.fovDegrees = 90.0;
  return camera;
}

Picture pictureOf(const Scene& scene, const Camera& camera, const glm::ivec2& size, PixelFilter filter,
                  int threads = 2) {
  const TracedScene traced(scene);
  Sampling sampling;
  sampling.samples = 1024;
  sampling.threads = threads;
  return renderPicture(traced, PathTracer(traced, {0, 1}), camera, size, filter, sampling);
}

// Broken by: rows from the bottom; the normal not turned to the viewer; albedo without / pi.
TEST(Pictures, ASurfaceShowsAlbedoTimesIrradianceOverPi) {
  Scene scene;
  addLight(scene, reference::quad(), movedTo({0, 0, 3}, {0, 180, 0}), glm::dvec3(4.0));
  addSurface(scene, reference::quad(), movedTo({0, 0, 0}, {0, 180, 0}, {8, 8, 1}), {0.5, 0.25, 0.125});
  Camera camera = fromFront();
  camera.fovDegrees = 60.0;
  const Picture p = pictureOf(scene, camera, {9, 5}, PixelFilter::kCentre);
  const std::size_t centre = p.index(4, 2);
  EXPECT_EQ(p.object[centre], 2.0F);
  EXPECT_NEAR(glm::length(p.position[centre]), 0.0, 1e-5);
  EXPECT_NEAR(p.normal[centre].z, 1.0, 1e-6);
  EXPECT_GT(p.position[p.index(4, 0)].y, 0.5F);
  EXPECT_GT(p.position[p.index(8, 2)].x, 0.5F);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(double(p.radiance[0][centre][c]),
                double(p.albedo[centre][c] * p.irradiance[0][centre][c]) / glm::pi<double>(), 1e-6);
  }
  EXPECT_NEAR(double(p.albedo[centre].y), 0.25, 1e-7);
  EXPECT_GT(p.irradiance[0][centre].x, 0.3F);
}

// Broken by: the camera seeing backs; a one-sided surface that lets light through from behind.
TEST(Pictures, AOneSidedSurfaceIsNotDrawnFromBehindButBlocksLight) {
  Scene scene;
  addLight(scene, reference::quad(), movedTo({0, 0, 1.5}, {0, 180, 0}), glm::dvec3(4.0));
  addSurface(scene, reference::quad(), movedTo({0, 0, 0}, {0, 0, 0}, {8, 8, 1}), glm::dvec3(0.5));
  addSurface(scene, reference::quad(), movedTo({0, 0, 1}, {0, 180, 0}, {4, 4, 1}), glm::dvec3(0.5)).twoSided = false;
  Camera camera = fromFront();
  camera.eye = {0, 0, 1.2};
  const Picture p = pictureOf(scene, camera, {5, 5}, PixelFilter::kCentre);
  const std::size_t centre = p.index(2, 2);
  EXPECT_EQ(p.object[centre], 2.0F) << "the first surface, behind the one that is not drawn";
  EXPECT_EQ(p.irradiance[0][centre].x, 0.0F);
  EXPECT_GT(p.unoccluded[centre].x, 0.5F);
}

TEST(Pictures, TheBackOfALightIsBlackAndHidesWhatIsBehind) {
  Scene scene;
  addLight(scene, reference::quad(), movedTo({0, 0, 1}, {0, 180, 0}), glm::dvec3(4.0));
  addSurface(scene, reference::quad(), movedTo({0, 0, 0}, {0, 0, 0}, {8, 8, 1}), glm::dvec3(0.5));
  const Picture p = pictureOf(scene, fromFront(), {5, 5}, PixelFilter::kCentre);
  EXPECT_EQ(p.object[p.index(2, 2)], 1.0F);
  EXPECT_EQ(p.radiance[0][p.index(2, 2)].x, 0.0F);
}

// The light's edge runs through the middle of the centre pixel.
// Broken by: samples that do not cover the pixel evenly.
TEST(Pictures, TheBoxFilterIsTheMeanOverThePixel) {
  Scene scene;
  addLight(scene, reference::quad(), movedTo({5, 0, 0}, {0, 0, 0}, {10, 10, 1}), glm::dvec3(3.0));
  const Picture box = pictureOf(scene, fromFront(), {5, 5}, PixelFilter::kBox);
  const Picture centre = pictureOf(scene, fromFront(), {5, 5}, PixelFilter::kCentre);
  EXPECT_NEAR(double(box.radiance[0][box.index(2, 2)].x), 1.5, 0.01);
  EXPECT_EQ(box.radiance[0][box.index(1, 2)].x, 0.0F);
  EXPECT_NEAR(double(box.radiance[0][box.index(3, 2)].x), 3.0, 1e-6);
  EXPECT_NEAR(double(centre.radiance[0][centre.index(3, 2)].x), 3.0, 1e-6);
}

TEST(Pictures, AreTheSameWhateverTheNumberOfThreads) {
  Scene scene;
  addLight(scene, reference::quad(), movedTo({0, 1, 1}, {60, 180, 0}), glm::dvec3(4.0));
  addSurface(scene, reference::box({-2, -1, -2}, {2, 3, 2}, true), Transform(), glm::dvec3(0.5));
  const Picture one = pictureOf(scene, fromFront(), {8, 6}, PixelFilter::kBox, 1);
  const Picture three = pictureOf(scene, fromFront(), {8, 6}, PixelFilter::kBox, 3);
  EXPECT_EQ(one.radiance, three.radiance);
  EXPECT_EQ(one.irradiance, three.irradiance);
}

}  // namespace
}  // namespace lpv::evaluation
