// Whether a scene can have shadows at all: where not, nothing is to be paid for them.
#include "scene/shadowing.h"

#include <gtest/gtest.h>

#include "reference/meshes.h"
#include "reference/room.h"

namespace lpv {
namespace {

Surface& add(Scene& scene, const std::string& name, const MeshPtr& mesh, const glm::dvec3& at,
             const glm::dvec3& scale = glm::dvec3(1.0)) {
  auto surface = std::make_shared<Surface>();
  surface->name = name;
  surface->mesh = mesh;
  surface->transform.translation = at;
  surface->transform.scale = scale;
  scene.surfaces[name] = surface;
  return *surface;
}

/// A lamp in the middle of a closed room, nothing else.
Scene emptyRoom() {
  Scene scene;
  add(scene, "room", reference::box(glm::dvec3(-2.0), glm::dvec3(2.0), true), glm::dvec3(0.0));
  auto lamp = std::make_shared<Light>();
  lamp->name = "lamp";
  lamp->mesh = reference::sphere();
  scene.lights["lamp"] = lamp;
  return scene;
}

/// The same with the lamp changed.
template <typename Change>
Scene withLamp(Change change) {
  Scene scene = emptyRoom();
  auto lamp = std::make_shared<Light>(*scene.lights.at("lamp"));
  change(*lamp);
  scene.lights["lamp"] = lamp;
  return scene;
}

TEST(ShadowsPossible, NotInAnEmptyRoom) { EXPECT_FALSE(shadowsPossible(emptyRoom())); }

// Broken by: planes that are moved with the object, but not turned.
TEST(ShadowsPossible, NotInARoomThatStandsAskew) {
  Scene scene = emptyRoom();
  auto room = std::make_shared<Surface>(*scene.surfaces.at("room"));
  room->transform.rotation = rotationFromEulerDegrees({20.0, 30.0, 40.0});
  scene.surfaces["room"] = room;
  EXPECT_FALSE(shadowsPossible(scene));
}

TEST(ShadowsPossible, ByABoxInTheRoom) {
  Scene scene = emptyRoom();
  add(scene, "box", reference::box(glm::dvec3(-0.2), glm::dvec3(0.2)), {1.0, 0.0, -1.0});
  EXPECT_TRUE(shadowsPossible(scene));
}

// A picture that hangs on the wall is in nobody's way; one that stands off it is.
TEST(ShadowsPossible, ByAQuadOffTheWallOnly) {
  Scene hung = emptyRoom(), standing = emptyRoom();
  add(hung, "picture", reference::quad(), {0.0, 0.0, -2.0});
  add(standing, "picture", reference::quad(), {0.0, 0.0, -1.9});
  EXPECT_FALSE(shadowsPossible(hung));
  EXPECT_TRUE(shadowsPossible(standing));
}

// Broken by: lights that are left out of what must lie on one side.
TEST(ShadowsPossible, ByAWallThatTheLampIsOutsideOf) {
  EXPECT_TRUE(shadowsPossible(withLamp([](Light& lamp) { lamp.transform.translation = {0.0, 0.0, 5.0}; })));
}

TEST(ShadowsPossible, ByALightThatIsInItsOwnWay) {
  EXPECT_TRUE(shadowsPossible(withLamp([](Light& lamp) { lamp.mesh = reference::bumpySphere(400); })));
  EXPECT_FALSE(shadowsPossible(withLamp([](Light& lamp) { lamp.mesh = reference::quadOf(8); })));
}

TEST(ShadowsPossible, NotWithoutLight) {
  Scene scene = withLamp([](Light& lamp) { lamp.enabled = false; });
  add(scene, "box", reference::box(glm::dvec3(-0.2), glm::dvec3(0.2)), {1.0, 0.0, -1.0});
  EXPECT_FALSE(shadowsPossible(scene));
  scene.lights.clear();
  EXPECT_FALSE(shadowsPossible(scene));
  EXPECT_FALSE(shadowsPossible(Scene()));
}

/// A panel of .4 m, `height` above the floor of the empty room, turned about x by so many degrees: 0 faces up.
Scene withPanel(double height, double degrees, bool twoSided) {
  Scene scene = withLamp([&](Light& lamp) {
    lamp.mesh = reference::quad();
    lamp.transform.scale = glm::dvec3(0.4);
    lamp.transform.rotation = rotationFromEulerDegrees({degrees, 0.0, 0.0});
    lamp.transform.translation = {0.0, 0.0, height - 2.0};
    lamp.twoSided = twoSided;
  });
  scene.options = {};
  scene.options.bounces = kAutoBounces;
  return scene;
}

// Broken by: lights that send to both sides where they have one; distances to a light's middle.
TEST(LightsSwallow, WhatTheyShineAtFromNear) {
  EXPECT_TRUE(lightsSwallow(withPanel(0.05, 180.0, false))) << "faces the floor";
  EXPECT_FALSE(lightsSwallow(withPanel(0.05, 0.0, false))) << "its back to the floor";
  EXPECT_TRUE(lightsSwallow(withPanel(0.05, 0.0, true)));
  EXPECT_FALSE(lightsSwallow(withPanel(1.0, 180.0, true))) << "far away";
}

TEST(IsShadowed, AsTheSettingsSay) {
  Scene empty = emptyRoom(), furnished = reference::smallRoom();
  for (Scene* scene : {&empty, &furnished}) scene->options = {};
  EXPECT_FALSE(isShadowed(empty));
  EXPECT_TRUE(isShadowed(furnished));
  empty.options.visibility = Visibility::kOn;
  EXPECT_TRUE(isShadowed(empty));
  furnished.options.visibility = Visibility::kOff;
  EXPECT_FALSE(isShadowed(furnished));
}

TEST(IsShadowed, NeverWithPropagate) {
  const Scene room = reference::smallRoom();
  ASSERT_EQ(room.options.transport, Transport::kPropagate);
  EXPECT_FALSE(isShadowed(room));
}

/// Far from the origin positions are rounded more.
Mesh moved(Mesh mesh, float by) {
  for (glm::vec3& p : mesh.positions) p.x += by;
  EXPECT_TRUE(finishMesh(mesh).ok());
  return mesh;
}

// Broken by: a share of the extent alone for how far off a plane a vertex may be.
TEST(IsConvex, RoundedPositionsFoldNothing) {
  for (const float by : {10.0F, 100.0F, 300.0F}) {
    EXPECT_TRUE(isConvex(moved(*reference::sphere(), by))) << by;
    EXPECT_TRUE(isConvex(moved(*reference::pyramid(), by))) << by;
    EXPECT_FALSE(isConvex(moved(*reference::bumpySphere(400), by))) << by;
  }
}

TEST(IsConvex, TellsFoldedMeshesFromOthers) {
  EXPECT_TRUE(isConvex(*reference::quad()));
  EXPECT_TRUE(isConvex(*reference::sphere()));
  EXPECT_TRUE(isConvex(*reference::pyramid()));
  EXPECT_TRUE(isConvex(*reference::box(glm::dvec3(-1.0), glm::dvec3(1.0))));
  EXPECT_FALSE(isConvex(*reference::bumpySphere(400)));
  EXPECT_FALSE(isConvex(*reference::slivers(20, 0.1)));
}

}  // namespace
}  // namespace lpv
