// The blobs of a session: one of each content, limits by name, and when unused ones go.
#include "session/document/blobs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reference/meshes.h"

namespace lpv {
namespace {

using std::chrono::minutes;
using testing::HasSubstr;

BlobPtr meshBlob(const std::string& hash, int triangles) {
  auto blob = std::make_shared<Blob>();
  Mesh mesh = *reference::quad();
  mesh.triangles.resize(std::size_t(triangles), {0, 1, 2});
  blob->hash = hash;
  blob->bytes = std::make_shared<const std::string>(std::size_t(triangles), 'm');
  blob->mesh = std::make_shared<const Mesh>(std::move(mesh));
  return blob;
}

BlobPtr textureBlob(const std::string& hash, int width, int height) {
  auto blob = std::make_shared<Blob>();
  Texture texture;
  texture.width = width;
  texture.height = height;
  blob->kind = BlobKind::kTexture;
  blob->hash = hash;
  blob->bytes = std::make_shared<const std::string>(10, 't');
  blob->texture = std::make_shared<const Texture>(texture);
  return blob;
}

class BlobsTest : public testing::Test {
 protected:
  bool added(const BlobPtr& blob, Clock::time_point now) {
    const Expected<bool> existed = blobs_.add(blob, now);
    EXPECT_TRUE(existed.ok()) << existed.status().message();
    return existed.ok() && !*existed;
  }

  static Limits small() {
    Limits limits;
    limits.maxTriangles = 10;
    limits.maxTexels = 20;
    return limits;
  }
  const Clock::time_point start_ = Clock::now();
  Blobs blobs_{small()};
};

TEST_F(BlobsTest, OfOneContentAreKeptOnce) {
  EXPECT_TRUE(added(meshBlob("a", 4), start_));
  EXPECT_FALSE(added(meshBlob("a", 4), start_)) << "existed";
  EXPECT_FALSE(added(meshBlob("a", 4), start_)) << "and costs nothing again: three times four is above the limit";
  EXPECT_TRUE(added(textureBlob("t", 2, 3), start_));
  EXPECT_EQ(blobs_.count(), 2U);
  EXPECT_EQ(blobs_.bytes(), 14);
  ASSERT_NE(blobs_.find("a"), nullptr);
  EXPECT_EQ(blobs_.find("a")->mesh->triangles.size(), 4U);
  EXPECT_EQ(blobs_.find("b"), nullptr);
}

TEST_F(BlobsTest, AreLimitedTogetherByName) {
  EXPECT_TRUE(added(meshBlob("a", 6), start_));
  const Status triangles = blobs_.add(meshBlob("b", 5), start_).status();
  EXPECT_EQ(triangles.code(), Code::kResourceExhausted);
  EXPECT_EQ(triangles.field(), "max_triangles");
  EXPECT_THAT(triangles.message(), HasSubstr("holds 6"));
  EXPECT_TRUE(added(meshBlob("c", 4), start_)) << "just the limit";
  EXPECT_TRUE(added(textureBlob("t", 4, 4), start_));
  const Status texels = blobs_.add(textureBlob("u", 5, 1), start_).status();
  EXPECT_EQ(texels.code(), Code::kResourceExhausted);
  EXPECT_EQ(texels.field(), "max_texels");
  EXPECT_TRUE(added(textureBlob("v", 2, 2), start_));
  EXPECT_EQ(blobs_.find("b"), nullptr);
  EXPECT_EQ(blobs_.count(), 4U);
}

TEST_F(BlobsTest, ThatNobodyUsesGoAfterTheirTimeAndMakeRoom) {
  added(meshBlob("used", 6), start_);
  added(meshBlob("unused", 4), start_);
  blobs_.dropUnused({"used"}, start_ + minutes(9));
  EXPECT_EQ(blobs_.count(), 2U) << "an edit that names it may be on its way";
  blobs_.dropUnused({"used"}, start_ + minutes(10));
  EXPECT_EQ(blobs_.find("unused"), nullptr);
  ASSERT_NE(blobs_.find("used"), nullptr);
  EXPECT_EQ(blobs_.bytes(), 6);
  EXPECT_TRUE(added(meshBlob("next", 4), start_ + minutes(10)));
  blobs_.dropUnused({}, start_ + minutes(19));
  EXPECT_NE(blobs_.find("used"), nullptr) << "its time runs from when it was last used";
  blobs_.dropUnused({}, start_ + minutes(20));
  EXPECT_EQ(blobs_.count(), 0U);
  EXPECT_EQ(blobs_.bytes(), 0);
  EXPECT_TRUE(added(meshBlob("all", 10), start_ + minutes(20)));
}

TEST_F(BlobsTest, StayForWhoeverAddedOrAskedForThemLast) {
  added(meshBlob("again", 2), start_);
  added(meshBlob("asked", 2), start_);
  added(meshBlob("left", 2), start_);
  added(meshBlob("again", 2), start_ + minutes(8));
  blobs_.touch("asked", start_ + minutes(8));
  blobs_.touch("unknown", start_ + minutes(8));
  blobs_.dropUnused({}, start_ + minutes(12));
  EXPECT_NE(blobs_.find("again"), nullptr);
  EXPECT_NE(blobs_.find("asked"), nullptr);
  EXPECT_EQ(blobs_.find("left"), nullptr);
  EXPECT_EQ(blobs_.count(), 2U);
}

}  // namespace
}  // namespace lpv
