// Volumes that are made before the acknowledgement they wait for.
#include <gtest/gtest.h>

#include <thread>

#include "unit/session/session_fixture.h"

namespace lpv {
namespace {

using test::SessionTest;

/// Readers who acknowledge after a while, and always the same.
class FarReaders : public SessionTest {
 protected:
  static constexpr double kRoundTrip = 0.05;  // seconds

  /// One that has been sent the first result.
  std::shared_ptr<Subscriber> far(const Subscription& subscription = volumes()) {
    const auto subscriber = subscribed(inbox_, subscription);
    first_ = inbox_->last().meta.resultId;
    for (int i = 0; i < 100; ++i) subscriber->roundTrip.measured(kRoundTrip);
    return subscriber;
  }
  /// The volume that is made of the next edit without a credit.
  Result ahead() {
    edited();
    EXPECT_TRUE(test::eventually([&] { return inbox_->prepared().size() == 1; }));
    rig_.settle();
    EXPECT_EQ(inbox_->count(), 1U) << "its credit is out";
    EXPECT_EQ(rig_.engine.ticks(), 2);
    return inbox_->prepared().empty() ? Result() : inbox_->prepared().front();
  }
  static void waitTwoRoundTrips() { std::this_thread::sleep_for(std::chrono::duration<double>(2 * kRoundTrip)); }

  std::uint64_t first_ = 0;  ///< result
};

// Seen to fail when the acknowledgement starts a tick of its own.
TEST_F(FarReaders, GetWhatWasMadeForTheMomentTheirCreditComesBack) {
  const auto subscriber = far();
  const Result made = ahead();
  EXPECT_EQ(made.baseId, first_);
  acknowledge(subscriber, first_);
  ASSERT_EQ(inbox_->count(), 2U);
  EXPECT_EQ(inbox_->last().meta.resultId, made.meta.resultId);
  EXPECT_EQ(inbox_->last().baseId, first_);
  EXPECT_EQ(rig_.engine.ticks(), 2);
  edited();
  EXPECT_EQ(inbox_->count(), 2U) << "it was their credit that it was sent for";
}

// Seen to fail when the age of what was kept is not looked at.
TEST_F(FarReaders, GetNothingOldWhereTheSceneWentOn) {
  const auto subscriber = far();
  const Result made = ahead();
  const std::uint64_t newest = edited();
  acknowledge(subscriber, first_);
  ASSERT_EQ(inbox_->count(), 2U);
  EXPECT_GT(inbox_->last().meta.resultId, made.meta.resultId);
  EXPECT_EQ(inbox_->last().meta.revision, newest);
  EXPECT_EQ(inbox_->last().baseId, first_);
}

// Seen to fail when the base is not compared.
TEST_F(FarReaders, GetNoDeltaToWhatTheyHaveLost) {
  const auto subscriber = far();
  const Result made = ahead();
  session_->delivery().resend(subscriber);
  acknowledge(subscriber, first_);
  ASSERT_EQ(inbox_->count(), 2U);
  EXPECT_GT(inbox_->last().meta.resultId, made.meta.resultId);
  EXPECT_EQ(inbox_->last().baseId, 0U);
}

// Seen to fail when a tick ahead leaves nothing that says there was one.
TEST_F(FarReaders, HaveOneVolumeMadeForACredit) {
  const auto subscriber = far();
  ahead();
  edited();
  waitTwoRoundTrips();
  rig_.settle();
  EXPECT_EQ(inbox_->prepared().size(), 1U);
  EXPECT_EQ(rig_.engine.ticks(), 2);
}

// Seen to fail when what is old is kept until an acknowledgement.
TEST_F(FarReaders, HoldNoVolumeForLong) {
  const auto subscriber = far();
  ahead();
  EXPECT_TRUE(subscriber->prefetch);
  edited();
  subscribed(std::make_shared<test::Inbox>());  // has a tick made
  EXPECT_FALSE(subscriber->prefetch);
}

// Seen to fail when the deviation is not asked for.
TEST_F(FarReaders, HaveNothingMadeWhileThereIsNoTellingWhen) {
  const auto subscriber = far();
  for (const double trip : {10.0, 0.0, 0.0, 0.0}) subscriber->roundTrip.measured(trip);
  edited();
  waitTwoRoundTrips();
  rig_.settle();
  EXPECT_EQ(inbox_->prepared().size(), 0U);
  EXPECT_EQ(rig_.engine.ticks(), 1);
}

}  // namespace
}  // namespace lpv
