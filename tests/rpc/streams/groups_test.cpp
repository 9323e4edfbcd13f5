// Light groups as clients see them: a layer of the volume for each.

#include <gtest/gtest.h>

#include <cmath>

#include "lpv/convert.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using ::testing::ElementsAre;

using Points = std::vector<std::pair<glm::dvec3, glm::dvec3>>;

class Groups : public ::testing::Test {
 protected:
  client::VolumeResult volume(const std::string& session, pb::VolumeFormat format = pb::VOLUME_FORMAT_FLOAT) {
    client::Client client = clientOf(server().address());
    pb::GetVolumeRequest request;
    request.set_session(session);
    request.set_format(format);
    Expected<client::VolumeResult> result = client.volume(request);
    EXPECT_TRUE(result.ok()) << result.status().message();
    return result ? std::move(*result) : client::VolumeResult();
  }
  std::vector<std::string> groups(const std::string& session) {
    std::vector<std::string> out;
    const client::VolumeResult result = volume(session);
    for (const pb::VolumeLayer& layer : result.header.layers()) out.push_back(layer.group());
    return out;
  }
  std::string sessionOf(const std::vector<pb::Operation>& operations, int cells = 16) {
    const std::string session = makeSession(stubs_, settings(cells));
    apply(stubs_, session, operations);
    return session;
  }

  Stubs stubs_{server().address()};
};

/// Two lamps below the ceiling, 1 m apart, that shine downwards (-z); the right one is the brighter.
std::vector<pb::Operation> twoLamps(const std::string& leftGroup, const std::string& rightGroup) {
  pb::Light left = light("Left", quad(0.1F));
  *left.mutable_transform()->mutable_rotation() = client::toProto(glm::dquat(0, 1, 0, 0));  // half a turn about x
  pb::Light right = left;
  right.set_name("Right");
  *right.mutable_radiance() = vec3(8, 8, 8);
  *left.mutable_transform()->mutable_translation() = vec3(-0.5, 0.02, 0.55);
  *right.mutable_transform()->mutable_translation() = vec3(0.5, 0.02, 0.55);
  left.set_group(leftGroup);
  right.set_group(rightGroup);
  return {client::createLight(left), client::createLight(right)};
}

// Broken by: names in the opposite order.
TEST_F(Groups, AreLayersByName) {
  const client::VolumeResult one = volume(sessionOf(twoLamps("all", "all")));
  const client::VolumeResult two = volume(sessionOf(twoLamps("window", "door")));
  ASSERT_EQ(one.volume.layers.size(), 1U);
  EXPECT_EQ(one.volume.layers[0].group, "all");
  ASSERT_EQ(two.volume.layers.size(), 2U);
  EXPECT_EQ(two.volume.layers[0].group, "door");
  EXPECT_EQ(two.volume.layers[1].group, "window");
  const std::vector<float>& all = one.volume.layers[0].coefficients;
  const std::vector<float>& door = two.volume.layers[0].coefficients;
  const std::vector<float>& window = two.volume.layers[1].coefficients;
  double largest = 0.0;
  double worst = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    largest = std::max(largest, std::abs(double(all[i])));
    worst = std::max(worst, std::abs(double(door[i]) + double(window[i]) - double(all[i])));
  }
  EXPECT_LE(worst, 1e-5 * largest);
}

// The floor sees both lamps above it, where CAP is exact: in one group or in two, the same irradiance. Broken
// by: probes of the first layer only.
TEST_F(Groups, AreLookedUpOneByOneAndSummed) {
  Points floor;
  for (int i = -3; i <= 3; ++i) floor.push_back({{0.2 * i, 0.1, -0.75}, {0, 0, 1}});
  const std::vector<glm::dvec3> together = probe(stubs_, sessionOf(twoLamps("all", "all")), floor);
  const std::vector<glm::dvec3> apart = probe(stubs_, sessionOf(twoLamps("window", "door")), floor);
  for (std::size_t i = 0; i < floor.size(); ++i) EXPECT_NEAR(apart[i].x / together[i].x, 1.0, 0.03) << i;
}

// Broken by: the first layer's scale for all.
TEST_F(Groups, HaveAScaleEachInHalfFloats) {
  const std::string session = sessionOf(twoLamps("window", "door"));
  const client::VolumeResult floats = volume(session);
  const client::VolumeResult halves = volume(session, pb::VOLUME_FORMAT_HALF_FLOAT);
  ASSERT_EQ(halves.header.layers_size(), 2);
  EXPECT_EQ(halves.header.layers(0).scale(), 8.0 * halves.header.layers(1).scale()) << "the door's is the bright one";
  for (std::size_t layer = 0; layer < 2; ++layer) {
    for (std::size_t i = 0; i < floats.volume.layers[layer].coefficients.size(); ++i) {
      const double exact = floats.volume.layers[layer].coefficients[i];
      ASSERT_NEAR(halves.volume.layers[layer].coefficients[i], exact, std::abs(exact) / 2048.0 + 1e-9) << i;
    }
  }
}

// Broken by: names in the opposite order.
TEST_F(Groups, FollowTheLightsThatShine) {
  const std::string session = makeSession(stubs_);
  EXPECT_THAT(groups(session), ElementsAre("")) << "no light: one layer all the same";
  apply(stubs_, session, twoLamps("window", "door"));
  EXPECT_THAT(groups(session), ElementsAre("door", "window"));
  apply(stubs_, session, {client::setEnabled("Left", false)});
  EXPECT_THAT(groups(session), ElementsAre("door"));
  pb::Light change;
  change.set_name("Right");
  change.set_group("");
  apply(stubs_, session, {client::setEnabled("Left", true), client::updateLight(change, {"group"})});
  EXPECT_THAT(groups(session), ElementsAre("", "window"));
  apply(stubs_, session, {client::deleteLight("Left"), client::deleteLight("Right")});
  EXPECT_THAT(groups(session), ElementsAre(""));
}

// As many as a volume has room for: every brick carries every layer. Broken by: names in the opposite
// order.
TEST_F(Groups, AreUpToEight) {
  std::vector<pb::Operation> operations;
  for (int i = 0; i < 8; ++i) {
    pb::Light lamp = light("Lamp");
    lamp.set_group("group " + std::to_string(i));
    *lamp.mutable_radiance() = vec3(1 + i, 1, 1);
    operations.push_back(client::createLight(lamp));
  }
  const std::string session = sessionOf(operations, 20);  // bricks cut at the borders
  const client::VolumeResult v = volume(session);
  ASSERT_EQ(v.volume.layers.size(), 8U);
  const std::vector<float>& first = v.volume.layers[0].coefficients;
  for (std::size_t layer = 1; layer < 8; ++layer) {
    EXPECT_EQ(v.volume.layers[layer].group, "group " + std::to_string(layer));
    const std::vector<float>& values = v.volume.layers[layer].coefficients;
    for (std::size_t i = 0; i < values.size(); i += 12) {  // L00 of red
      ASSERT_NEAR(values[i], float(layer + 1) * first[i], 1e-5F * values[i]) << layer;
    }
  }
  EXPECT_EQ(volume(session, pb::VOLUME_FORMAT_HALF_FLOAT).volume.layers.size(), 8U);
}

}  // namespace
}  // namespace lpv::rpc
