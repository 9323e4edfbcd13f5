// Lights in cells of their own: small beside the field's, larger than its grid, outside it.

#include "lpv/resources/voxel_grid.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "gpu/frame/light_views.h"
#include "scene/lookup.h"
#include "scene/small_lights.h"

namespace lpv {
namespace {

using test::floorScene;
using test::FloorView;
using test::floorView;

/// A mesh about `at`, `across` cells along its longest edge.
EmittingLight lightOf(const MeshPtr& mesh, double across, const glm::dvec3& at, double turn = 0.0) {
  const glm::dvec3 size = mesh->bounds.extent();
  const glm::dmat4 turned = glm::rotate(glm::translate(glm::dmat4(1.0), at), turn, glm::normalize(glm::dvec3(1, 2, 3)));
  EmittingLight light;
  light.mesh = mesh;
  light.gridFromObject = glm::scale(turned, glm::dvec3(across / std::max({size.x, size.y, size.z})));
  return light;
}

// Broken by: the extent along the axes for the diagonal's; the finest cells for polygons.
TEST(VoxelGridTest, CellsFollowTheSizeAndNotThePose) {
  const MeshPtr sphere = reference::sphere();
  EXPECT_EQ(voxelGridFor(lightOf(sphere, 20.0, {8, 8, 8})).cell, 1.0);
  const double small = voxelGridFor(lightOf(sphere, 0.3, {8, 8, 8})).cell;
  EXPECT_GE(0.3 * std::numbers::sqrt3 / small, kLeastCellsAcross);
  EXPECT_LE(0.3 * std::numbers::sqrt3 / small, 2.0 * kLeastCellsAcross);
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(voxelGridFor(lightOf(sphere, 0.3, {8.0 + 0.31 * i, -40.0 * i, 2.0}, 0.1 * i)).cell, small) << i;
  }
  EXPECT_EQ(voxelGridFor(lightOf(reference::quad(), 0.3, {8, 8, 8})).cell, 1.0);
  EXPECT_EQ(voxelGridFor(lightOf(sphere, 1e-9, {8, 8, 8})).cell, std::ldexp(1.0, -kMostHalvings));
  EXPECT_EQ(voxelGridFor(lightOf(sphere, 500.0, {8, 8, 8})).cell, 4.0);
}

// Broken by: a box that ends where the field does; `lower` off by one.
TEST(VoxelGridTest, BoxesHoldTheLightWhereverItIs) {
  for (const double across : {1e-4, 0.3, 7.0, 100.0, 500.0}) {
    for (const double far : {-1e6, -130.0, -0.5, 0.0, 127.9, 128.0, 3e4}) {
      const EmittingLight light = lightOf(reference::sphere(), across, glm::dvec3(far, 3.0, -far), 0.4);
      const VoxelGrid grid = voxelGridFor(light);
      Bounds cells;
      for (const glm::vec3& p : light.mesh->positions)
        cells.add(glm::dvec3(grid.fromField() * light.gridFromObject * glm::dvec4(glm::dvec3(p), 1.0)));
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(double(grid.box.lower[axis]), cells.min[axis]) << across << " at " << far;
        EXPECT_GT(double(grid.box.upper[axis]), cells.max[axis]) << across << " at " << far;
        EXPECT_GE(grid.box.lower[axis], 0);
        EXPECT_LE(grid.box.upper[axis], grid.dims[axis]);
        EXPECT_LE(grid.dims[axis], 512);  // the tree's largest block
      }
    }
  }
}

class LightPlacesTest : public test::EngineTest {
 protected:
  /// Irradiance of the view's points, as probes read it, against the closed form.
  double errorOf(const Scene& scene, const FloorView& view) {
    TickRequest request = test::requestOf(scene, ++sessions_);
    request.transported = request.probed = true;
    const VolumePtr volume = run(request).transported;
    if (volume == nullptr) return 1e9;
    std::vector<glm::dvec3> probes;
    for (const auto& r : view.points)
      probes.push_back(irradianceWithNearField(*volume, scene.options.lookup, r.position, r.normal).rgb);
    return test::relativeErrors(probes, test::truthOn(scene, view)).raw;
  }

  SessionKey sessions_ = 0;
};

// A sphere of 720 triangles, from half its size on; from two cells on the volume is part of it, which interpolates the
// light of a point linearly. Broken by: the field's cells, whatever the light; the field's minimum distance.
TEST_F(LightPlacesTest, MeshesSmallBesideACellAreSeenAsTheyAre) {
  for (const double across : {0.02, 0.1, 0.4}) {
    for (const double below : {0.5 * across, across, 1.0, 2.5}) {
      Scene scene = floorScene(Transport::kGather, reference::sphere());
      scene.options.quality = Quality::kFast;
      Light& light = test::lightOf(scene);
      light.transform.scale *= across * scene.grid.cell;  // it was 1 m across
      const FloorView view = floorView(scene, below);
      EXPECT_LE(errorOf(scene, view), below < 2.0 ? 0.01 : 0.025) << across << " cells across, " << below << " below";
    }
  }
}

// A lamp of .05 cells, .3 cells over a floor of 20 cells: cells' centres lie above and below it, none sees what the
// floor sees. In frames, Probe and with them the self-check. Broken by: the volume beyond the near field, in either.
TEST_F(LightPlacesTest, ASmallLampOverALargeFloorIsLookedAt) {
  Scene scene = floorScene(Transport::kGather, reference::quad());
  scene.options.quality = Quality::kFast;
  test::lightOf(scene).transform.scale *= 0.05 * scene.grid.cell;
  const FloorView view = floorView(scene, 0.3);
  EXPECT_LE(errorOf(scene, view), 1e-4);
  TickRequest request = test::requestOf(scene, ++sessions_);
  request.frames = {view.frame};
  const TickResult result = run(request);
  ASSERT_EQ(result.frames.size(), 1U);
  EXPECT_LE(test::relativeErrors(test::floorIrradiance(*result.frames[0], view), test::truthOn(scene, view)).raw, 1e-3);
  EXPECT_EQ(result.report.lightsVoxelized, 0U) << "nobody reads a volume";
}

// From 3 cells above the floor: grazing light, which grows with the square of the height, is interpolated linearly.
// Broken by: boxes that end where the field does.
TEST_F(LightPlacesTest, LightsOutsideLightWhatIsInside) {
  for (const MeshPtr& mesh : {reference::quad(), reference::sphere(), reference::tube()}) {
    for (const double x : {1.7, 2.0, 2.6, 9.0}) {  // the grid ends at 2 m, the light is 1 m across
      Scene scene = floorScene(Transport::kGather, mesh);
      test::lightOf(scene).transform.translation.x = x;
      const FloorView view = floorView(scene, 3.0);
      EXPECT_LE(errorOf(scene, view), 0.03) << mesh->triangles.size() << " triangles at x = " << x;
    }
  }
}

// A ceiling of 240 m over a grid of 4 m: cells of the light are larger than the field's.
TEST_F(LightPlacesTest, LightsFarLargerThanTheGridLightIt) {
  Scene scene = floorScene(Transport::kGather, reference::sphere());
  Light& light = test::lightOf(scene);
  light.transform.scale *= glm::dvec3(240.0, 240.0, 1.0);
  light.transform.rotation = {};
  light.transform.translation = {3.0, -2.0, 60.0};
  const FloorView view = floorView(scene, 300.0);
  for (const double z : {-1.5, 0.0, 1.5}) {
    FloorView at = view;
    for (auto& r : at.points) r.position = {r.position.x, r.position.y, z};
    EXPECT_LE(errorOf(scene, at), 0.01) << z;
  }
}

double injectedPower(const Volume& injected) {
  double sum = 0.0;
  reference::forEachCell(injected.grid.dims, [&](const glm::ivec3& cell) {
    sum += Volume::at(injected.layers[0], injected.grid, cell, 0)[0];
  });
  return sum / 0.88622692545275801;  // of the clamped cosine's band 0
}

// Radiance times the area within the grid, in whatever cells. Broken by: leaves of the light taken for cells of the
// field; a cell's leaves without the last; the outer upper face beyond the grid.
TEST_F(LightPlacesTest, TheInjectedVolumeHoldsTheAreaWithinTheGrid) {
  struct Case {
    double across, x, share;
  };
  for (const Case c : {Case{0.05, 0.03, 1.0}, {0.05, 2.0, 0.5}, {1.0, 2.0, 0.5}, {1.0, 2.7, 0.0}, {0.01, -2.0, 0.5}}) {
    Scene scene = floorScene(Transport::kGather, reference::sphere());
    Light& light = test::lightOf(scene);
    light.transform.rotation = {};
    light.transform.translation = {c.x, -0.11, 0.23};
    light.transform.scale *= c.across;
    light.radiance = glm::dvec3(1.0);
    TickRequest request = test::requestOf(scene, ++sessions_);
    request.injected = true;
    const VolumePtr volume = run(request).injected;
    ASSERT_TRUE(volume != nullptr);
    const double scale = light.transform.scale.x;
    EXPECT_NEAR(injectedPower(*volume), c.share * light.mesh->area * scale * scale,
                1e-4 * light.mesh->area * scale * scale)
        << c.across << " m across at x = " << c.x;
  }
  Scene scene = floorScene(Transport::kGather, reference::quad());
  Light& light = test::lightOf(scene);
  light.transform.translation = {0.1, 0.1, 2.0};  // on the outer upper face
  light.transform.rotation = rotationFromEulerDegrees({180.0, 0.0, 0.0});
  light.radiance = glm::dvec3(1.0);
  TickRequest request = test::requestOf(scene, ++sessions_);
  request.injected = true;
  EXPECT_NEAR(injectedPower(*run(request).injected), 1.0, 1e-4);
}

}  // namespace
}  // namespace lpv
