// The queue before tables that fail, are slow, or belong to another server.
#include "store/commit_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <utility>
#include <vector>

namespace lpv::store {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;

/// What the tables hold and how they behave. Outlives the queue.
struct Disk {
  std::atomic<int> failures{0};  ///< commits that are still to fail
  std::mutex mutex;
  std::vector<std::string> kept;                           ///< committed changes, "session:epoch" or "session-"
  std::vector<std::chrono::steady_clock::time_point> tries;  ///< commits, failed ones too
  std::string stolen;                                      ///< a session that another server owns
  std::atomic<int> maintained{0};
};

/// Records setEpoch as "session:epoch", touch as "session!" and remove as "session-"; the others write nothing.
class FakeBackend final : public Backend {
 public:
  explicit FakeBackend(Disk& disk) : disk_(disk) {}

  lpv::v1::Durability durability() const override { return lpv::v1::DURABILITY_DISK; }
  Status begin() override { return group_.clear(), Status(); }
  Status commit() override {
    const std::lock_guard lock(disk_.mutex);
    disk_.tries.push_back(std::chrono::steady_clock::now());
    if (disk_.failures > 0) {
      --disk_.failures;
      return {Code::kUnavailable, "the fake disk is full; free space"};
    }
    disk_.kept.insert(disk_.kept.end(), group_.begin(), group_.end());
    return {};
  }
  void rollback() override { group_.clear(); }
  Written create(const SessionHead&, const FullSnapshot&) override { return Status(); }
  Written append(const std::string& session, const MakeLogRecord&) override { return write(session, "+"); }
  Written setEpoch(const std::string& session, std::uint64_t epoch) override {
    {
      const std::lock_guard lock(disk_.mutex);
      if (disk_.stolen == session) disk_.stolen.clear();  // taken back
    }
    return write(session, ":" + std::to_string(epoch));
  }
  Written touch(const std::string& session, std::chrono::system_clock::time_point) override {
    return write(session, "!");
  }
  Written remove(const std::string& session) override { return write(session, "-"); }
  Written keepToken(const AccessToken&) override { return Status(); }
  Written dropToken(const std::string&) override { return Status(); }
  void maintain() override { ++disk_.maintained; }
  Expected<std::vector<SessionHead>> heads() override { return std::vector<SessionHead>(); }
  Expected<std::vector<AccessToken>> tokens() override { return std::vector<AccessToken>(); }
  Expected<Loaded> load(const std::string&, bool) override { return Status(Code::kNotFound, "the fake keeps none"); }
  std::uint64_t highestEpoch() const override { return 0; }

 private:
  Written write(const std::string& session, const std::string& what) {
    const std::lock_guard lock(disk_.mutex);
    if (disk_.stolen == session) return Written::fenced({Code::kFailedPrecondition, session + " is owned by another"});
    group_.push_back(session + what);
    return Status();
  }

  Disk& disk_;
  std::vector<std::string> group_;
};

class CommitQueueTest : public testing::Test {
 protected:
  CommitQueueTest() {
    options_.retry = milliseconds(4);
    options_.retryAtMost = milliseconds(16);
    options_.onCommit = [this](std::chrono::duration<double>, bool committed) { ++(committed ? good_ : bad_); };
    options_.onChange = [this](const Status& status) { ++(status.ok() ? recovered_ : failed_); };
  }

  CommitQueue& queue() {
    if (!queue_) queue_ = std::make_unique<CommitQueue>(std::make_unique<FakeBackend>(disk_), options_);
    return *queue_;
  }
  Position append(const std::string& session) {
    return queue().push(session, [session](Backend& tables) { return tables.append(session, {}); });
  }
  Position setEpoch(const std::string& session, std::uint64_t epoch) {
    return queue().takeOver(session, [=](Backend& tables) { return tables.setEpoch(session, epoch); });
  }
  Status become(const std::string& session, Position position) {
    std::promise<Status> promise;
    queue().whenDurable(session, position, [&promise](const Status& status) { promise.set_value(status); });
    return promise.get_future().get();
  }
  /// Waits until the queue has caught up.
  void caughtUp() {
    while (!queue().available().ok() || queue().queued() > 0) std::this_thread::sleep_for(milliseconds(1));
  }
  std::vector<std::string> kept() {
    const std::lock_guard lock(disk_.mutex);
    return disk_.kept;
  }

  Disk disk_;
  CommitQueueOptions options_;
  std::atomic<int> good_{0}, bad_{0}, failed_{0}, recovered_{0};
  std::unique_ptr<CommitQueue> queue_;
};

/// Holds the queue's thread within a group until it is released.
class Held {
 public:
  explicit Held(CommitQueue& queue) {
    queue.push("", [this](Backend&) {
      reached_.set_value();
      release_.get_future().wait();
      return Written(Status());
    });
    reached_.get_future().wait();
  }
  void release() { release_.set_value(); }

 private:
  std::promise<void> reached_, release_;
};

// Broken by clearing the group in settle() after a failure: the change is lost.
TEST_F(CommitQueueTest, WhatFailedIsTriedAgainUntilItIsKeptInOrder) {
  disk_.failures = 3;
  const Position first = append("hall");
  const Status unknown = become("hall", first);
  EXPECT_EQ(unknown.code(), Code::kUnavailable);
  EXPECT_THAT(unknown.message(), HasSubstr("free space"));
  append("attic");
  caughtUp();
  EXPECT_THAT(kept(), ElementsAre("hall+", "attic+"));
  EXPECT_TRUE(become("hall", first).ok()) << "the true outcome, asked for again";
  EXPECT_EQ(bad_, 3);
  EXPECT_GE(good_, 1);
  EXPECT_EQ(failed_, 1) << "said once";
  EXPECT_EQ(recovered_, 1);
  EXPECT_EQ(disk_.maintained, good_) << "no maintenance after a failure";
}

// Broken by leaving the pause at `retry`.
TEST_F(CommitQueueTest, PausesBetweenAttemptsDoubleUpToTheLongest) {
  disk_.failures = 5;
  append("hall");
  caughtUp();
  const std::lock_guard lock(disk_.mutex);
  ASSERT_EQ(disk_.tries.size(), 6U);
  const int least[] = {4, 8, 16, 16, 16};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_GE(disk_.tries[i + 1] - disk_.tries[i], milliseconds(least[i])) << i;
}

// Broken by telling waiters in the order in which they asked.
TEST_F(CommitQueueTest, AcknowledgesInTheOrderOfChangesAndOneGroupAtATime) {
  Held held(queue());
  const Position first = append("hall");
  const Position second = append("attic");
  std::vector<int> order;
  queue().whenDurable("attic", second, [&](const Status&) { order.push_back(2); });
  queue().whenDurable("hall", first, [&](const Status&) { order.push_back(1); });
  EXPECT_EQ(queue().queued(), 3);
  const std::int64_t before = queue().commits();
  held.release();
  const Position third = append("hall");
  EXPECT_TRUE(become("hall", third).ok());
  EXPECT_THAT(order, ElementsAre(1, 2));
  EXPECT_LE(queue().commits() - before, 3) << "what waited went together";
}

// Broken by waiting in flush() for the changes alone: it never returns.
TEST_F(CommitQueueTest, AStuckBackendIsToldOfAndDoesNotHoldTheProcess) {
  disk_.failures = 1'000'000;
  const Position position = append("hall");
  EXPECT_EQ(become("hall", position).code(), Code::kUnavailable);
  EXPECT_EQ(queue().flush().code(), Code::kUnavailable);
  EXPECT_EQ(queue().available().code(), Code::kUnavailable);
  EXPECT_EQ(queue().writable("attic").code(), Code::kUnavailable) << "every session's";
  EXPECT_EQ(queue().heads().status().code(), Code::kUnavailable);
  EXPECT_EQ(queue().queued(), 1);
  queue_.reset();
  EXPECT_THAT(kept(), ElementsAre());
}

TEST_F(CommitQueueTest, TheDestructorWritesWhatWasGiven) {
  for (int i = 0; i < 3; ++i) append("hall");
  queue_.reset();
  EXPECT_THAT(kept(), ElementsAre("hall+", "hall+", "hall+"));
}

// Broken by returning the fence as the group's failure (the attic waits for ever) and by asking the backend for later
// changes of a fenced session.
TEST_F(CommitQueueTest, AFencedSessionIsRefusedAndTheOthersGoOn) {
  disk_.stolen = "hall";
  Held held(queue());
  const Position lost = append("hall");
  const Position other = append("attic");
  Status told;
  queue().whenDurable("hall", lost, [&told](const Status& status) { told = status; });
  held.release();
  EXPECT_TRUE(become("attic", other).ok());
  EXPECT_EQ(told.code(), Code::kFailedPrecondition);
  EXPECT_EQ(queue().writable("hall").code(), Code::kFailedPrecondition);
  EXPECT_TRUE(queue().writable("attic").ok());
  EXPECT_TRUE(queue().available().ok());
  EXPECT_TRUE(queue().flush().ok());
  {
    const std::lock_guard lock(disk_.mutex);
    disk_.stolen.clear();
  }
  EXPECT_FALSE(become("hall", append("hall")).ok()) << "it would leave a gap after the lost one";
  EXPECT_THAT(kept(), ElementsAre("attic+"));
}

// Broken by forgetting the fence in lift(): the lost change is said to be kept.
TEST_F(CommitQueueTest, ATakeoverEndsTheFenceAndDoesNotBringBackWhatWasLost) {
  disk_.stolen = "hall";
  const Position lost = append("hall");
  EXPECT_FALSE(become("hall", lost).ok());
  EXPECT_TRUE(become("hall", setEpoch("hall", 2)).ok());
  EXPECT_TRUE(queue().writable("hall").ok());
  EXPECT_TRUE(become("hall", append("hall")).ok());
  EXPECT_EQ(become("hall", lost).code(), Code::kFailedPrecondition);
  EXPECT_THAT(kept(), ElementsAre("hall:2", "hall+"));
}

// Broken by keeping the fences of a group that was rolled back.
TEST_F(CommitQueueTest, AFenceHoldsOnceItsGroupIsCommitted) {
  options_.retry = milliseconds(100);
  disk_.stolen = "hall";
  disk_.failures = 1;
  EXPECT_EQ(become("hall", append("hall")).code(), Code::kUnavailable) << "not known yet";
  {
    const std::lock_guard lock(disk_.mutex);
    disk_.stolen.clear();  // the other server's takeover was not committed either
  }
  caughtUp();
  EXPECT_TRUE(queue().writable("hall").ok());
  EXPECT_THAT(kept(), ElementsAre("hall+"));
}

TEST_F(CommitQueueTest, TheExecutorIsGivenWhatIsDue) {
  std::vector<std::function<void()>> posted;
  std::mutex mutex;
  options_.executor = [&](std::function<void()> call) {
    const std::lock_guard lock(mutex);
    posted.push_back(std::move(call));
  };
  bool told = false;
  Held held(queue());
  queue().whenDurable("hall", append("hall"), [&told](const Status&) { told = true; });
  held.release();
  EXPECT_TRUE(queue().flush().ok());
  queue_.reset();  // posts what was due before it ends
  EXPECT_FALSE(told);
  for (const auto& call : posted) call();
  EXPECT_TRUE(told);
}

}  // namespace
}  // namespace lpv::store
