// Cameras: rays and matrices say the same, bad values are refused by field.
#include "scene/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lpv {
namespace {

using testing::HasSubstr;

constexpr double kAspect = 16.0 / 9.0;

Camera someCamera() {
  Camera camera;
  camera.eye = {3, 2, 5};
  camera.target = {-1, 0.5, 0};
  camera.up = {0.1, 1, 0};
  camera.fovDegrees = 42;
  return camera;
}

TEST(Camera, TheMiddleLooksAtTheTarget) {
  const Camera c = someCamera();
  const glm::dvec3 forward = glm::normalize(c.target - c.eye);
  EXPECT_NEAR(glm::distance(c.rayDirection(0.5, 0.5, kAspect), forward), 0.0, 1e-15);
}

TEST(Camera, TheTopIsUpAndTheRightIsRight) {
  Camera c;
  c.eye = {0, 0, 5};
  c.target = {0, 0, 0};
  EXPECT_GT(c.rayDirection(0.5, 0.0, kAspect).y, 0.0);  // v = 0 is the top
  EXPECT_GT(c.rayDirection(1.0, 0.5, kAspect).x, 0.0);
  const glm::dvec3 top = c.rayDirection(0.5, 0.0, kAspect);
  EXPECT_NEAR(std::atan2(top.y, -top.z), glm::radians(25.0), 1e-15);  // half of 50 degrees, vertical
  const glm::dvec3 right = c.rayDirection(1.0, 0.5, kAspect);
  EXPECT_NEAR(right.x / -right.z, kAspect * std::tan(glm::radians(25.0)), 1e-15);
}

// A point on the ray through (u, v) lands at clip position (2u - 1, 1 - 2v): pictures and rays agree.
TEST(Camera, RaysAndMatricesAgree) {
  const Camera c = someCamera();
  const glm::dmat4 clipFromWorld = c.clipFromView(kAspect) * c.viewFromWorld();
  for (const double u : {0.0, 0.3, 0.5, 0.9}) {
    for (const double v : {0.1, 0.5, 1.0}) {
      const glm::dvec3 p = c.eye + 7.5 * c.rayDirection(u, v, kAspect);
      const glm::dvec4 clip = clipFromWorld * glm::dvec4(p, 1.0);
      EXPECT_NEAR(clip.x / clip.w, 2.0 * u - 1.0, 1e-13);
      EXPECT_NEAR(clip.y / clip.w, 1.0 - 2.0 * v, 1e-13);
      EXPECT_NEAR(glm::length(c.rayDirection(u, v, kAspect)), 1.0, 1e-15);
    }
  }
}

TEST(Camera, DepthRunsFromMinusOneToOne) {
  const Camera c = someCamera();
  const auto depth = [&](double z) {
    const glm::dvec4 clip = c.clipFromView(kAspect) * glm::dvec4(0, 0, -z, 1);
    return clip.z / clip.w;
  };
  EXPECT_NEAR(depth(c.near), -1.0, 1e-12);
  EXPECT_NEAR(depth(c.far), 1.0, 1e-12);
}

TEST(Camera, SeesScenesOfMillimetresAndKilometres) {
  Camera c;
  c.eye = {0, 0, 0.005};
  c.setRangeByDistance();
  EXPECT_LE(c.near, 0.0001);
  EXPECT_EQ(c.far, 1000.0);
  c.eye = {0, 0, 5000};
  c.setRangeByDistance();
  EXPECT_EQ(c.near, 0.01);
  EXPECT_GE(c.far, 50'000.0);
  c.eye = {0, 0, 3};
  c.setRangeByDistance();
  EXPECT_EQ(c.near, Camera().near);
  EXPECT_EQ(c.far, Camera().far);
  c.eye = c.target;
  c.setRangeByDistance();
  EXPECT_EQ(checkCamera(c).field(), "target");
}

// Red with up as it is for others.
TEST(Camera, StraightDownAndUpAreViewsToo) {
  for (const glm::dvec3& target : {glm::dvec3(1, -4, 3), glm::dvec3(1, 9, 3)}) {
    Camera c;
    c.eye = {1, 2, 3};
    c.target = target;
    EXPECT_EQ(checkCamera(c).field(), "up");
    c.setUpByView();
    EXPECT_TRUE(checkCamera(c).ok());
  }
  Camera c = someCamera();
  c.setUpByView();
  EXPECT_EQ(c.up, glm::dvec3(0, 1, 0));
}

TEST(CheckCamera, RefusesByField) {
  const auto refused = [](const auto& change) {
    Camera c = someCamera();
    change(c);
    const Status status = checkCamera(c);
    EXPECT_EQ(status.code(), Code::kInvalidArgument);
    return status.field();
  };
  const double nan = std::nan("");
  EXPECT_TRUE(checkCamera(someCamera()).ok());
  EXPECT_TRUE(checkCamera(Camera()).ok());
  EXPECT_EQ(refused([&](Camera& c) { c.eye.x = nan; }), "eye");
  EXPECT_EQ(refused([&](Camera& c) { c.target.z = std::numeric_limits<double>::infinity(); }), "target");
  EXPECT_EQ(refused([&](Camera& c) { c.target = c.eye; }), "target");
  EXPECT_EQ(refused([&](Camera& c) { c.up = glm::dvec3(0.0); }), "up");
  EXPECT_EQ(refused([&](Camera& c) { c.up = 3.0 * (c.target - c.eye); }), "up");
  EXPECT_EQ(refused([&](Camera& c) { c.up.y = nan; }), "up");
  for (const double fov : {0.5, 170.5, -20.0, nan}) {
    EXPECT_EQ(refused([&](Camera& c) { c.fovDegrees = fov; }), "fov_degrees");
  }
  for (const double near : {0.0, -1.0, nan}) EXPECT_EQ(refused([&](Camera& c) { c.near = near; }), "near");
  for (const double far : {0.001, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(refused([&](Camera& c) { c.far = far; }), "far");
  }
}

TEST(DefaultCamera, SeesTheWholeContentFromALittleAbove) {
  for (const Bounds& content : {Bounds{{-2, 0, -3}, {2, 2.6, 3}}, Bounds{{99, 99, 99}, {101, 100, 100}},
                                Bounds{{0, 0, 0}, {10, 0, 0}}, Bounds{{5, 5, 5}, {5, 5, 5}}}) {
    const Camera c = defaultCamera(content);
    EXPECT_TRUE(checkCamera(c).ok()) << checkCamera(c).message();
    EXPECT_GT(c.eye.y, content.centre().y);
    const glm::dmat4 clipFromWorld = c.clipFromView(kAspect) * c.viewFromWorld();
    for (int corner = 0; corner < 8; ++corner) {
      glm::dvec3 p(0.0);
      for (int k = 0; k < 3; ++k) p[k] = (corner >> k) & 1 ? content.max[k] : content.min[k];
      const glm::dvec4 clip = clipFromWorld * glm::dvec4(p, 1.0);
      for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(clip[k] / clip.w), 1.0) << "corner " << corner << " axis " << k;
    }
  }
  EXPECT_TRUE(checkCamera(defaultCamera(Bounds())).ok());
}

}  // namespace
}  // namespace lpv
