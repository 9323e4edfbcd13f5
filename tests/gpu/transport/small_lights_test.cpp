// Lights that are small beside a cell among others that are not: looked at by frames and probes, held by the volume.

#include "scene/small_lights.h"

#include <algorithm>
#include <cmath>

#include "gpu/frame/light_views.h"
#include "scene/lookup.h"
#include "scene/predicted_error.h"

namespace lpv {
namespace {

using test::floorScene;
using test::FloorView;
using test::floorView;

/// A lamp .3 cells above a floor of 18 cells, `across` cells along its edge and as strong whatever its size, and a
/// panel of 3.8 x 3.8 m that faces the floor from 1.9 m.
Scene lampAndPanel(double across) {
  Scene scene = floorScene(Transport::kGather, reference::quad());
  scene.options.quality = Quality::kFast;
  Light& lamp = test::lightOf(scene);
  lamp.transform.scale = glm::dvec3(across * scene.grid.cell);
  lamp.radiance = glm::dvec3(0.004) / (across * across);
  auto panel = std::make_shared<Light>(lamp);
  panel->name = "panel";
  panel->transform.translation = {0.0, 0.0, 1.7};
  panel->transform.rotation = rotationFromEulerDegrees({180, 0, 0});
  panel->transform.scale = glm::dvec3(3.8);
  panel->radiance = glm::dvec3(0.001);
  scene.lights[panel->name] = panel;
  return scene;
}

class SmallLightsTest : public test::EngineTest {
 protected:
  VolumePtr volumeOf(const Scene& scene, SessionKey session = 1) {
    TickRequest request = test::requestOf(scene, session);
    request.transported = request.probed = true;
    return run(std::move(request)).transported;
  }
  /// Irradiance from a frame's pixels.
  std::vector<glm::dvec3> seenBy(const Scene& scene, const FloorView& view, bool reduced) {
    TickRequest request = test::requestOf(scene, 2);
    request.frames = {view.frame};
    request.frames[0].reduced = reduced;
    const TickResult result = run(std::move(request));
    return result.frames.empty() ? std::vector<glm::dvec3>() : test::floorIrradiance(*result.frames[0], view);
  }
  static std::vector<glm::dvec3> probed(const Scene& scene, const Volume& volume, const FloorView& view) {
    std::vector<glm::dvec3> out;
    for (const auto& r : view.points)
      out.push_back(irradianceWithNearField(volume, scene.options.lookup, r.position, r.normal).rgb);
    return out;
  }
};

// Broken by: small lights through the grid; their light in the volume that frames and probes read, too.
TEST_F(SmallLightsTest, LampsAmongOthersAreLookedAt) {
  Scene scene = lampAndPanel(0.05);
  const FloorView view = floorView(scene, 0.3);
  const auto truth = test::truthOn(scene, view);
  for (const bool reduced : {false, true})
    EXPECT_LE(test::relativeErrors(seenBy(scene, view, reduced), truth).raw, 0.01) << reduced;
  const VolumePtr volume = volumeOf(scene);
  EXPECT_EQ(volume->lookedUp.size(), volume->layers.size());
  EXPECT_LE(test::relativeErrors(probed(scene, *volume, view), truth).raw, 0.01);
  const auto frames = seenBy(scene, view, false);
  EXPECT_LE(test::relativeErrors(probed(scene, *volume, view), frames).raw, 1e-3) << "frames and probes agree";
}

// What clients get holds all light, whatever frames look at: the same as where all is looked at, in groups by hand, by
// themselves or by direction. Broken by: a share that is in neither layer; one that is in both.
TEST_F(SmallLightsTest, TheVolumeHoldsAllLight) {
  for (const double across : {0.05, 0.8}) {  // the diagonal: 1.13 cells, between small and not
    for (const std::string groups : {"", "by hand", "by direction"}) {
      Scene scene = lampAndPanel(across);
      floorView(scene, 0.3);
      for (int i = 0; groups == "by direction" && i < 30; ++i) {
        auto other = std::make_shared<Light>(*scene.lights.at("panel"));
        other->transform.scale = glm::dvec3(0.3);
        other->transform.translation = {1.7 * std::cos(i), 1.7 * std::sin(i), 0.05 * i};
        scene.lights["other " + std::to_string(i)] = other;
      }
      if (groups == "by hand") {
        auto named = std::make_shared<Light>(*scene.lights.at("light"));
        named->group = "lamp";
        scene.lights["light"] = named;
      }
      const VolumePtr volume = volumeOf(scene, 3);
      EXPECT_FALSE(volume->lookedUp.empty());
      scene.options.visibility = Visibility::kOn;
      for (auto& [name, surface] : scene.surfaces) {
        auto open = std::make_shared<Surface>(*surface);
        open->castsShadow = false;
        surface = open;
      }
      const VolumePtr whole = volumeOf(scene, 4);
      EXPECT_TRUE(whole->lookedUp.empty());
      ASSERT_EQ(volume->layers.size(), whole->layers.size()) << groups;
      double most = 0.0, apart = 0.0;
      for (std::size_t layer = 0; layer < whole->layers.size(); ++layer) {
        EXPECT_EQ(volume->layers[layer].group, whole->layers[layer].group);
        const auto &all = whole->layers[layer].coefficients, &sum = volume->layers[layer].coefficients;
        for (std::size_t i = 0; i < all.size(); ++i) {
          most = std::max(most, double(std::abs(all[i])));
          apart = std::max(apart, std::abs(double(sum[i]) - double(all[i])));
        }
      }
      EXPECT_LE(apart, 2e-6 * most) << across << " " << groups;
    }
  }
}

// A lamp of constant power grows from small to not small in 100 steps: beside what the truth changes, no receiver
// changes from step to step by more than .5 % of the largest, in frames nor in probes. Broken by: shares of 0 and 1
// alone.
TEST_F(SmallLightsTest, ALampThatGrowsDoesNotJump) {
  std::vector<double> before;
  double worst = 0.0;
  for (int step = 0; step <= 100; ++step) {
    Scene scene = lampAndPanel((0.95 + 0.6 * step / 100.0) / std::sqrt(2.0));
    scene.revision = std::uint64_t(step) + 1;
    const FloorView view = floorView(scene, 0.3, {24, 24});
    const auto truth = test::truthOn(scene, view), seen = seenBy(scene, view, false);
    const auto probes = probed(scene, *volumeOf(scene), view);
    ASSERT_EQ(seen.size(), truth.size());
    double largest = 0.0;
    std::vector<double> now;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      largest = std::max(largest, truth[i].x);
      now.push_back(seen[i].x - truth[i].x);
      now.push_back(probes[i].x - truth[i].x);
    }
    for (std::size_t i = 0; i < before.size(); ++i) worst = std::max(worst, std::abs(now[i] - before[i]) / largest);
    before = now;
  }
  EXPECT_LE(worst, 0.005);
  RecordProperty("worst", std::to_string(worst));
}

// Where surfaces need shadows everything is looked at, and the volume has no layer apart.
TEST_F(SmallLightsTest, NothingIsApartWhereAllIsLookedAt) {
  Scene scene = lampAndPanel(0.05);
  floorView(scene, 0.3);
  scene.options.visibility = Visibility::kOn;
  const VolumePtr volume = volumeOf(scene);
  EXPECT_TRUE(volume->lookedUp.empty());
  scene.options.visibility = Visibility::kOff;
  ++scene.revision;
  EXPECT_FALSE(volumeOf(scene)->lookedUp.empty());
}

}  // namespace
}  // namespace lpv
