// A disk that takes no more, and one that does again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>

#include "unit/store/store_rig.h"

namespace lpv::store {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class FailureTest : public testing::Test {
 protected:
  FailureTest() {
    CommitQueueOptions options;
    options.retry = std::chrono::milliseconds(5);
    options.onChange = [this](const Status& status) { ++(status.ok() ? recovered_ : failed_); };
    store_ = openStore(folder_, {}, options);
    EXPECT_TRUE(keptAt(*store_, createSession(*store_, "hall")).ok());
    EXPECT_TRUE(keptAt(*store_, store_->append("hall", lampStep(1))).ok());
  }

  Folder folder_;
  std::atomic<int> failed_{0};
  std::atomic<int> recovered_{0};
  std::unique_ptr<SqliteStore> store_;
};

// Seen to fail when settle() clears the group of a failed transaction (the session's log then has a gap), and when it
// tells nobody.
TEST_F(FailureTest, IsToldAsUnknownAndCaughtUpWithLater) {
  Position second = 0;
  Position third = 0;
  {
    const FileLimit full(folder_.logBytes());
    second = store_->append("hall", lampStep(2));
    const Status status = keptAt(*store_, second);
    EXPECT_EQ(status.code(), Code::kUnavailable);
    EXPECT_THAT(status.message(), AllOf(HasSubstr(folder_.path()), HasSubstr("free space"), HasSubstr("repeat")));
    EXPECT_EQ(store_->available().code(), Code::kUnavailable);
    // Was on its way when the disk failed; a session makes no others now.
    third = store_->append("hall", lampStep(3));
    EXPECT_EQ(keptAt(*store_, third).code(), Code::kUnavailable) << "at once, not when the disk is back";
    EXPECT_EQ(store_->load("hall", true).status().code(), Code::kUnavailable) << "it would be behind what readers saw";
  }
  while (!store_->available().ok()) std::this_thread::yield();
  EXPECT_TRUE(keptAt(*store_, third).ok());
  EXPECT_EQ(failed_, 1);
  EXPECT_EQ(recovered_, 1);
  EXPECT_TRUE(keptAt(*store_, store_->append("hall", lampStep(4))).ok());
  store_.reset();
  const Expected<Loaded> hall = openStore(folder_)->load("hall", true);
  ASSERT_TRUE(hall.ok()) << hall.status().message();
  EXPECT_EQ(hall->snapshot.revision(), 4U);
  EXPECT_EQ(hall->snapshot.clients().at("me").outcomes_size(), 4) << "each step once";
}

TEST_F(FailureTest, WhatWasKeptBeforeIsThereWhenTheProcessEndsWithoutCatchingUp) {
  {
    const FileLimit full(folder_.logBytes());
    EXPECT_FALSE(keptAt(*store_, store_->append("hall", lampStep(2))).ok());
    store_.reset();
  }
  const Expected<Loaded> hall = openStore(folder_)->load("hall", true);
  ASSERT_TRUE(hall.ok()) << hall.status().message();
  EXPECT_EQ(hall->snapshot.revision(), 1U);
}

TEST_F(FailureTest, AFolderThatCannotBeWrittenIsRefusedByName) {
  SqliteOptions options;
  options.directory = "/proc/lpv-no-such";
  const Status status = SqliteBackend::open(options).status();
  EXPECT_EQ(status.code(), Code::kUnavailable);
  EXPECT_THAT(status.message(), HasSubstr("--state-dir /proc/lpv-no-such"));
}

TEST_F(FailureTest, ALogThatCannotBeFoldedStaysAsItIs) {
  store_.reset();
  SqliteOptions options;
  options.compactAfterRecords = 2;
  store_ = openStore(folder_, options);
  tamper(folder_, "UPDATE snapshots SET sealed = x'00'");
  EXPECT_TRUE(keptAt(*store_, store_->append("hall", lampStep(2))).ok()) << "what comes is kept all the same";
  EXPECT_TRUE(keptAt(*store_, store_->append("hall", lampStep(3))).ok());
  store_.reset();
  EXPECT_EQ(ask(folder_, "SELECT count(*) FROM log"), 3);
}

}  // namespace
}  // namespace lpv::store
