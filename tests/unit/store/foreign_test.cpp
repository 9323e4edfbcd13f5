// Sessions whose files no server of ours wrote: used whole, or refused by name.

#include <gmock/gmock.h>
#include <google/protobuf/unknown_field_set.h>
#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "convert/blob_content.h"
#include "convert/session.h"
#include "persistence/snapshot.h"
#include "reference/meshes.h"

namespace lpv::api {
namespace {

using testing::HasSubstr;

class ForeignSession : public testing::Test {
 protected:
  ForeignSession() {
    toProto(LightingSettings(), snapshot().mutable_settings());
    snapshot().mutable_grid()->set_cell_size(1.0);
    for (const auto set : {&pb::Dims::set_x, &pb::Dims::set_y, &pb::Dims::set_z}) {
      (snapshot().mutable_grid()->mutable_dims()->*set)(4);
    }
    mesh_ = add(pb::BLOB_KIND_MESH, meshBytes(*reference::quad()));
    pb::Texture texture;
    texture.set_width(1);
    texture.set_height(1);
    texture.set_format(pb::TEXTURE_FORMAT_RGB8_SRGB);
    texture.set_texels("rgb");
    texture_ = add(pb::BLOB_KIND_TEXTURE, texture.SerializeAsString());
    light("Lamp", "Lamp");
  }

  kept::Snapshot& snapshot() { return loaded_.snapshot; }
  std::string add(pb::BlobKind kind, const std::string& bytes) {
    loaded_.contents.push_back({sha256(bytes), kind, std::make_shared<const std::string>(bytes)});
    return sha256(bytes);
  }
  pb::Light& light(const std::string& place, const std::string& name) {
    pb::Light& out = (*snapshot().mutable_lights())[place];
    out.set_name(name);
    out.set_mesh(mesh_);
    return out;
  }
  void expectLost(const std::string& words) {
    const Status status = fromStore(loaded_).status();
    EXPECT_EQ(status.code(), Code::kDataLoss);
    EXPECT_THAT(status.message(), HasSubstr(words));
  }

  store::Loaded loaded_;
  std::string mesh_;
  std::string texture_;
};

/// As older versions wrote surfaces: field 9 was one_sided, left out where false; two_sided was not there.
std::string writtenBefore(kept::Snapshot snapshot, const std::string& mesh) {
  for (const bool oneSided : {false, true}) {
    const std::string name = oneSided ? "Front" : "Both";
    pb::Surface& wall = (*snapshot.mutable_surfaces())[name];
    wall.set_name(name);
    wall.set_mesh(mesh);
    if (oneSided) wall.GetReflection()->MutableUnknownFields(&wall)->AddVarint(9, 1);
  }
  return snapshot.SerializeAsString();
}

TEST_F(ForeignSession, SurfacesOfOlderFilesKeepTheirSides) {
  ASSERT_TRUE(snapshot().ParseFromString(writtenBefore(snapshot(), mesh_)));
  const Expected<SavedSession> state = fromStore(loaded_);
  ASSERT_TRUE(state.ok()) << state.status().message();
  kept::Snapshot now = toSnapshot(*state);
  EXPECT_TRUE(now.surfaces().at("Both").two_sided());
  const pb::Surface& front = now.surfaces().at("Front");
  EXPECT_TRUE(front.has_two_sided());
  EXPECT_FALSE(front.two_sided());
  EXPECT_EQ(front.GetReflection()->GetUnknownFields(front).field_count(), 0);
  const Expected<SavedSession> again = fromStore({{}, now, contentsOf(*state)});
  ASSERT_TRUE(again.ok()) << again.status().message();
  for (const auto& surface : again->document.surfaces) {
    EXPECT_EQ(surface.object->twoSided, surface.object->name == "Both");
  }
}

// Red when textures are kept where the file says that they were uploaded only: the next restart finds none.
TEST_F(ForeignSession, ATextureThatNobodyUploadedIsKeptAllTheSame) {
  light("Lamp", "Lamp").set_texture(texture_);
  const Expected<SavedSession> state = fromStore(loaded_);
  ASSERT_TRUE(state.ok()) << state.status().message();
  const Expected<SavedSession> again = fromStore({{}, toSnapshot(*state), contentsOf(*state)});
  ASSERT_TRUE(again.ok()) << again.status().message();
  EXPECT_EQ(again->document.lights[0].object->texture->hash, texture_);
}

// Red, under the undefined behaviour sanitizer, when the counts are added as they are.
TEST_F(ForeignSession, CountsOfAnySizeMakeASummary) {
  for (const char* name : {"Lamp", "Other"}) {
    light(name, name).mutable_status()->set_triangle_count(std::numeric_limits<std::int64_t>::max());
  }
  const Expected<SessionSummary> summary = summaryOf(loaded_);
  ASSERT_TRUE(summary.ok()) << summary.status().message();
  EXPECT_EQ(summary->triangles, 2 * std::int64_t(std::numeric_limits<std::uint32_t>::max()));
}

// Red, each, without its check.
TEST_F(ForeignSession, AnObjectUnderAnotherNameIsRefused) {
  light("Other", "Lamp");
  expectLost("light \"Other\": it is named \"Lamp\" within");
}

TEST_F(ForeignSession, TwoObjectsOfOneNameAreRefused) {
  pb::Surface& wall = (*snapshot().mutable_surfaces())["Lamp"];
  wall.set_name("Lamp");
  wall.set_mesh(mesh_);
  expectLost("surface \"Lamp\": a light has this name too");
}

TEST_F(ForeignSession, ACameraWithoutANameIsRefused) {
  pb::Camera camera;
  camera.mutable_eye()->set_z(3.0);
  camera.mutable_target()->set_z(0.0);
  *(*snapshot().mutable_cameras())["a/b"].mutable_camera() = camera;
  expectLost("camera \"a/b\"");
}

// Red, each, without its check.
TEST_F(ForeignSession, ARevisionThatCannotBeCountedOnIsRefused) {
  snapshot().set_revision(std::numeric_limits<std::int64_t>::max());
  EXPECT_TRUE(fromStore(loaded_).ok());
  snapshot().set_revision(snapshot().revision() + 1);
  expectLost("its revision is 9223372036854775808, allowed are up to 9223372036854775807");
}

TEST_F(ForeignSession, WhatIsFromAfterTheSessionsRevisionIsRefused) {
  snapshot().set_revision(7);
  pb::LightStatus& lamp = *light("Lamp", "Lamp").mutable_status();
  lamp.set_revision(7);
  EXPECT_TRUE(fromStore(loaded_).ok());
  lamp.set_revision(8);
  expectLost("light \"Lamp\": is of revision 8, the session of 7");
  lamp.set_revision(1);
  snapshot().set_grid_revision(8);
  expectLost("part \"grid\": is of revision 8, the session of 7");
  snapshot().set_grid_revision(0);
  snapshot().add_tombstones()->set_name("Gone");
  snapshot().mutable_tombstones(0)->set_revision(9);
  expectLost("deletion of \"Gone\": is of revision 9, the session of 7");
}

}  // namespace
}  // namespace lpv::api
