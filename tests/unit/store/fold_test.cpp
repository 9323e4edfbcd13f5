// A snapshot and a step make the next snapshot.
#include "store/fold.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/store/store_rig.h"

namespace lpv::store {
namespace {

class FoldTest : public testing::Test {
 protected:
  FoldTest() { (*snapshot_.mutable_clients())["me"].set_secret_hash("h"); }
  void take(const pb::Record& record) {
    const Status status = fold(record, &snapshot_);
    ASSERT_TRUE(status.ok()) << status.message();
  }
  pb::Record next() const {
    pb::Record record;
    record.set_revision(snapshot_.revision() + 1);
    return record;
  }
  void removeLamp() {
    pb::Record record = next();
    pb::Tombstone* deleted = record.add_deleted();
    deleted->set_kind(pb::Tombstone::KIND_LIGHT);
    deleted->set_name("Lamp");
    deleted->set_revision(record.revision());
    take(record);
  }
  pb::Snapshot snapshot_;
};

TEST_F(FoldTest, ObjectsAreReplacedWholeAndDeletedWithAMark) {
  take(lampRecord(1));
  take(lampRecord(2, "mesh-b"));
  ASSERT_EQ(snapshot_.lights().size(), 1U);
  EXPECT_EQ(snapshot_.lights().at("Lamp").mesh(), "mesh-b");
  EXPECT_EQ(snapshot_.lights().at("Lamp").status().revision(), 2U);
  removeLamp();
  EXPECT_TRUE(snapshot_.lights().empty());
  ASSERT_EQ(snapshot_.tombstones_size(), 1);
  EXPECT_EQ(snapshot_.tombstones(0).revision(), 3U);
}

TEST_F(FoldTest, ANameDeletedAndGivenAgainInOneEditIsThere) {
  take(lampRecord(1));
  pb::Record record = lampRecord(2, "mesh-b");
  pb::Tombstone* deleted = record.add_deleted();
  deleted->set_kind(pb::Tombstone::KIND_LIGHT);
  deleted->set_name("Lamp");
  take(record);
  EXPECT_EQ(snapshot_.lights().at("Lamp").mesh(), "mesh-b");
}

TEST_F(FoldTest, SettingsGridAndCamerasCarryTheRevisionThatChangedThem) {
  take(lampRecord(1));
  pb::Record record = next();
  record.mutable_settings()->set_display_name("Hall");
  record.mutable_grid()->set_cell_size(0.5);
  record.add_cameras()->set_name("Front");
  take(record);
  EXPECT_EQ(snapshot_.settings().display_name(), "Hall");
  EXPECT_EQ(snapshot_.settings_revision(), 0U) << "a name alters no result";
  EXPECT_EQ(snapshot_.grid_revision(), 2U);
  EXPECT_EQ(snapshot_.cameras().at("Front").revision(), 2U);
  record = next();
  record.mutable_settings()->set_iterations(7);
  record.set_settings_are_revision(true);
  take(record);
  EXPECT_EQ(snapshot_.settings_revision(), 3U);
}

TEST_F(FoldTest, MembersComeAndGo) {
  pb::Record record;
  record.set_joined_id("you");
  record.set_joined_secret_hash("yours");
  take(record);
  EXPECT_EQ(snapshot_.clients().at("you").secret_hash(), "yours");
  record.Clear();
  record.set_left_id("you");
  take(record);
  EXPECT_FALSE(snapshot_.clients().contains("you"));
}

TEST_F(FoldTest, TheLast1024OutcomesAreKeptTheRestCounts) {
  for (std::uint64_t i = 1; i <= kKeptOutcomes + 3; ++i) take(lampRecord(i));
  pb::Record refused;
  refused.set_revision(snapshot_.revision());
  refused.set_client_id("me");
  refused.mutable_outcome()->set_sequence(5000);
  refused.mutable_outcome()->mutable_status()->set_code(5);
  take(refused);
  const pb::Client& me = snapshot_.clients().at("me");
  ASSERT_EQ(me.outcomes_size(), int(kKeptOutcomes));
  EXPECT_EQ(me.outcomes(0).sequence(), 5U);
  EXPECT_EQ(me.outcome_horizon(), 4U);
  EXPECT_EQ(me.accepted_sequence(), kKeptOutcomes + 3) << "a refused edit is no accepted one";
}

TEST_F(FoldTest, TheLast10000DeletionsAreKeptTheRestCounts) {
  for (std::size_t i = 0; i < kKeptTombstones + 2; ++i) removeLamp();
  EXPECT_EQ(snapshot_.tombstones_size(), int(kKeptTombstones));
  EXPECT_EQ(snapshot_.tombstones(0).revision(), 3U);
  EXPECT_EQ(snapshot_.tombstone_horizon(), 2U);
}

TEST_F(FoldTest, AMissingStepIsDataLoss) {
  take(lampRecord(1));
  const Status status = fold(lampRecord(3), &snapshot_);
  EXPECT_EQ(status.code(), Code::kDataLoss);
  EXPECT_THAT(status.message(), testing::HasSubstr("from revision 1 to 3"));
}

TEST_F(FoldTest, ContentsAreWhatIsReferredToOrWasUploaded) {
  take(lampRecord(1));
  pb::Record record = next();
  record.add_surfaces()->set_name("Wall");
  record.mutable_surfaces(0)->set_mesh("mesh-w");
  record.mutable_surfaces(0)->set_albedo_texture("texture-w");
  record.mutable_surfaces(0)->set_normal_texture("normals-w");
  record.mutable_surfaces(0)->set_gloss_texture("gloss-w");
  (*record.mutable_uploads())["upload"] = lpv::v1::BLOB_KIND_TEXTURE;
  take(record);
  EXPECT_THAT(contentsOf(snapshot_),
              testing::UnorderedElementsAre(testing::Pair("mesh-a", lpv::v1::BLOB_KIND_MESH),
                                            testing::Pair("mesh-w", lpv::v1::BLOB_KIND_MESH),
                                            testing::Pair("texture-w", lpv::v1::BLOB_KIND_TEXTURE),
                                            testing::Pair("normals-w", lpv::v1::BLOB_KIND_TEXTURE),
                                            testing::Pair("gloss-w", lpv::v1::BLOB_KIND_TEXTURE),
                                            testing::Pair("upload", lpv::v1::BLOB_KIND_TEXTURE)));
  record = next();
  record.add_dropped("upload");
  take(record);
  EXPECT_FALSE(contentsOf(snapshot_).contains("upload"));
}

TEST_F(FoldTest, OutcomesWithManyNamesAreForgottenSooner) {
  for (std::uint64_t sequence = 1; sequence <= 100; ++sequence) {
    pb::Record record = next();
    record.set_client_id("me");
    record.mutable_outcome()->set_sequence(sequence);
    for (int i = 0; i < 1000; ++i) record.mutable_outcome()->add_names(std::string(200, 'n'));
    take(record);
  }
  const pb::Client& me = snapshot_.clients().at("me");
  const int kept = int(kKeptNameBytes / (1000 * (200 + kBytesPerName)));
  EXPECT_EQ(me.outcomes_size(), kept);
  EXPECT_EQ(me.outcome_horizon(), std::uint64_t(100 - kept));
}

}  // namespace
}  // namespace lpv::store
