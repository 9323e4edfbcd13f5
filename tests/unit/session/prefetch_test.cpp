// Results that are made before the acknowledgement they wait for.
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "session/delivery/readers.h"
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

/// Two readers of one session, of a volume and of frames, whose ticks take longer than they do.
class NearReaders : public testing::Test {
 protected:
  static constexpr auto kTick = std::chrono::milliseconds(50);
  static constexpr auto kTrip = std::chrono::milliseconds(10);

  NearReaders() {
    Subscription ofVolume, ofFrames;
    ofVolume.volume = VolumeStage::kTransported;
    ofFrames.frame.emplace();
    volume_ = readers_.add(ofVolume, nullptr);
    frames_ = readers_.add(ofFrames, nullptr);
  }
  Occasion at(Clock::duration since) const { return {kBegin + since, revision_, {30.0, 0.06, 0.05}}; }
  TickPlan plan(Clock::duration since) {
    const auto hasView = [](const CameraChoice&, std::uint64_t) { return true; };
    TickPlan plan;
    readers_.planSubscribers(at(since), hasView, &plan);
    if (!plan.empty()) readers_.planSharers(at(since), hasView, &plan);
    return plan;
  }
  /// Ends at that time; what is sent.
  std::vector<Offer> end(const TickPlan& plan, Clock::duration since) {
    TickResult result;
    if (plan.transported) result.transported = std::make_shared<Volume>();
    for (std::size_t i = 0; i < plan.frameReaders.size(); ++i) result.frames.push_back(std::make_shared<Frame>());
    ResultMeta meta;
    meta.revision = revision_;
    return readers_.deliverResults(plan, result, meta, at(since)).offers;
  }
  /// Both have been sent the first result and know how long their acknowledgements take; the frames' is back, and the
  /// scene has changed.
  void begin() {
    end(plan({}), {});
    for (int i = 0; i < 50; ++i) volume_->roundTrip.measured(std::chrono::duration<double>(kTrip).count());
    for (int i = 0; i < 50; ++i) frames_->roundTrip.measured(std::chrono::duration<double>(kTrip).count());
    ++revision_;
  }
  bool holds(const SubscriberPtr& one) const { return one->prefetch.has_value(); }
  static void acknowledgeTo(const SubscriberPtr& one, Clock::duration since) {
    one->acknowledge(one->lastSent, kBegin + since);
  }

  static constexpr Clock::time_point kBegin{std::chrono::hours(1)};
  Readers readers_;
  SubscriberPtr volume_, frames_;
  std::uint64_t revision_ = 1;
};

// Seen to fail when ticks are made for those alone who have their credit.
TEST_F(NearReaders, ShareATickThatEndsWhenTheirCreditIsBack) {
  begin();
  acknowledgeTo(volume_, kTrip / 2);
  const TickPlan both = plan(kTrip / 2);
  EXPECT_TRUE(both.transported);
  ASSERT_EQ(both.frameReaders.size(), 1U);
  acknowledgeTo(frames_, kTrip);
  EXPECT_EQ(end(both, kTrip / 2 + kTick).size(), 2U) << "both have their credits";
  EXPECT_FALSE(holds(frames_));
}

// Seen to fail when a frame is sent without a credit, or forgotten.
TEST_F(NearReaders, AFrameWaitsForItsCredit) {
  begin();
  acknowledgeTo(volume_, kTrip / 2);
  const TickPlan both = plan(kTrip / 2);
  EXPECT_EQ(end(both, kTrip / 2 + kTick).size(), 1U) << "the volume";
  ASSERT_TRUE(holds(frames_));
  const Clock::duration late = kTrip + kTick;
  acknowledgeTo(frames_, late);
  const std::optional<Result> kept = frames_->takePrefetch(revision_, at(late).pace, kBegin + late);
  ASSERT_TRUE(kept && kept->frame);
  EXPECT_EQ(kept->meta.revision, revision_);
}

// Seen to fail when whoever takes long is waited for all the same.
TEST_F(NearReaders, WhoTakesLongerThanATickHasNoShare) {
  begin();
  for (int i = 0; i < 50; ++i) frames_->roundTrip.measured(0.5);
  acknowledgeTo(volume_, kTrip / 2);
  EXPECT_TRUE(plan(kTrip / 2).frameReaders.empty());
}

// Seen to fail when a reader that does not acknowledge has a frame made in every tick.
TEST_F(NearReaders, OneIsMadeForACredit) {
  begin();
  acknowledgeTo(volume_, kTrip / 2);
  end(plan(kTrip / 2), kTick);
  ++revision_;
  acknowledgeTo(volume_, 2 * kTick);
  EXPECT_TRUE(plan(2 * kTick).frameReaders.empty());
}

// Seen to fail when what a dropped frame would have shown of a camera is forgotten.
TEST_F(NearReaders, AFrameThatIsDroppedIsStillWanted) {
  begin();
  acknowledgeTo(volume_, kTrip / 2);
  frames_->shownRevision = revision_;
  frames_->settingsChanged = true;
  const TickPlan both = plan(kTrip / 2);
  ASSERT_EQ(both.frameReaders.size(), 1U);
  end(both, kTick);
  ASSERT_TRUE(holds(frames_));
  EXPECT_FALSE(frames_->wants(revision_));
  acknowledgeTo(volume_, 2 * kTick);
  ++revision_;
  frames_->shownRevision = revision_;
  end(plan(4 * kTick), 4 * kTick);
  EXPECT_FALSE(holds(frames_));
  EXPECT_TRUE(frames_->wants(revision_));
}

}  // namespace
}  // namespace lpv
