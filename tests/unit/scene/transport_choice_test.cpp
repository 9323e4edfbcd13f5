// The transport where it is left to the server.
#include "scene/transport_choice.h"

#include <gtest/gtest.h>

#include "reference/meshes.h"
#include "reference/textures.h"
#include "scene/error_goal.h"
#include "scene/forecast.h"
#include "scene/grid_choice.h"
#include "scene/predicted_error.h"

namespace lpv {
namespace {

LightingSettings left() {
  LightingSettings options;
  options.transport = Transport::kAuto;
  options.followTransport();
  return options;
}

LightPtr lightOf(const MeshPtr& mesh, const glm::dvec3& at) {
  auto out = std::make_shared<Light>();
  out->mesh = mesh;
  out->transform.translation = at;
  out->transform.rotation = rotationFromEulerDegrees({90, 0, 0});
  out->transform.scale = glm::dvec3(3.0);
  out->radiance = {6, 5, 4};
  return out;
}

/// Lamps over a floor that nothing stands on.
Scene sceneWith(int lamps, const MeshPtr& mesh = reference::quad()) {
  Scene scene;
  scene.options = resolved(left());
  for (int i = 0; i < lamps; ++i)
    scene.lights["lamp " + std::to_string(i)] = lightOf(mesh, {4.0 * (i % 4) - 6.0, 3.0, 3.5 * (i / 4) - 6.0});
  auto floor = std::make_shared<Surface>();
  floor->mesh = reference::quad();
  floor->transform.scale = glm::dvec3(30.0);
  floor->transform.rotation = rotationFromEulerDegrees({-90, 0, 0});
  floor->twoSided = false;
  scene.surfaces["floor"] = floor;
  GridOptions options;
  options.longest = 16;
  scene.grid = *fitGrid(options, contentBounds(scene));
  return scene;
}

Transport chosenFor(const Scene& scene) { return chooseTransport(scene).transport; }

/// The same where GATHER is sure to miss what is wanted.
Scene demanding(Scene scene) {
  scene.options.maxError = 1e-5;
  return scene;
}

// Broken by: DIRECT whatever is predicted; GATHER whatever is predicted.
TEST(TransportChoice, IsDirectWhereGatherIsPredictedToMiss) {
  const Scene scene = sceneWith(2);
  EXPECT_LE(*predictError(scene, scene.grid, scene.options), kWantedError);
  EXPECT_EQ(chosenFor(scene), Transport::kGather);
  EXPECT_EQ(chosenFor(demanding(scene)), Transport::kDirect);
  EXPECT_EQ(chosenFor(demanding(sceneWith(0))), Transport::kGather);
}

// Broken by: DIRECT for any number of polygons, or for textures; lights that are off.
TEST(TransportChoice, IsGatherWhereThereIsMuchToLookAt) {
  EXPECT_EQ(chosenFor(demanding(sceneWith(16))), Transport::kDirect);
  EXPECT_EQ(chosenFor(demanding(sceneWith(17))), Transport::kGather);
  Scene scene = demanding(sceneWith(16));
  auto more = std::make_shared<Light>(*scene.lights.begin()->second);
  more->enabled = false;
  scene.lights["off"] = more;
  EXPECT_EQ(chosenFor(scene), Transport::kDirect);
  scene = demanding(sceneWith(1));
  auto textured = std::make_shared<Light>(*scene.lights.begin()->second);
  textured->texture = reference::noise(8, 8);
  scene.lights["lamp 0"] = textured;
  EXPECT_EQ(chosenFor(scene), Transport::kGather);
}

// Frames look at the lights, and GATHER's volumes have groups. Broken by: DIRECT there.
TEST(TransportChoice, IsGatherWhereThereAreShadowsOrBounces) {
  Scene scene = demanding(sceneWith(1));
  scene.options.bounces = kAutoBounces;
  EXPECT_EQ(chosenFor(scene), Transport::kGather);
  scene.options.bounces = 0;
  scene.options.visibility = Visibility::kOn;
  EXPECT_EQ(chosenFor(scene), Transport::kGather);
  scene.options.visibility = Visibility::kOff;
  EXPECT_EQ(chosenFor(scene), Transport::kDirect);
}

// Broken by: a choice that reads what was chosen before.
TEST(TransportChoice, FollowsFromTheSceneAlone) {
  for (Scene scene : {sceneWith(2), demanding(sceneWith(2))}) {
    const Transport first = chosenFor(scene);
    for (const Transport before : {Transport::kDirect, Transport::kGather}) {
      scene.options.transport = before;
      EXPECT_EQ(chosenFor(scene), first);
    }
  }
}

// Broken by: settings of PROPAGATE taken; a forecast that knows neither choice nor reason.
TEST(TransportChoice, IsSaidAndHasTheSettingsOfItsTransports) {
  EXPECT_TRUE(checkOptions(left()).ok());
  EXPECT_EQ(resolved(left()).transport, Transport::kGather);
  LightingSettings count = left();
  count.injection = Injection::kCount;
  EXPECT_NE(checkOptions(count).message().find("AUTO"), std::string::npos);
  Scene scene = demanding(sceneWith(2));
  scene.options.transport = chosenFor(scene);
  const Forecast direct = forecast(scene, left());
  EXPECT_EQ(direct.choice.find("Transport DIRECT: GATHER is predicted to miss"), 0U) << direct.choice;
  EXPECT_LE(direct.error, 1e-3);
  scene = sceneWith(2);
  const std::string gather = forecast(scene, left()).choice;
  EXPECT_EQ(gather.find("Transport GATHER: it is predicted to have the wanted error"), 0U) << gather;
}

}  // namespace
}  // namespace lpv
