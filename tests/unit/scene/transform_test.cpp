// Translation, rotation, scale: conventions of the command line and the wire, and what is refused.
#include "scene/transform.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <random>

#include "reference/emitter.h"

namespace lpv {
namespace {

using testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double largestDifference(const glm::dmat4& a, const glm::dmat4& b) {
  double largest = 0.0;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) largest = std::max(largest, std::abs(a[column][row] - b[column][row]));
  }
  return largest;
}

glm::dmat4 turn(double degrees, const glm::dvec3& axis) {
  return glm::rotate(glm::dmat4(1.0), glm::radians(degrees), axis);
}

Transform randomTransform(std::mt19937& random) {
  std::uniform_real_distribution<double> angle(-180.0, 180.0);
  std::uniform_real_distribution<double> size(0.2, 3.0);
  std::uniform_real_distribution<double> at(-10.0, 10.0);
  Transform t;
  t.translation = {at(random), at(random), at(random)};
  t.rotation = rotationFromEulerDegrees({angle(random), angle(random), angle(random)});
  t.scale = {size(random), size(random), size(random)};
  return t;
}

void expectRefused(const Expected<Transform>& t, const std::string& field, const std::string& words) {
  ASSERT_FALSE(t.ok());
  EXPECT_EQ(t.status().code(), Code::kInvalidArgument);
  EXPECT_EQ(t.status().field(), field);
  EXPECT_THAT(t.status().message(), HasSubstr(words));
}

TEST(Euler, QuarterTurnsFollowTheRightHand) {
  const auto turned = [](const glm::dvec3& degrees, const glm::dvec3& v) {
    return rotationFromEulerDegrees(degrees) * v;
  };
  EXPECT_NEAR(glm::distance(turned({90, 0, 0}, {0, 1, 0}), glm::dvec3(0, 0, 1)), 0.0, 1e-15);
  EXPECT_NEAR(glm::distance(turned({0, 90, 0}, {0, 0, 1}), glm::dvec3(1, 0, 0)), 0.0, 1e-15);
  EXPECT_NEAR(glm::distance(turned({0, 0, 90}, {1, 0, 0}), glm::dvec3(0, 1, 0)), 0.0, 1e-15);
}

// Intrinsic X, then Y, then Z: each about the axis already turned, so the matrices multiply X Y Z. Red for Z Y X.
TEST(Euler, IsIntrinsicXThenYThenZ) {
  const glm::dmat4 expected = turn(20, {1, 0, 0}) * turn(-50, {0, 1, 0}) * turn(110, {0, 0, 1});
  EXPECT_LE(largestDifference(glm::mat4_cast(rotationFromEulerDegrees({20, -50, 110})), expected), 1e-15);
}

TEST(Transform, ScalesThenRotatesThenTranslates) {
  Transform t;
  t.scale = {2, 3, 4};
  t.rotation = rotationFromEulerDegrees({0, 0, 90});
  t.translation = {10, 20, 30};
  const glm::dvec3 p(t.worldFromObject() * glm::dvec4(1, 1, 1, 1));
  EXPECT_NEAR(glm::distance(p, glm::dvec3(10 - 3, 20 + 2, 30 + 4)), 0.0, 1e-14);
}

// The reference composes t + q (s p) q* by itself.
TEST(Transform, MatrixEqualsTheReferences) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    Transform t = randomTransform(random);
    if (i % 3 == 0) t.scale.y = -t.scale.y;
    EXPECT_LE(largestDifference(t.worldFromObject(), reference::worldFromObject(t)), 1e-14);
  }
}

TEST(Transform, MirrorsWithAnOddNumberOfNegativeScales) {
  Transform t;
  EXPECT_FALSE(t.mirrors());
  t.scale = {-1, 1, 1};
  EXPECT_TRUE(t.mirrors());
  t.scale = {-1, -1, 2};
  EXPECT_FALSE(t.mirrors());
  t.scale = {-1, -1, -1};
  EXPECT_TRUE(t.mirrors());
}

TEST(CheckedTransform, RenormalisesAnAlmostUnitQuaternion) {
  Transform t;
  t.rotation = rotationFromEulerDegrees({10, 20, 30}) * 1.0005;
  const Expected<Transform> checked = checkedTransform(t);
  ASSERT_TRUE(checked.ok());
  EXPECT_NEAR(glm::length(checked->rotation), 1.0, 1e-15);
}

TEST(CheckedTransform, RefusesWhatIsNoTransform) {
  Transform t;
  t.translation.y = kNaN;
  expectRefused(checkedTransform(t), "translation", "finite");
  t = {};
  t.rotation = {0, 0, 0, 0};
  expectRefused(checkedTransform(t), "rotation", "unit quaternion");
  t.rotation = {1.01, 0, 0, 0};
  expectRefused(checkedTransform(t), "rotation", "1.01");
  t.rotation = {kNaN, 0, 0, 1};
  expectRefused(checkedTransform(t), "rotation", "unit quaternion");
  t = {};
  t.scale.z = 0.0;
  expectRefused(checkedTransform(t), "scale", "singular");
  t.scale.z = std::numeric_limits<double>::infinity();
  expectRefused(checkedTransform(t), "scale", "finite");
}

TEST(TransformFromMatrix, ReturnsWhatMadeTheMatrixMirrorsIncluded) {
  std::mt19937 random(2);
  for (int i = 0; i < 300; ++i) {
    Transform t = randomTransform(random);
    for (int axis = 0; axis < 3; ++axis) {
      if (i & (1 << axis)) t.scale[axis] = -t.scale[axis];
    }
    const glm::dmat4 m = t.worldFromObject();
    const Expected<Transform> back = transformFromMatrix(m);
    ASSERT_TRUE(back.ok()) << back.status().message();
    EXPECT_LE(largestDifference(back->worldFromObject(), m), 1e-13);
    EXPECT_EQ(back->mirrors(), t.mirrors());
    EXPECT_NEAR(glm::length(back->rotation), 1.0, 1e-14);
  }
}

TEST(TransformFromMatrix, TakesHalfTurns) {
  // quat_cast's branches: half turns about each axis and between.
  for (const glm::dvec3& axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1),
                                 glm::normalize(glm::dvec3(1, 1, 0)), glm::normalize(glm::dvec3(1, 1, 1))}) {
    const glm::dmat4 m = turn(180, axis);
    const Expected<Transform> t = transformFromMatrix(m);
    ASSERT_TRUE(t.ok());
    EXPECT_LE(largestDifference(t->worldFromObject(), m), 1e-14);
  }
}

TEST(TransformFromMatrix, RefusesShearSingularityAndProjection) {
  glm::dmat4 m(1.0);
  m[1].x = 0.1;
  expectRefused(transformFromMatrix(m), "matrix", "shear");
  m = glm::dmat4(1.0);
  m[2] = glm::dvec4(0.0);
  expectRefused(transformFromMatrix(m), "matrix", "singular");
  m = glm::dmat4(1.0);
  m[1] = m[0];  // two equal axes: singular as well, said as shear
  EXPECT_FALSE(transformFromMatrix(m).ok());
  m = glm::dmat4(1.0);
  m[0].w = 0.5;
  expectRefused(transformFromMatrix(m), "matrix", "affine");
  m = glm::dmat4(1.0);
  m[3].x = kNaN;
  expectRefused(transformFromMatrix(m), "matrix", "finite");
}

}  // namespace
}  // namespace lpv
