// Frames of glossy surfaces, against integrals over the lights in double precision.

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "gpu/engine/engine_rig.h"
#include "reference/emitter.h"
#include "reference/textures.h"
#include "scene/gloss.h"

namespace lpv {
namespace {

using test::pixel;

constexpr glm::ivec2 kSize(64, 64);

class GlossTest : public test::EngineTest {
 protected:
  FramePtr frame(const Scene& scene, const Camera& camera, SessionKey session = 1, int samples = 1,
                 bool reduced = false) {
    TickRequest tick = test::requestOf(scene, session);
    FrameRequest request = test::linearFrame(camera, kSize);
    request.samples = samples;
    request.reduced = reduced;
    tick.frames = {request};
    const TickResult result = run(tick);
    return result.frames.size() == 1 ? result.frames[0] : std::make_shared<Frame>();
  }
};

/// Looks down on the plane y = 0 askew.
Camera above() {
  Camera camera;
  camera.eye = {0.0, 1.0, 2.5};
  camera.target = {0.0, 0.0, 0.0};
  camera.fovDegrees = 50.0;
  return camera;
}

glm::dvec3 rayThrough(const Camera& camera, int x, int y) {
  const glm::dvec3 forward = glm::normalize(camera.target - camera.eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0.0, 1.0, 0.0)));
  const double half = std::tan(0.5 * glm::radians(camera.fovDegrees));
  return glm::normalize(forward + half * (2.0 * (x + 0.5) / kSize.x - 1.0) * right +
                        half * (1.0 - 2.0 * (y + 0.5) / kSize.y) * glm::cross(right, forward));
}

/// A floor, and a square lamp of 1 m that stands 1 m behind it, .6 m up, and faces the camera.
Scene floorAndLamp(double roughness, double metalness, const glm::dvec3& albedo) {
  Scene scene = test::smallScene();
  scene.options = {};
  scene.options.transport = Transport::kDirect;
  scene.options.bounces = 0;
  scene.options.gloss = Gloss::kOn;
  Light& light = test::lightOf(scene);
  light.mesh = reference::quad();
  light.transform = {{0.0, 0.6, -1.0}, {1, 0, 0, 0}, glm::dvec3(1.0)};
  light.radiance = {3.0, 2.0, 1.0};
  Surface& floor = test::addSurface(scene, "floor", reference::quad());
  floor.transform = {{0.0, 0.0, 0.0}, rotationFromEulerDegrees({-90.0, 0.0, 0.0}), glm::dvec3(6.0)};
  floor.albedo = albedo;
  floor.roughness = roughness;
  floor.metalness = metalness;
  return scene;
}

/// What the lobe makes of the lamp of floorAndLamp(): the midpoint rule over the lamp.
glm::dvec3 lobeOfLamp(const GlossLobe& lobe, const glm::dvec3& at, const glm::dvec3& v) {
  constexpr int kParts = 200;
  const glm::dvec3 n(0.0, 1.0, 0.0);
  glm::dvec3 sum(0.0);
  for (int i = 0; i < kParts * kParts; ++i) {
    const glm::dvec2 uv = (glm::dvec2(i % kParts, i / kParts) + 0.5) / double(kParts) - 0.5;
    const glm::dvec3 d = glm::dvec3(uv.x, 0.6 + uv.y, -1.0) - at;
    const double r2 = glm::dot(d, d);
    const glm::dvec3 l = d / std::sqrt(r2);
    sum += lobe.single(n, v, l) * (std::max(l.y, 0.0) * std::max(-l.z, 0.0) / r2 / (kParts * kParts));
  }
  return sum * glossShare(glm::dot(n, v), lobe.alpha).gain(lobe.straight) * glm::dvec3(3.0, 2.0, 1.0);
}

/// What it makes of small triangles of a convex mesh, each by its middle.
glm::dvec3 lobeOf(const GlossLobe& lobe, const std::vector<reference::Emitter>& triangles, const glm::dvec3& at,
                  const glm::dvec3& v) {
  const glm::dvec3 n(0.0, 1.0, 0.0);
  glm::dvec3 sum(0.0);
  for (const reference::Emitter& t : triangles) {
    const glm::dvec3 d = t.positionAt(glm::dvec3(1.0 / 3.0)) - at;
    const double r2 = glm::dot(d, d);
    const glm::dvec3 l = d / std::sqrt(r2);
    sum += lobe.single(n, v, l) * t.radiance * (std::max(l.y, 0.0) * std::max(-glm::dot(t.areaNormal(), l), 0.0) / r2);
  }
  return sum * glossShare(glm::dot(n, v), lobe.alpha).gain(lobe.straight);
}

struct Errors {
  double relative = 0.0;  ///< L2
  int pixels = 0;
};

/// Over every fourth pixel that shows the floor.
Errors errorsOf(const Frame& got, const Camera& camera, const GlossLobe& lobe) {
  double squared = 0.0, all = 0.0;
  Errors out;
  for (int y = 1; y < kSize.y; y += 4) {
    for (int x = 1; x < kSize.x; x += 4) {
      const glm::dvec3 ray = rayThrough(camera, x, y);
      const double at = -camera.eye.y / ray.y;
      const glm::dvec3 place = camera.eye + at * ray;
      if (at <= 0.0 || place.z < -0.95 || std::abs(place.x) > 2.9 || std::abs(place.z) > 2.9) continue;
      const glm::dvec3 want = lobeOfLamp(lobe, place, -ray), off = pixel(got, x, y) - want;
      squared += glm::dot(off, off);
      all += glm::dot(want, want);
      ++out.pixels;
    }
  }
  out.relative = std::sqrt(squared / all);
  return out;
}

// Red without weights between rays to lights and of the lobe, without the gain, or with the metal's albedo left out.
TEST_F(GlossTest, AMetalFloorReflectsALamp) {
  for (const double roughness : {0.1, 0.3, 0.6, 1.0}) {
    const glm::dvec3 albedo(0.9, 0.6, 0.3);
    const Scene scene = floorAndLamp(roughness, 1.0, albedo);
    const Errors errors = errorsOf(*frame(scene, above()), above(), GlossLobe::of(albedo, roughness, 1.0));
    EXPECT_GT(errors.pixels, 80);
    EXPECT_LT(errors.relative, 0.07) << roughness;
  }
}

TEST_F(GlossTest, ABlackDielectricReflectsALamp) {
  for (const double roughness : {0.1, 0.5}) {
    const Scene scene = floorAndLamp(roughness, 0.0, glm::dvec3(0.0));
    const Errors errors = errorsOf(*frame(scene, above()), above(), GlossLobe::of(glm::dvec3(0.0), roughness, 0.0));
    EXPECT_LT(errors.relative, 0.07) << roughness;
  }
}

/// Of a mirror's picture of the lamp: pixels that show it, where all but those within `edge` metres of its edges show
/// what they should.
int litPixels(const Frame& got, const Camera& camera, double edge) {
  int lit = 0;
  for (int y = 0; y < kSize.y; ++y) {
    for (int x = 0; x < kSize.x; ++x) {
      const glm::dvec3 ray = rayThrough(camera, x, y);
      const double at = -camera.eye.y / ray.y;
      const glm::dvec3 place = camera.eye + at * ray, to(ray.x, -ray.y, ray.z);
      if (at <= 0.0 || place.z < -0.95) continue;
      const glm::dvec3 there = place + to * ((-1.0 - place.z) / to.z);
      const double inside = 0.5 - std::max(std::abs(there.x), std::abs(there.y - 0.6));
      if (to.z >= 0.0 || std::abs(inside) < edge) continue;
      const double fresnel = std::pow(1.0 - to.y, 5.0), share = inside > 0.0 ? 0.5 + 0.5 * fresnel : 0.0;
      EXPECT_NEAR(pixel(got, x, y).x, 3.0 * share, 0.01) << x << ", " << y;
      lit += inside > 0.0 ? 1 : 0;
    }
  }
  return lit;
}

// A lobe below a mesh that all but touches the floor has a small part of it in it. Red where the points of the mesh are
// those of shadow rays, which are too few for that (.017).
TEST_F(GlossTest, AMetalFloorReflectsAMeshJustAboveIt) {
  const glm::dvec3 albedo(0.9, 0.6, 0.3);
  for (const double roughness : {0.3, 0.6}) {
    Scene scene = floorAndLamp(roughness, 1.0, albedo);
    Light& light = test::lightOf(scene);
    light.mesh = reference::sphereOf(80, 40);
    const glm::dvec3 middle(0.0, 0.46, 0.0);
    light.transform = {middle, {1, 0, 0, 0}, glm::dvec3(0.45)};
    Camera low = above();
    low.eye = {0.0, 0.25, 2.0};
    low.target = {0.0, 0.0, 0.25};
    low.fovDegrees = 20.0;
    const std::vector<reference::Emitter> emitters = reference::emittersOf(scene).triangles;
    const GlossLobe lobe = GlossLobe::of(albedo, roughness, 1.0);
    const FramePtr got = frame(scene, low);
    double squared = 0.0, all = 0.0, ours = 0.0, wanted = 0.0;
    int count = 0;
    for (int y = 1; y < kSize.y; y += 3) {
      for (int x = 1; x < kSize.x; x += 3) {
        const glm::dvec3 ray = rayThrough(low, x, y), place = low.eye - low.eye.y / ray.y * ray;
        const glm::dvec3 past = middle - low.eye - glm::dot(middle - low.eye, ray) * ray;
        if (ray.y >= 0.0 || glm::length(past) < 0.46) continue;  // the lamp is seen
        const glm::dvec3 want = lobeOf(lobe, emitters, place, -ray), off = pixel(*got, x, y) - want;
        squared += glm::dot(off, off);
        all += glm::dot(want, want);
        ours += pixel(*got, x, y).y;
        wanted += want.y;
        ++count;
      }
    }
    EXPECT_GT(count, 60);
    EXPECT_NEAR(ours / wanted, 1.0, 0.01) << roughness;
    EXPECT_LT(std::sqrt(squared / all), 0.015) << roughness;
  }
}

// Red where the mirror looks at what is behind it, or shows its own colour twice.
TEST_F(GlossTest, AMirrorShowsTheLampWhereItIs) {
  const Scene scene = floorAndLamp(0.0, 1.0, glm::dvec3(0.5));
  EXPECT_GT(litPixels(*frame(scene, above()), above(), 0.05), 100);
}

// Rays begin off the surface. Red where they begin straight above the pixel's place, and not on the way through it.
TEST_F(GlossTest, AMirrorsPictureIsNotMoved) {
  const Scene scene = floorAndLamp(0.0, 1.0, glm::dvec3(0.5));
  Camera far = above();
  far.eye *= 4.0;
  far.target = {0.4878, 0.0, -0.7317};  // what shows the lamp's corner; a pixel is about a millimetre
  far.fovDegrees = 0.4;
  const int lit = litPixels(*frame(scene, far), far, 1.5e-3);
  EXPECT_GT(lit, 500);
  EXPECT_LT(lit, kSize.x * kSize.y - 500);
}

/// A sphere in a closed box of light of radiance 1.
Scene furnace(double roughness, double metalness) {
  Scene scene = test::smallScene();
  scene.options = {};
  scene.options.bounces = 0;
  scene.options.gloss = Gloss::kOn;
  Light& light = test::lightOf(scene);
  light.mesh = reference::box({-1.9, -1.9, -1.9}, {1.9, 1.9, 1.9}, true);
  light.transform = {};
  light.radiance = glm::dvec3(1.0);
  Surface& ball = test::addSurface(scene, "ball", reference::sphereOf(48, 24));
  ball.transform.scale = glm::dvec3(0.5);
  ball.albedo = glm::dvec3(1.0);
  ball.roughness = roughness;
  ball.metalness = metalness;
  return scene;
}

TEST_F(GlossTest, AWhiteBallIsNotSeenInAFurnace) {
  for (const double metalness : {0.0, 1.0}) {
    for (const double roughness : {0.0, 0.1, 0.3, 0.6, 0.99}) {
      const FramePtr got = frame(furnace(roughness, metalness), test::frontCamera(1.5));
      double sum = 0.0;
      int count = 0;
      for (int y = 24; y < 40; ++y) {
        for (int x = 24; x < 40; ++x, ++count) sum += pixel(*got, x, y).y;
      }
      EXPECT_NEAR(sum / count, 1.0, 0.02) << "roughness " << roughness << ", metalness " << metalness;
    }
  }
}

// A mirror in a lit box shows the wall behind the camera as a camera would that looks at it.
TEST_F(GlossTest, AMirrorShowsSurfacesAsTheyAreLit) {
  Scene scene = test::smallScene();
  scene.options = {};
  scene.options.bounces = 0;
  scene.options.gloss = Gloss::kOn;
  Light& light = test::lightOf(scene);
  light.mesh = reference::quad();
  light.transform = {{0.0, 1.6, 1.0}, rotationFromEulerDegrees({90.0, 0.0, 0.0}), glm::dvec3(0.8)};
  Surface& wall = test::addSurface(scene, "wall", reference::quad());  // behind the camera, half red by its picture
  wall.transform = {{0.0, 0.0, 1.9}, rotationFromEulerDegrees({0.0, 180.0, 0.0}), glm::dvec3(3.6)};
  wall.albedoTexture = reference::textureOf(2, 2, [](int x, int) { return glm::dvec3(x == 0 ? 0.8 : 0.2, 0.5, 0.1); });
  Surface& mirror = test::addSurface(scene, "mirror", reference::quad());
  mirror.transform = {{0.0, 0.0, -1.9}, {1, 0, 0, 0}, glm::dvec3(3.6)};
  mirror.albedo = glm::dvec3(1.0);
  mirror.metalness = 1.0;
  mirror.roughness = 0.0;
  Camera into = test::frontCamera(0.0);
  into.eye = {0.0, 0.0, 0.0};
  into.target = {0.0, 0.0, -1.0};
  Camera behind = into;  // where the mirror has the first one, looking back
  behind.eye = {0.0, 0.0, -3.8};
  behind.target = {0.0, 0.0, 1.0};
  const FramePtr got = frame(scene, into), streamed = frame(scene, into, 3, 1, true);
  auto gone = std::make_shared<Surface>(*scene.surfaces["mirror"]);
  gone->visibleToCamera = false;
  gone->castsShadow = false;
  scene.surfaces["mirror"] = gone;
  const FramePtr want = frame(scene, behind, 2);
  double squared = 0.0, squaredOfStream = 0.0, all = 0.0;
  for (int y = 20; y < 44; ++y) {  // within the wall
    for (int x = 20; x < 44; ++x) {
      const glm::dvec3 there = pixel(*want, 63 - x, y), off = pixel(*got, x, y) - there;
      squared += glm::dot(off, off);
      squaredOfStream += glm::dot(pixel(*streamed, x, y) - there, pixel(*streamed, x, y) - there);
      all += glm::dot(there, there);
    }
  }
  EXPECT_GT(all, 0.0);
  EXPECT_LT(std::sqrt(squared / all), 0.03);
  EXPECT_LT(std::sqrt(squaredOfStream / all), 0.05);
}

// Red where every pixel has a lobe in a scene where one surface has.
TEST_F(GlossTest, MatteSurfacesAreAsWithout) {
  Scene scene = floorAndLamp(1.0, 0.0, glm::dvec3(0.5));
  Surface& other = test::addSurface(scene, "other", reference::quad());  // glossy, and not in the picture
  other.transform = {{0.0, 0.5, 5.0}, {1, 0, 0, 0}, glm::dvec3(0.5)};
  other.metalness = 1.0;
  const FramePtr on = frame(scene, above());
  scene.options.gloss = Gloss::kOff;
  const FramePtr off = frame(scene, above(), 2);
  ASSERT_FALSE(on->rgb32f.empty());
  EXPECT_EQ(on->rgb32f, off->rgb32f);
}

// Half of the floor by a picture as rough and metal as one floor, half as another. Red with roughness and metalness
// exchanged, with red in the place of green, or where the picture is looked up upside down.
TEST_F(GlossTest, APictureSaysWhatIsRoughAndMetal) {
  const glm::dvec3 albedo(0.9, 0.6, 0.3);
  const double whole = 0.8;
  const glm::dvec3 left(0.9, 0.25, 1.0), right(0.1, 0.75, 0.125);
  Scene scene = floorAndLamp(whole, whole, albedo);
  const auto floor = std::make_shared<Surface>(*scene.surfaces.at("floor"));
  floor->glossTexture = reference::textureOf(64, 64, [&](int x, int y) {
    return x < 32 ? left : y < 32 ? right : glm::dvec3(1.0);
  });
  scene.surfaces["floor"] = floor;
  const FramePtr got = frame(scene, above());
  const auto expectAlike = [&](const glm::dvec3& texel, int x0, int x1, int y0, int y1, SessionKey session) {
    const FramePtr want = frame(floorAndLamp(whole * texel.y, whole * texel.z, albedo), above(), session);
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        const glm::dvec3 there = pixel(*want, x, y);
        EXPECT_LE(glm::length(pixel(*got, x, y) - there), 1e-3 + 0.01 * there.x) << x << ", " << y;
      }
    }
  };
  // The middle of the floor, where the picture's quarters meet, is the middle of the frame.
  expectAlike(left, 4, 24, 24, 60, 2);
  expectAlike(right, 40, 60, 22, 26, 3);
  expectAlike(glm::dvec3(1.0), 40, 60, 40, 60, 4);
}

TEST_F(GlossTest, TheSameSceneGivesTheSameBytes) {
  const Scene scene = floorAndLamp(0.3, 0.5, glm::dvec3(0.5));
  const FramePtr one = frame(scene, above(), 1, 4), other = frame(scene, above(), 2, 4);
  ASSERT_FALSE(one->rgb32f.empty());
  EXPECT_EQ(one->rgb32f, other->rgb32f);
}

}  // namespace
}  // namespace lpv
