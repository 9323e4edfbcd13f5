// A copy that takes every update is the document's snapshot, whatever was edited in between.

#include "session/document/scene_copy.h"

#include <gtest/gtest.h>

#include "unit/session/session_rig.h"

namespace lpv {
namespace {

class SceneCopyTest : public testing::Test {
 protected:
  SceneCopyTest() : blobs_(limits_), document_(LightingSettings(), limits_, test::nameOfContent) {}

  void apply(std::vector<Operation> operations) {
    ASSERT_TRUE(document_.apply(test::editOf(std::move(operations)), blobs_)) << "the edit is refused";
  }

  /// Brings the copy up to date, and compares.
  void expectSame() {
    copy_.apply(document_.takeUpdate());
    const ScenePtr expected = document_.snapshot();
    const Scene& scene = *copy_.scene();
    EXPECT_EQ(scene.revision, expected->revision);
    EXPECT_TRUE(scene.options == expected->options);
    EXPECT_TRUE(scene.grid == expected->grid);
    ASSERT_EQ(scene.lights.size(), expected->lights.size());
    for (const auto& [name, light] : expected->lights) {
      ASSERT_TRUE(scene.lights.contains(name)) << name;
      const Light& copied = *scene.lights.at(name);
      EXPECT_TRUE(light->distant || &copied == light.get()) << name;
      EXPECT_EQ(copied.placedFrom, light->placedFrom) << name;
      EXPECT_EQ(copied.mesh, light->mesh) << name;
      EXPECT_EQ(copied.transform, light->transform) << name;
    }
    EXPECT_EQ(scene.surfaces, expected->surfaces);
    EXPECT_EQ(scene.cameras.size(), expected->cameras.size());
    for (const auto& [name, camera] : expected->cameras) {
      ASSERT_TRUE(scene.cameras.contains(name)) << name;
      EXPECT_EQ(scene.cameras.at(name).eye, camera.eye);
    }
  }

  Limits limits_;
  Blobs blobs_;
  Document document_;
  SceneCopy copy_;
};

// Broken by: parts of a light that is gone; parts around the grid that was there before.
TEST_F(SceneCopyTest, FollowsTheSky) {
  Operation sky = test::createLight("sky");
  std::get<CreateLight>(sky).fields.distant = true;
  std::get<CreateLight>(sky).fields.transform.translation = glm::dvec3(0.0, 0.0, -5.0);
  apply({sky, test::createLight("sky 2"), test::createSurface("floor")});
  expectSame();
  const auto before = copy_.scene()->lights;
  apply({test::moveLight("sky 2", glm::dvec3(0.1, 0.0, 0.0))});
  expectSame();
  EXPECT_EQ(copy_.scene()->lights.at("sky/1"), before.at("sky/1")) << "made again";
  apply({test::setRadiance("sky", 3.0)});
  expectSame();
  apply({test::moveLight("sky 2", glm::dvec3(40.0, 0.0, 0.0)), FitGrid{}});
  expectSame();
  UpdateLight near{"sky", {}};
  near.fields.distant = false;
  apply({near});
  expectSame();
  apply({DeleteLight{"sky"}});
  expectSame();
}

// Red when notePending left out cameras, when takeUpdate did not name deleted objects, and when a new revision of the
// settings alone kept the scene that was there.
TEST_F(SceneCopyTest, FollowsEveryKindOfEdit) {
  expectSame();
  Camera camera;
  camera.eye = glm::dvec3(1.0, 2.0, 3.0);
  apply({test::createLight("a"), test::createLight("b"), test::createSurface("floor"), PutCamera{"view", camera}});
  expectSame();
  apply({test::moveLight("a", glm::dvec3(1.0, 0.0, 0.0))});
  apply({DeleteLight{"b"}});
  expectSame();
  camera.eye.x = 5.0;
  apply({PutCamera{"view", camera}});
  expectSame();
  apply({DeleteCamera{"view"}, DeleteSurface{"floor"}});
  expectSame();
  LightingSettings options = document_.options();
  options.lookup = options.lookup == Lookup::kSh2 ? Lookup::kCap : Lookup::kSh2;
  ASSERT_TRUE(document_.setOptions(options).ok());
  expectSame();
}

// Red when AUTO was carried out as GATHER whatever the scene; when a moving light chose anew.
TEST_F(SceneCopyTest, HasTheTransportThatTheSceneAsksFor) {
  LightingSettings options;
  options.transport = Transport::kAuto;
  options.followTransport();
  options.grid.longest = 8;
  options.grid.hasBounds = true;
  options.grid.bounds = {glm::dvec3(-20.0), glm::dvec3(20.0)};
  ASSERT_TRUE(document_.setOptions(options).ok());
  expectSame();
  EXPECT_EQ(copy_.scene()->options.transport, Transport::kGather);
  CreateLight large = std::get<CreateLight>(test::createLight("a"));
  large.fields.transform.scale = glm::dvec3(5.0);
  apply({large});
  expectSame();
  EXPECT_EQ(copy_.scene()->options.transport, Transport::kDirect);
  EXPECT_EQ(document_.options().transport, Transport::kAuto);
  Document again(document_.state(), limits_, test::nameOfContent);
  EXPECT_EQ(again.snapshot()->options.transport, Transport::kDirect);
  apply({test::moveLight("a", glm::dvec3(0.0, 300.0, 0.0))});
  expectSame();
  EXPECT_EQ(copy_.scene()->options.transport, Transport::kDirect);
  apply({DeleteLight{"a"}});
  expectSame();
  EXPECT_EQ(copy_.scene()->options.transport, Transport::kGather);
}

// Many names while nobody takes an update: the next update is the whole scene, and no name that is gone is held.
// Red when notePending kept names without end.
TEST_F(SceneCopyTest, TakesTheWholeAfterMoreNamesThanThereAreObjects) {
  expectSame();
  for (int i = 0; i < 100; ++i) {
    const std::string name = "passing" + std::to_string(i);
    apply({test::createLight(name)});
    apply({DeleteLight{name}});
  }
  apply({test::createLight("stays")});
  const SceneUpdate update = document_.takeUpdate();
  EXPECT_TRUE(update.whole);
  EXPECT_EQ(update.lights.size(), 1U);
  copy_.apply(update);
  expectSame();
}

// A scene that somebody holds does not change.
TEST_F(SceneCopyTest, LeavesEarlierScenesAsTheyAre) {
  apply({test::createLight("a")});
  expectSame();
  const ScenePtr before = copy_.scene();
  const LightPtr light = before->lights.at("a");
  apply({test::moveLight("a", glm::dvec3(1.0, 0.0, 0.0)), test::createLight("b")});
  expectSame();
  EXPECT_EQ(before->lights.size(), 1U);
  EXPECT_EQ(before->lights.at("a"), light);
  copy_.apply(document_.takeUpdate());
  EXPECT_EQ(copy_.scene()->revision, document_.revision());
}

}  // namespace
}  // namespace lpv
