// Frames of streams that are made once more, as calls get them, when everything rests.
#include <gtest/gtest.h>

#include <thread>

#include "unit/session/session_fixture.h"

namespace lpv {
namespace {

class SharpenTest : public test::SessionTest {
 protected:
  static Subscription frames(bool sharpen = true) {
    Subscription subscription;
    subscription.frame = FrameSettings();
    subscription.frame->sharpen = sharpen;
    return subscription;
  }
  /// A reader that has been sent its first frame and has acknowledged it.
  std::shared_ptr<Subscriber> reader(const Subscription& subscription = frames()) {
    const auto subscriber = subscribed(inbox_, subscription);
    EXPECT_EQ(inbox_->count(), 1U);
    acknowledge(subscriber, inbox_->last().meta.resultId);
    return subscriber;
  }
  /// The reader whose sharp frame is being made.
  std::shared_ptr<Subscriber> readerOfHeld() {
    rig_.engine.holdPatientOnes();
    auto subscriber = reader();
    EXPECT_TRUE(test::eventually([&] { return rig_.engine.holdsOne(); }));
    return subscriber;
  }
  bool comes(std::size_t results) {
    const bool came = test::eventually([&] { return inbox_->count() >= results; });
    rig_.settle();
    return came && inbox_->count() == results;
  }
  /// As long as a sharp frame waits for rest, twice.
  void waitLongEnough() {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    rig_.settle();
  }
};

// Seen to fail when it is reduced, when it has one sample, when it is made in the place of what the stream keeps, and
// when the frame sent stays a rough one.
TEST_F(SharpenTest, OneFollowsWhenEverythingRests) {
  const auto subscriber = reader();
  const Result rough = inbox_->last();
  EXPECT_FALSE(rough.sharp);
  ASSERT_TRUE(comes(2));
  const Result sharp = inbox_->last();
  EXPECT_TRUE(sharp.sharp);
  EXPECT_EQ(sharp.meta.revision, rough.meta.revision);
  EXPECT_GT(sharp.meta.resultId, rough.meta.resultId);
  const TickRequest made = rig_.engine.patient();
  ASSERT_EQ(made.frames.size(), 1U);
  EXPECT_FALSE(made.frames[0].reduced);
  EXPECT_EQ(made.frames[0].view, 0U);
  EXPECT_EQ(made.frames[0].samples, 32);
  EXPECT_FALSE(made.transported || made.injected);
  acknowledge(subscriber, sharp.meta.resultId);
  waitLongEnough();
  EXPECT_EQ(inbox_->count(), 2U) << "nothing has changed since";
  edited();
  EXPECT_EQ(inbox_->count(), 3U);
  EXPECT_FALSE(inbox_->last().sharp);
}

TEST_F(SharpenTest, NoneComesUnaskedOrToOneWhoHasNotAcknowledged) {
  reader(frames(false));
  const auto silent = std::make_shared<test::Inbox>();
  subscribed(silent, frames());
  waitLongEnough();
  EXPECT_EQ(inbox_->count(), 1U);
  EXPECT_EQ(silent->count(), 1U);
  EXPECT_EQ(rig_.engine.ticks(), 2);
}

// Seen to fail when the edit waits for the end of the tick, and when the frame that was given up is not made later.
TEST_F(SharpenTest, AnEditDoesNotWaitForIt) {
  const auto subscriber = readerOfHeld();
  const std::uint64_t revision = edited();
  EXPECT_EQ(rig_.engine.abandoned(), 1);
  ASSERT_EQ(inbox_->count(), 2U);
  EXPECT_FALSE(inbox_->last().sharp);
  EXPECT_EQ(inbox_->last().meta.revision, revision);
  acknowledge(subscriber, inbox_->last().meta.resultId);
  EXPECT_TRUE(test::eventually([&] { return rig_.engine.holdsOne(); })) << "when it rests again";
  EXPECT_EQ(rig_.engine.patient().scene->revision, revision);
}

// Seen to fail when what comes between a plan and its tick is forgotten.
TEST_F(SharpenTest, AnEditThatComesBeforeTheEngineKnowsDoesNotWait) {
  rig_.engine.whenSubmitted([this] { session_->apply({}, test::editOf({test::setRadiance("Lamp", 7.0)})); });
  rig_.engine.holdPatientOnes();
  reader();
  EXPECT_TRUE(comes(2));
  EXPECT_FALSE(inbox_->last().sharp);
  EXPECT_EQ(rig_.engine.abandoned(), 1);
}

TEST_F(SharpenTest, ACameraDoesNotWaitForIt) {
  const auto subscriber = readerOfHeld();
  FrameSettings next = *subscriber->subscription.frame;
  next.cameraSequence = 6;
  ASSERT_TRUE(session_->delivery().updateSubscription(subscriber, next, std::nullopt).ok());
  rig_.settle();
  EXPECT_EQ(rig_.engine.abandoned(), 1);
  ASSERT_EQ(inbox_->count(), 2U);
  EXPECT_EQ(inbox_->last().cameraSequence, 6U);
}

TEST_F(SharpenTest, CallsAndOtherReadersDoNotWaitForIt) {
  readerOfHeld();
  int answers = 0;
  WaitingCall call;
  call.frame = FrameSettings();
  call.done = [&answers](const Expected<Result>& result) { answers += result.ok() ? 1 : 0; };
  session_->delivery().ask(std::move(call));
  rig_.settle();
  EXPECT_EQ(answers, 1);
  EXPECT_EQ(rig_.engine.abandoned(), 1);
  ASSERT_TRUE(test::eventually([&] { return rig_.engine.holdsOne(); })) << "it goes on when they have theirs";
  const auto other = std::make_shared<test::Inbox>();
  subscribed(other);
  EXPECT_EQ(other->count(), 1U);
  EXPECT_EQ(rig_.engine.abandoned(), 2);
  EXPECT_EQ(inbox_->count(), 1U);
}

TEST_F(SharpenTest, NoneIsMadeForAReaderWhoHasLeft) {
  const auto subscriber = readerOfHeld();
  session_->delivery().unsubscribe(subscriber);
  rig_.settle();
  EXPECT_EQ(rig_.engine.abandoned(), 1);
  waitLongEnough();
  EXPECT_FALSE(rig_.engine.holdsOne());
  EXPECT_EQ(inbox_->count(), 1U);
}

// Seen to fail when it is watched like other ticks: a minute is enough for a server to be taken out of service.
TEST_F(SharpenTest, AServerThatTakesLongForOneIsNoStalledOne) {
  const auto subscriber = readerOfHeld();
  const auto later = TickWatch::Clock::now() + std::chrono::seconds(100);
  EXPECT_EQ(rig_.counters.tickWatch.stalledFor(later).count(), 0);
  edited();
  EXPECT_EQ(rig_.counters.tickWatch.stalledFor(later).count(), 0) << "abandoned";
}

TEST_F(SharpenTest, OneThatCannotBeMadeIsNotTriedAgain) {
  const auto subscriber = subscribed(inbox_, frames());
  rig_.engine.failWith(Status(Code::kResourceExhausted, "out of memory"));
  acknowledge(subscriber, inbox_->last().meta.resultId);
  ASSERT_TRUE(test::eventually([&] { return rig_.engine.ticks() == 2; }));
  rig_.settle();
  EXPECT_EQ(subscriber->sharpenAt(inbox_->last().meta.revision), Subscriber::kNever);
  EXPECT_EQ(rig_.counters.tickWatch.failures().total(), 1);
  EXPECT_EQ(inbox_->count(), 1U);
}

// It is larger than others, and how long it takes tells nothing of them. Seen to fail when it is measured with them.
TEST_F(SharpenTest, ItsAcknowledgementSaysNothingOfOthers) {
  const auto subscriber = reader();
  const double before = subscriber->roundTrip.mean();
  ASSERT_TRUE(comes(2));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  acknowledge(subscriber, inbox_->last().meta.resultId);
  EXPECT_EQ(subscriber->roundTrip.mean(), before);
}

// A narrow line gets small frames while a lamp is dragged, and then the whole picture.
TEST_F(SharpenTest, ItHasTheSizeAndQualityAskedFor) {
  Subscription subscription = frames();
  subscription.frame->size = {640, 360};
  subscription.adaptRate = 20.0;
  const auto subscriber = reader(subscription);
  while (subscriber->adapter->level() == 0) subscriber->adapter->acknowledged(0.1);
  edited();
  ASSERT_EQ(inbox_->count(), 2U);
  EXPECT_LT(inbox_->last().quality, 85);
  acknowledge(subscriber, inbox_->last().meta.resultId);
  ASSERT_TRUE(comes(3));
  EXPECT_TRUE(inbox_->last().sharp);
  EXPECT_EQ(inbox_->last().quality, 85);
  EXPECT_EQ(rig_.engine.patient().frames[0].size, glm::ivec2(640, 360));
}

}  // namespace
}  // namespace lpv
