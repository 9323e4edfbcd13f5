// Pictures of normals: which way they bend what frames show.

#include <cmath>

#include "gpu/engine/engine_rig.h"
#include "reference/ground_truth.h"
#include "reference/receivers.h"
#include "reference/textures.h"

namespace lpv {
namespace {

using test::pixel;

class NormalMapTest : public test::EngineTest {
 protected:
  FramePtr frame(const Scene& scene, SessionKey session = 1) {
    TickRequest tick = test::requestOf(scene, session);
    tick.frames = {test::linearFrame(test::frontCamera())};
    const TickResult result = run(tick);
    return result.frames.size() == 1 ? result.frames[0] : std::make_shared<Frame>();
  }
};

/// One normal everywhere, as glTF codes it: x right, y up, z out of the picture.
TexturePtr everywhere(const glm::dvec3& normal) {
  return reference::textureOf(4, 4, [&](int, int) { return 0.5 * glm::normalize(normal) + 0.5; });
}

/// A wall in z = 0 before the camera, and a lamp to the right of and above it that is not seen.
Scene wallUnderLamp(const TexturePtr& normals, const Transform& placed = {{0, 0, 0}, {1, 0, 0, 0}, glm::dvec3(4.0)}) {
  Scene scene = test::smallScene();
  scene.options = {};
  scene.options.transport = Transport::kDirect;
  scene.options.visibility = Visibility::kOff;
  scene.options.bounces = 0;
  Light& light = test::lightOf(scene);
  light.mesh = reference::quad();
  light.transform = {{1.5, 1.0, 1.8}, rotationFromEulerDegrees({150.0, 20.0, 0.0}), glm::dvec3(0.5)};
  light.twoSided = true;
  light.visibleToCamera = false;
  Surface& wall = test::addSurface(scene, "wall", reference::quad());
  wall.transform = placed;
  wall.albedo = glm::dvec3(0.5);
  wall.normalTexture = normals;
  return scene;
}

/// Of a receiver in the plane z = 0 that pixel (x, y) shows.
double truth(const Scene& scene, int x, int y, const glm::dvec3& normal) {
  const glm::dvec3 at(4.0 * (x + 0.5) / 64.0 - 2.0, 2.0 - 4.0 * (y + 0.5) / 64.0, 0.0);
  return reference::irradiances(reference::emittersOf(scene).triangles, {{at, glm::normalize(normal)}})[0].x;
}

double received(const Frame& frame, int x, int y) { return std::acos(-1.0) / 0.5 * pixel(frame, x, y).x; }

void expectLitAs(const Frame& frame, const Scene& scene, const glm::dvec3& normal) {
  for (const glm::ivec2 at : {glm::ivec2(20, 20), glm::ivec2(45, 12), glm::ivec2(33, 50)}) {
    const double want = truth(scene, at.x, at.y, normal);
    EXPECT_NEAR(received(frame, at.x, at.y), want, 0.01 * want) << at.x << ", " << at.y;
  }
}

// Broken by: green that points down; right and up exchanged.
TEST_F(NormalMapTest, BendsRightAndUp) {
  for (const glm::dvec3& normal :
       {glm::dvec3(0, 0, 1), glm::dvec3(0.6, 0, 0.8), glm::dvec3(0, 0.6, 0.8), glm::dvec3(-0.3, 0.2, 1.0)}) {
    const Scene scene = wallUnderLamp(everywhere(normal));
    expectLitAs(*frame(scene), scene, normal);
  }
}

// Broken by: the picture's scale left out.
TEST_F(NormalMapTest, BendsAsMuchAsItsScale) {
  Scene scene = wallUnderLamp(everywhere({0.6, 0, 0.8}));
  auto wall = std::make_shared<Surface>(*scene.surfaces.at("wall"));
  wall->normalScale = 0.5;
  scene.surfaces["wall"] = wall;
  expectLitAs(*frame(scene), scene, {0.3, 0, 0.8});
  auto flat = std::make_shared<Surface>(*wall);
  flat->normalScale = 0.0;
  scene.surfaces["wall"] = flat;
  expectLitAs(*frame(scene, 2), scene, {0, 0, 1});
}

// A quarter turn takes right to up; a mirrored wall has its right at the left.
// Broken by: tangents that do not follow the uvs; a determinant's sign.
TEST_F(NormalMapTest, TurnsWithTheSurface) {
  const double pi = std::acos(-1.0);
  const Transform turned = {{0, 0, 0}, glm::angleAxis(pi / 2, glm::dvec3(0, 0, 1)), glm::dvec3(4.0)};
  Scene scene = wallUnderLamp(everywhere({0.6, 0, 0.8}), turned);
  expectLitAs(*frame(scene), scene, {0, 0.6, 0.8});
  scene = wallUnderLamp(everywhere({0.6, 0, 0.8}), {{0, 0, 0}, {1, 0, 0, 0}, {-4.0, 4.0, 4.0}});
  expectLitAs(*frame(scene, 2), scene, {-0.6, 0, 0.8});
}

// From behind the relief is the same one: what bulges towards its front is hollow.
// Broken by: bending the turned normal as the front's.
TEST_F(NormalMapTest, TheBackIsTheSameRelief) {
  const double pi = std::acos(-1.0);
  const Transform turnedOver = {{0, 0, 0}, glm::angleAxis(pi, glm::dvec3(0, 1, 0)), glm::dvec3(4.0)};
  const Scene scene = wallUnderLamp(everywhere({0.6, 0, 0.8}), turnedOver);
  // The front's normal is (-.6, 0, -.8) in world space; its back looks the other way.
  expectLitAs(*frame(scene), scene, {0.6, 0, 0.8});
}

}  // namespace
}  // namespace lpv
