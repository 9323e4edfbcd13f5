// Values an edit may bring, and the message for those it may not.
#include "scene/edits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "reference/meshes.h"

namespace lpv {
namespace {

using testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void expectRefused(const Status& status, const std::string& field, const std::string& words) {
  EXPECT_EQ(status.code(), Code::kInvalidArgument);
  EXPECT_EQ(status.field(), field);
  EXPECT_THAT(status.message(), HasSubstr(words));
}

LightFields lightWith(const glm::dvec3& radiance) {
  LightFields fields;
  fields.radiance = radiance;
  return fields;
}

TEST(CheckName, TakesOneTo200Bytes) {
  EXPECT_TRUE(checkName("lamp.001").ok());
  EXPECT_TRUE(checkName("Lampe, gr\xC3\xBCn").ok());
  EXPECT_TRUE(checkName(std::string(200, 'a')).ok());
  expectRefused(checkName(""), "name", "0 bytes");
  expectRefused(checkName(std::string(201, 'a')), "name", "201");
}

TEST(CheckName, RefusesSlashesAndControlCharacters) {
  for (const char c : {'/', '\n', '\0', '\x7f', '\t'}) {
    expectRefused(checkName(std::string("a") + c + "b"), "name", "control character or '/'");
  }
}

TEST(CheckFields, RefusesRadianceThatIsNone) {
  EXPECT_TRUE(checkFields(lightWith({0.0, 1e6, 17.0})).ok());
  expectRefused(checkFields(lightWith({0.0, -1e-9, 0.0})), "radiance", "0");
  expectRefused(checkFields(lightWith({std::nan(""), 0.0, 0.0})), "radiance", "nan");
  expectRefused(checkFields(lightWith({0.0, 0.0, kInfinity})), "radiance", "inf");
  expectRefused(checkFields(lightWith({1e30, 0.0, 0.0})), "radiance", "1000000000");
  LightFields power;
  power.power = glm::dvec3(1.0, -2.0, 3.0);
  expectRefused(checkFields(power), "power", "-2");
}

// Broken by: 65 bytes.
TEST(CheckFields, TakesGroupsOfUpTo64Bytes) {
  LightFields grouped;
  for (const std::string& group :
       {std::string(), std::string("key"), std::string("F\xC3\xBCll 2"), std::string(64, 'g')}) {
    grouped.group = group;
    EXPECT_TRUE(checkFields(grouped).ok()) << group;
  }
  grouped.group = std::string(65, 'g');
  expectRefused(checkFields(grouped), "group", "65 bytes, allowed are 0 to 64");
  for (const char c : {'/', '\n', '\0', '\x7f'}) {
    grouped.group = std::string("a") + c + "b";
    expectRefused(checkFields(grouped), "group", "control character or '/'");
  }
}

TEST(CheckFields, TakesTexturesAndDirections) {
  LightFields fields;
  fields.texture = std::string(64, 'a');
  Mesh mesh = *reference::quad();
  mesh.directions.resize(mesh.positions.size(), {0, 0, 1});
  fields.mesh = MeshReference{"", std::make_shared<const Mesh>(mesh)};
  EXPECT_TRUE(checkFields(fields).ok());
}

TEST(CheckFields, KeepsReflectanceBetweenZeroAndOne) {
  SurfaceFields fields;
  fields.albedo = glm::dvec3(0.0, 0.5, 1.0);
  fields.roughness = 0.0;
  fields.metalness = 1.0;
  EXPECT_TRUE(checkFields(fields).ok());
  fields.albedo = glm::dvec3(0.0, 0.5, 1.01);
  expectRefused(checkFields(fields), "albedo", "1.01");
  fields.albedo.reset();
  fields.roughness = std::nan("");
  expectRefused(checkFields(fields), "roughness", "nan");
  fields.roughness = 0.5;
  fields.metalness = -0.1;
  expectRefused(checkFields(fields), "metalness", "-0.1");
}

TEST(WithFields, ChangesOnlyWhatIsNamed) {
  Transform before;
  before.translation = {1, 2, 3};
  before.scale = {2, 2, 2};
  TransformFields fields;
  fields.translation = glm::dvec3(4, 5, 6);
  const Expected<Transform> after = withFields(before, fields);
  ASSERT_TRUE(after.ok());
  EXPECT_EQ(after->translation, glm::dvec3(4, 5, 6));
  EXPECT_EQ(after->scale, before.scale);
  EXPECT_EQ(after->rotation, before.rotation);
  fields.scale = glm::dvec3(1, 0, 1);
  EXPECT_EQ(withFields(before, fields).status().field(), "scale");
}

}  // namespace
}  // namespace lpv
