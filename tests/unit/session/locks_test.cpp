// Objects that a member has asked the others to leave alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/members/locks.h"
#include "unit/session/session_rig.h"

namespace lpv {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::createLight;
using test::editOf;
using test::setRadiance;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class LocksTest : public testing::Test {
 protected:
  Locks locks_;
  const Clock::time_point start_ = Clock::now();
};

TEST_F(LocksTest, KeepOthersAwayForTheirTimeAndNameHolderAndRest) {
  ASSERT_TRUE(locks_.lock("a", {"Lamp"}, seconds(10), start_).ok());
  EXPECT_TRUE(locks_.check("a", "Lamp", start_).ok());
  EXPECT_TRUE(locks_.check("b", "Other", start_).ok());
  const Status refused = locks_.check("b", "Lamp", start_ + milliseconds(6500));
  EXPECT_EQ(refused.code(), Code::kAborted);
  EXPECT_THAT(refused.message(), testing::AllOf(HasSubstr("Lamp"), HasSubstr("client a"), HasSubstr("another 4 s")));
  EXPECT_FALSE(locks_.check("", "Lamp", start_).ok()) << "nobody is another";
  EXPECT_TRUE(locks_.check("b", "Lamp", start_ + seconds(10)).ok());
  EXPECT_TRUE(locks_.lock("b", {"Lamp"}, seconds(10), start_ + seconds(10)).ok());
}

TEST_F(LocksTest, AreTakenAllOrNoneAndRenewed) {
  ASSERT_TRUE(locks_.lock("a", {"Lamp"}, seconds(10), start_).ok());
  EXPECT_EQ(locks_.lock("b", {"Other", "Lamp"}, seconds(10), start_).code(), Code::kAborted);
  EXPECT_THAT(locks_.heldBy("b"), IsEmpty());
  ASSERT_TRUE(locks_.lock("a", {"Lamp"}, seconds(10), start_ + seconds(9)).ok());
  EXPECT_FALSE(locks_.check("b", "Lamp", start_ + seconds(18)).ok());
}

TEST_F(LocksTest, AreReleasedByTheirHolderOnly) {
  ASSERT_TRUE(locks_.lock("a", {"Lamp", "Other"}, seconds(10), start_).ok());
  locks_.release("b", {});
  EXPECT_THAT(locks_.heldBy("a"), ElementsAre("Lamp", "Other"));
  locks_.release("a", {"Lamp"});
  EXPECT_THAT(locks_.heldBy("a"), ElementsAre("Other"));
  locks_.release("a", {});
  EXPECT_THAT(locks_.heldBy("a"), IsEmpty());
}

TEST_F(LocksTest, AreLimitedByName) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kMaxLocks; ++i) names.push_back("L" + std::to_string(i));
  ASSERT_TRUE(locks_.lock("a", names, seconds(10), start_).ok());
  EXPECT_EQ(locks_.lock("a", {"Lamp"}, seconds(10), start_).field(), "max_locks");
  EXPECT_TRUE(locks_.lock("a", names, seconds(10), start_).ok()) << "the same again";
  EXPECT_TRUE(locks_.lock("a", {"Lamp"}, seconds(10), start_ + seconds(11)).ok()) << "those are over";
  EXPECT_THAT(locks_.expire(start_ + seconds(11)), ElementsAre("a"));
  EXPECT_THAT(locks_.heldBy("a"), ElementsAre("Lamp"));
}

class LockedSession : public testing::Test {
 protected:
  Status apply(const ClientIdentity& client, std::vector<Operation> operations) {
    return session_->apply(client, editOf(std::move(operations))).status;
  }

  test::Rig rig_;
  std::shared_ptr<Session> session_ = rig_.session();
  const ClientIdentity a_ = *session_->join();
  const ClientIdentity b_ = *session_->join();
};

TEST_F(LockedSession, RefusesEditsOfOthersWhole) {
  ASSERT_TRUE(apply(b_, {createLight("Lamp"), createLight("Other")}).ok());
  ASSERT_TRUE(apply(b_, {setRadiance("Lamp", 2.0)}).ok());
  ASSERT_TRUE(session_->lockObjects(a_, {"Lamp"}, seconds(60)).ok());
  const Status refused = apply(b_, {setRadiance("Other", 2.0), setRadiance("Lamp", 3.0)});
  EXPECT_EQ(refused.code(), Code::kAborted);
  EXPECT_EQ(refused.field(), "edit.operations[1]");
  EXPECT_EQ(session_->revision(), 2U);
  EXPECT_EQ(apply({}, {DeleteLight{"Lamp"}}).code(), Code::kAborted);
  EXPECT_EQ(apply({}, {SetVertices{"Lamp", {}, {}, nullptr, nullptr}}).code(), Code::kAborted);
  EXPECT_EQ(session_->undoRedo(b_, 0, UndoDirection::kUndo).status.code(), Code::kAborted);
  EXPECT_TRUE(apply(b_, {setRadiance("Other", 2.0), createLight("Lamp")}).ok()) << "another object, another name";
  EXPECT_TRUE(apply(a_, {setRadiance("Lamp", 3.0)}).ok());
  ASSERT_TRUE(session_->lockObjects(a_, {}, seconds(0)).ok());
  EXPECT_TRUE(session_->undoRedo(b_, 0, UndoDirection::kUndo).status.ok()) << "its step is still there";
}

TEST_F(LockedSession, TellsOfLocksAndForgetsThemWithTheirHolder) {
  ASSERT_TRUE(apply(b_, {createLight("Lamp")}).ok());
  ASSERT_TRUE(session_->lockObjects(a_, {"Lamp"}, seconds(30)).ok());
  EXPECT_THAT(session_->presenceSnapshot().at(a_.id).presence.locked, ElementsAre("Lamp"));
  const Clock::time_point over = Clock::now() + seconds(31);
  const std::uint64_t before = session_->presenceChanges();
  session_->dropSilentMembers(over);
  EXPECT_GT(session_->presenceChanges(), before);
  ASSERT_TRUE(session_->lockObjects(a_, {"Lamp"}, seconds(30)).ok());
  session_->leave(a_);
  EXPECT_TRUE(session_->presenceSnapshot().empty());
  EXPECT_TRUE(apply(b_, {setRadiance("Lamp", 2.0)}).ok());
}

TEST_F(LockedSession, RefusesLocksThatMakeNoSense) {
  ASSERT_TRUE(apply(b_, {createLight("Lamp")}).ok());
  EXPECT_EQ(session_->lockObjects({}, {"Lamp"}, seconds(1)).field(), "client");
  EXPECT_EQ(session_->lockObjects({a_.id, "guess"}, {"Lamp"}, seconds(1)).code(), Code::kPermissionDenied);
  EXPECT_EQ(session_->lockObjects(a_, {"Lamp"}, seconds(61)).field(), "ttl");
  EXPECT_EQ(session_->lockObjects(a_, {"Lamp"}, seconds(-1)).field(), "ttl");
  EXPECT_EQ(session_->lockObjects(a_, {}, seconds(1)).field(), "objects");
  EXPECT_EQ(session_->lockObjects(a_, {"Lamp", "None"}, seconds(1)).code(), Code::kNotFound);
  EXPECT_TRUE(apply(b_, {setRadiance("Lamp", 2.0)}).ok());
}

}  // namespace
}  // namespace lpv
