// What cannot be read is refused by name, never guessed at.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "store/envelope.h"
#include "unit/store/store_rig.h"

namespace lpv::store {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(EnvelopeTest, GivesBackWhatWasSealed) {
  pb::Record read;
  ASSERT_TRUE(unseal("it", *seal("it", lampRecord(3)), &read).ok());
  EXPECT_EQ(read.SerializeAsString(), lampRecord(3).SerializeAsString());
}

// Seen to fail at every byte of the payload when the checksum is not compared.
TEST(EnvelopeTest, EveryFlippedBitIsFound) {
  const std::string sealed = *seal("the record", lampRecord(3));
  for (std::size_t byte = 0; byte < sealed.size(); ++byte) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string flipped = sealed;
      flipped[byte] = char(flipped[byte] ^ (1 << bit));
      pb::Record read;
      EXPECT_FALSE(unseal("it", flipped, &read).ok()) << "byte " << byte << ", bit " << bit;
    }
  }
}

TEST(EnvelopeTest, EveryCutIsFound) {
  const std::string sealed = *seal("the record", lampRecord(3));
  for (std::size_t size = 0; size < sealed.size(); ++size) {
    pb::Record read;
    EXPECT_EQ(unseal("it", sealed.substr(0, size), &read).code(), Code::kDataLoss) << size << " bytes";
  }
}

TEST(EnvelopeTest, ANewerSchemaIsRefusedByNumber) {
  pb::Envelope envelope;
  ASSERT_TRUE(envelope.ParseFromString(*seal("the record", lampRecord(3))));
  envelope.set_schema_version(kSchemaVersion + 1);
  pb::Record read;
  const Status status = unseal("the snapshot", envelope.SerializeAsString(), &read);
  EXPECT_EQ(status.code(), Code::kFailedPrecondition);
  EXPECT_THAT(status.message(),
              AllOf(HasSubstr("the snapshot"), HasSubstr("schema version 2"), HasSubstr("newer lpvd")));
}

class DamageTest : public testing::Test {
 protected:
  DamageTest() {
    const std::unique_ptr<SqliteStore> store = openStore(folder_);
    createSession(*store, "hall");
    createSession(*store, "attic");
    for (std::uint64_t i = 1; i <= 20; ++i) store->append("hall", lampStep(i));
  }
  Status opening() {
    SqliteOptions options;
    options.directory = folder_.path();
    return SqliteBackend::open(options).status();
  }
  Status loading(const std::string& id) { return openStore(folder_)->load(id, true).status(); }

  Folder folder_;
};

TEST_F(DamageTest, ADatabaseOfANewerVersionIsRefusedByNumber) {
  tamper(folder_, "PRAGMA user_version = 7");
  const Status status = opening();
  EXPECT_EQ(status.code(), Code::kFailedPrecondition);
  EXPECT_THAT(status.message(),
              AllOf(HasSubstr(folder_.database()), HasSubstr("schema version 7"), HasSubstr("1 to 1")));
}

TEST_F(DamageTest, ADatabaseOfAnotherProgramIsLeftAlone) {
  tamper(folder_, "PRAGMA application_id = 1");
  const Status status = opening();
  EXPECT_EQ(status.code(), Code::kFailedPrecondition);
  EXPECT_THAT(status.message(), HasSubstr("another program"));
}

TEST_F(DamageTest, AFileThatIsNoDatabaseIsDataLoss) {
  std::ofstream(folder_.database(), std::ios::trunc) << std::string(8192, 'x');
  const Status status = opening();
  EXPECT_EQ(status.code(), Code::kDataLoss);
  EXPECT_THAT(status.message(), HasSubstr(folder_.database()));
}

// Torn in the middle of its pages, as by a disk that lied about a sync.
TEST_F(DamageTest, ATornDatabaseIsAnErrorNotASession) {
  std::filesystem::resize_file(folder_.database(), std::filesystem::file_size(folder_.database()) / 2);
  const Status status = opening();
  const Status later = status.ok() ? loading("hall") : status;
  EXPECT_EQ(later.code(), Code::kDataLoss) << later.message();
  EXPECT_THAT(later.message(), HasSubstr(folder_.database()));
}

TEST_F(DamageTest, ADamagedSessionIsRefusedTheOthersAreNot) {
  tamper(folder_, "UPDATE log SET sealed = substr(sealed, 1, length(sealed) - 1) || x'00' WHERE number = 10");
  const Status status = loading("hall");
  EXPECT_EQ(status.code(), Code::kDataLoss);
  EXPECT_THAT(status.message(), AllOf(HasSubstr("the log of session \"hall\""), HasSubstr("checksum")));
  EXPECT_TRUE(loading("attic").ok());
}

TEST_F(DamageTest, AMissingStepIsFound) {
  tamper(folder_, "DELETE FROM log WHERE number = 10");
  EXPECT_THAT(loading("hall").message(), HasSubstr("from revision 9 to 11"));
}

TEST_F(DamageTest, MissingContentIsFound) {
  tamper(folder_, "DELETE FROM contents");
  const Status status = loading("hall");
  EXPECT_EQ(status.code(), Code::kDataLoss);
  EXPECT_THAT(status.message(), HasSubstr("mesh-a"));
}

// A write-ahead log cut anywhere ends the session at the last whole transaction: never between, never in error.
TEST_F(DamageTest, ATornWriteAheadLogLosesWholeTransactionsOnly) {
  Folder copy;
  {
    const std::unique_ptr<SqliteStore> store = openStore(folder_);
    for (std::uint64_t i = 21; i <= 40; ++i) ASSERT_TRUE(keptAt(*store, store->append("hall", lampStep(i))).ok());
    for (const char* file : {"/sessions.db", "/sessions.db-wal"}) {
      std::filesystem::copy_file(folder_.path() + file, copy.path() + file);
    }
  }
  const auto whole = std::filesystem::file_size(copy.database() + "-wal");
  std::uint64_t lowest = 40;
  for (int part = 0; part <= 8; ++part) {
    Folder torn;
    std::filesystem::copy_file(copy.database(), torn.database());
    std::filesystem::copy_file(copy.database() + "-wal", torn.database() + "-wal");
    std::filesystem::resize_file(torn.database() + "-wal", whole * std::uintmax_t(part) / 8);
    const Expected<Loaded> hall = openStore(torn)->load("hall", true);
    ASSERT_TRUE(hall.ok()) << hall.status().message();
    const std::uint64_t revision = hall->snapshot.revision();
    EXPECT_GE(revision, 20U);
    EXPECT_DOUBLE_EQ(hall->snapshot.lights().at("Lamp").radiance().x(), double(revision));
    EXPECT_EQ(std::uint64_t(hall->snapshot.clients().at("me").outcomes_size()), revision);
    lowest = std::min(lowest, revision);
    if (part == 8) {
      EXPECT_EQ(revision, 40U);
    }
  }
  EXPECT_LT(lowest, 40U) << "a cut that cost nothing tests nothing";
}

}  // namespace
}  // namespace lpv::store
