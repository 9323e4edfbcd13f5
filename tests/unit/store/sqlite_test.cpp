// What is kept, in how many transactions, and what is let go of.
#include "store/sqlite/sqlite_backend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>

#include "unit/store/store_rig.h"

namespace lpv::store {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class SqliteStoreTest : public testing::Test {
 protected:
  /// As a new process finds it.
  void reopen(SqliteOptions options = {}) {
    store_.reset();
    store_ = openStore(folder_, std::move(options));
    ASSERT_NE(store_, nullptr);
  }
  void keep(Position position) {
    const Status status = keptAt(*store_, position);
    ASSERT_TRUE(status.ok()) << status.message();
  }
  pb::Snapshot snapshotOf(const std::string& id) {
    const Expected<Loaded> loaded = store_->load(id, true);
    EXPECT_TRUE(loaded.ok()) << loaded.status().message();
    return loaded ? loaded->snapshot : pb::Snapshot();
  }
  std::int64_t contents() { return ask(folder_, "SELECT count(*) FROM contents"); }

  Folder folder_;
  std::unique_ptr<SqliteStore> store_ = openStore(folder_);
};

// Broken by: leaving the permissions to the umask; looking at the database only.
TEST_F(SqliteStoreTest, ItsFilesAreTheOwnersWhateverTheFolderIs) {
  namespace fs = std::filesystem;
  const auto othersMay = [&] {
    int count = 0;
    for (const auto& file : fs::directory_iterator(folder_.path())) {
      const fs::perms mode = file.status().permissions();
      count += int((mode & (fs::perms::group_all | fs::perms::others_all)) != fs::perms::none);
    }
    return count;
  };
  EXPECT_EQ(othersMay(), 0);
  fs::permissions(folder_.path(), fs::perms::all);
  keep(createSession(*store_, "hall"));
  for (const auto& file : fs::directory_iterator(folder_.path())) fs::permissions(file.path(), fs::perms(0644));
  reopen();
  keep(store_->append("hall", lampStep(1)));
  EXPECT_EQ(othersMay(), 1) << "the lock file, which says nothing but a process id";
}

TEST_F(SqliteStoreTest, NamesItsDurability) { EXPECT_EQ(store_->durability(), lpv::v1::DURABILITY_DISK); }

TEST_F(SqliteStoreTest, WhatWasKeptIsThereAfterwards) {
  createSession(*store_, "hall", 17);
  store_->append("hall", lampStep(1));
  keep(store_->append("hall", lampStep(2)));
  reopen();
  const Expected<Loaded> hall = store_->load("hall", true);
  ASSERT_TRUE(hall.ok()) << hall.status().message();
  EXPECT_EQ(hall->head.epoch, 17U);
  EXPECT_EQ(hall->head.requestId, "request of hall");
  EXPECT_EQ(hall->head.ttl, std::chrono::seconds(3600));
  EXPECT_EQ(hall->snapshot.revision(), 2U);
  EXPECT_DOUBLE_EQ(hall->snapshot.lights().at("Lamp").radiance().x(), 2.0);
  EXPECT_EQ(hall->snapshot.clients().at("me").outcomes_size(), 2);
  ASSERT_EQ(hall->contents.size(), 1U);
  EXPECT_EQ(*hall->contents[0].bytes, "bytes of a");
  EXPECT_EQ(store_->load("attic", true).status().code(), Code::kNotFound);
}

TEST_F(SqliteStoreTest, TheDestructorKeepsWhatWasGiven) {
  createSession(*store_, "hall");
  for (std::uint64_t i = 1; i <= 50; ++i) store_->append("hall", lampStep(i));
  reopen();
  EXPECT_EQ(snapshotOf("hall").revision(), 50U);
}

// Seen to fail (100 transactions) when run() takes one change at a time.
TEST_F(SqliteStoreTest, WhatWasQueuedWhileACommitRanGoesIntoOneTransaction) {
  keep(createSession(*store_, "hall"));
  const std::int64_t before = store_->commits();
  std::promise<void> reached;
  std::promise<void> release;
  store_->append("hall", [&, made = lampStep(1)](const HasContent& holds) {
    reached.set_value();
    release.get_future().wait();
    return made(holds);
  });
  reached.get_future().wait();  // the store's thread is inside a transaction
  std::atomic<int> told{0};
  for (std::uint64_t i = 2; i <= 100; ++i) {
    store_->whenDurable("hall", store_->append("hall", lampStep(i)),
                        [&told](const Status& status) { told += status.ok() ? 1 : 1000; });
  }
  EXPECT_EQ(told, 0) << "nobody is told before it is kept";
  release.set_value();
  keep(store_->touch("hall", std::chrono::system_clock::now()));
  EXPECT_EQ(told, 99);
  const std::int64_t transactions = store_->commits() - before;
  RecordProperty("transactions", int(transactions));
  EXPECT_LE(transactions, 3) << "one step, then 99 together, then perhaps the last one";
}

// Seen to fail when settle() takes everybody who waits.
TEST_F(SqliteStoreTest, NobodyIsToldOfALaterTransaction) {
  keep(createSession(*store_, "hall"));
  std::vector<int> order;
  std::mutex mutex;
  const auto note = [&](int which) {
    return [&, which](const Status&) {
      const std::lock_guard lock(mutex);
      order.push_back(which);
    };
  };
  std::promise<void> reached;
  std::promise<void> release;
  const Position first = store_->append("hall", lampStep(1));
  keep(first);
  const Position second = store_->append("hall", [&, made = lampStep(2)](const HasContent& holds) {
    reached.set_value();
    release.get_future().wait();
    return made(holds);
  });
  reached.get_future().wait();
  std::promise<void> reachedThird;
  std::promise<void> releaseThird;
  const Position third = store_->append("hall", [&, made = lampStep(3)](const HasContent& holds) {
    reachedThird.set_value();
    releaseThird.get_future().wait();
    return made(holds);
  });
  store_->whenDurable("hall", third, note(3));
  store_->whenDurable("hall", second, note(2));
  store_->whenDurable("hall", first, note(1));
  {
    const std::lock_guard lock(mutex);
    EXPECT_THAT(order, ElementsAre(1)) << "the only one that is kept";
  }
  release.set_value();
  reachedThird.get_future().wait();  // the second is kept, the third is in the making
  {
    const std::lock_guard lock(mutex);
    EXPECT_THAT(order, ElementsAre(1, 2));
  }
  releaseThird.set_value();
  keep(third);
  EXPECT_THAT(order, ElementsAre(1, 2, 3));
}

TEST_F(SqliteStoreTest, BytesAreKeptOnceAndGoWithTheirLastHolder) {
  createSession(*store_, "hall");
  createSession(*store_, "attic");
  store_->append("hall", lampStep(1));
  keep(store_->append("attic", lampStep(1)));
  EXPECT_EQ(contents(), 1);
  keep(store_->remove("hall"));
  EXPECT_EQ(contents(), 1) << "the attic needs them";
  EXPECT_EQ(snapshotOf("attic").revision(), 1U);
  keep(store_->remove("attic"));
  EXPECT_EQ(contents(), 0);
  EXPECT_EQ(ask(folder_,
                "SELECT (SELECT count(*) FROM log) + (SELECT count(*) FROM holds) +"
                " (SELECT count(*) FROM snapshots) + (SELECT count(*) FROM sessions)"),
            0);
}

// Seen to fail (kept forever) without letGo in compact().
TEST_F(SqliteStoreTest, ALongLogIsFoldedAndWhatNothingNeedsGoes) {
  SqliteOptions options;
  options.compactAfterRecords = 10;
  reopen(options);
  createSession(*store_, "hall");
  std::vector<Position> positions;
  for (std::uint64_t i = 1; i <= 35; ++i) {
    keep(store_->append("hall", lampStep(i, "mesh-" + std::to_string(i), std::string(100, 'x'))));
  }
  store_.reset();
  EXPECT_LT(ask(folder_, "SELECT count(*) FROM log"), 10);
  EXPECT_LE(contents(), 10) << "of 35 meshes, the last and those of the steps since";
  EXPECT_GE(contents(), 1);
  reopen();
  EXPECT_EQ(snapshotOf("hall").revision(), 35U);
  EXPECT_EQ(snapshotOf("hall").lights().at("Lamp").mesh(), "mesh-35");
  EXPECT_EQ(snapshotOf("hall").clients().at("me").outcomes_size(), 35);
}

TEST_F(SqliteStoreTest, ALogOfManyBytesIsFoldedToo) {
  SqliteOptions options;
  options.compactAfterBytes = 10'000;
  reopen(options);
  createSession(*store_, "hall");
  for (std::uint64_t i = 1; i <= 5; ++i) {
    keep(store_->append("hall", lampStep(i, "mesh-" + std::to_string(i), std::string(6'000, 'x'))));
  }
  store_.reset();
  EXPECT_LT(ask(folder_, "SELECT count(*) FROM log"), 2);
  EXPECT_LE(contents(), 2);
}

TEST_F(SqliteStoreTest, UploadsStayUntilTheyAreDropped) {
  SqliteOptions options;
  options.compactAfterRecords = 1;
  reopen(options);
  createSession(*store_, "hall");
  keep(store_->append("hall", [](const HasContent&) {
    LogRecord step;
    (*step.record.mutable_uploads())["upload"] = lpv::v1::BLOB_KIND_TEXTURE;
    step.contents.push_back({"upload", lpv::v1::BLOB_KIND_TEXTURE, std::make_shared<const std::string>("texels")});
    return step;
  }));
  reopen(options);
  EXPECT_EQ(contents(), 1);
  const Expected<Loaded> hall = store_->load("hall", true);
  ASSERT_TRUE(hall.ok() && hall->contents.size() == 1);
  EXPECT_EQ(hall->contents[0].kind, lpv::v1::BLOB_KIND_TEXTURE);
  keep(store_->append("hall", [](const HasContent&) {
    LogRecord step;
    step.record.add_dropped("upload");
    return step;
  }));
  reopen();
  EXPECT_EQ(contents(), 0);
}

TEST_F(SqliteStoreTest, EpochsNeverComeAgainEvenAfterADeletion) {
  createSession(*store_, "hall", 100);
  store_->setEpoch("hall", 250);
  keep(store_->remove("hall"));
  reopen();
  EXPECT_EQ(store_->highestEpoch(), 250U);
}

TEST_F(SqliteStoreTest, HeadsTellWhatIsNeededToForget) {
  createSession(*store_, "hall");
  createSession(*store_, "attic");
  store_->append("hall", [](const HasContent&) {
    LogRecord step;
    step.record.mutable_settings()->mutable_ttl()->set_seconds(60);
    return step;
  });
  keep(store_->touch("hall", std::chrono::system_clock::time_point(std::chrono::seconds(2'000'000))));
  const Expected<std::vector<SessionHead>> heads = store_->heads();
  ASSERT_TRUE(heads.ok() && heads->size() == 2U);
  EXPECT_EQ((*heads)[0].id, "attic");
  EXPECT_EQ((*heads)[0].ttl, std::chrono::seconds(3600));
  EXPECT_EQ((*heads)[1].ttl, std::chrono::seconds(60));
  EXPECT_EQ((*heads)[1].lastUsed.time_since_epoch(), std::chrono::seconds(2'000'000));
}

TEST_F(SqliteStoreTest, AFolderHasOneStore) {
  SqliteOptions options;
  options.directory = folder_.path();
  const Status second = SqliteBackend::open(options).status();
  EXPECT_EQ(second.code(), Code::kFailedPrecondition);
  EXPECT_THAT(second.message(), HasSubstr(folder_.path()));
  EXPECT_THAT(second.message(), HasSubstr("in use by process " + std::to_string(getpid())));
  store_.reset();
  EXPECT_TRUE(SqliteBackend::open(options).ok());
}

}  // namespace
}  // namespace lpv::store
