// What a session makes, for whom and when; its clients' edits; its end. Ticks cost nothing here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "unit/session/session_fixture.h"

namespace lpv {
namespace {

using test::createLight;
using test::editOf;
using test::SessionTest;
using test::setRadiance;
using testing::HasSubstr;

TEST_F(SessionTest, MakesNothingThatNobodyWaitsFor) {
  edited();
  EXPECT_EQ(rig_.engine.ticks(), 0);
  const auto subscriber = subscribed(inbox_);
  EXPECT_EQ(rig_.engine.ticks(), 1);
  edited();
  EXPECT_EQ(rig_.engine.ticks(), 1) << "its credit is spent";
  session_->delivery().unsubscribe(subscriber);
  edited();
  EXPECT_EQ(rig_.engine.ticks(), 1);
}

// Seen to fail with the last result sent as base: of two in flight it may not have arrived.
TEST_F(SessionTest, TheBaseIsTheNewestResultAcknowledged) {
  const auto subscriber = subscribed(inbox_, twoCredits());
  EXPECT_EQ(inbox_->last().baseId, 0U);
  const std::uint64_t first = inbox_->last().meta.resultId;
  subscriber->roundTrip.measured(10.0);  // longer than the interval: two may be in flight
  edited();
  ASSERT_EQ(inbox_->count(), 2U);
  const std::uint64_t second = inbox_->last().meta.resultId;
  EXPECT_EQ(inbox_->last().baseId, 0U) << "nothing is acknowledged yet";
  acknowledge(subscriber, first);
  edited();
  EXPECT_EQ(inbox_->last().baseId, first);
  acknowledge(subscriber, second);
  edited();
  EXPECT_EQ(inbox_->last().baseId, second);
}

// Seen to fail when what was in flight before the resend counts as a base.
TEST_F(SessionTest, WhatWasSentBeforeAResendIsNoBase) {
  const auto subscriber = subscribed(inbox_);
  acknowledge(subscriber, inbox_->last().meta.resultId);
  edited();
  EXPECT_NE(inbox_->last().baseId, 0U);
  session_->delivery().resend(subscriber);
  acknowledge(subscriber, inbox_->last().meta.resultId);
  EXPECT_EQ(inbox_->count(), 3U);
  EXPECT_EQ(inbox_->last().baseId, 0U);
  const std::uint64_t whole = inbox_->last().meta.resultId;
  acknowledge(subscriber, whole);
  edited();
  EXPECT_EQ(inbox_->last().baseId, whole);
}

// Seen to fail when the credit is not asked for.
TEST_F(SessionTest, SendsOneResultPerAcknowledgement) {
  const auto subscriber = subscribed(inbox_);
  ASSERT_EQ(inbox_->count(), 1U);
  edited();
  const std::uint64_t newest = edited();
  EXPECT_EQ(inbox_->count(), 1U);
  acknowledge(subscriber, inbox_->last().meta.resultId);
  ASSERT_EQ(inbox_->count(), 2U);
  EXPECT_EQ(inbox_->last().meta.revision, newest) << "the ones between were never made";
  acknowledge(subscriber, inbox_->last().meta.resultId);
  EXPECT_EQ(inbox_->count(), 2U) << "nothing changed";
}

// Seen to fail when any acknowledgement frees the credit.
TEST_F(SessionTest, AnAcknowledgementOfWhatIsNotUnderWayGivesNoCredit) {
  const auto subscriber = subscribed(inbox_);
  const std::uint64_t first = inbox_->last().meta.resultId;
  acknowledge(subscriber, first);
  edited();
  ASSERT_EQ(inbox_->count(), 2U);
  edited();
  acknowledge(subscriber, first);
  acknowledge(subscriber, 0);
  acknowledge(subscriber, inbox_->last().meta.resultId + 1);
  EXPECT_EQ(inbox_->count(), 2U);
}

TEST_F(SessionTest, TwoCreditsComeWithARoundTripAboveTheInterval) {
  const auto subscriber = subscribed(inbox_, twoCredits());
  edited();
  EXPECT_EQ(inbox_->count(), 1U) << "no round trip is known yet";
  acknowledge(subscriber, inbox_->last().meta.resultId);
  EXPECT_EQ(inbox_->count(), 2U);
  edited();
  EXPECT_EQ(inbox_->count(), 3U) << "the second credit";
  edited();
  EXPECT_EQ(inbox_->count(), 3U) << "there is no third";
}

// Seen to fail when a repeated acknowledgement of the older result frees the newer one's credit.
TEST_F(SessionTest, EachOfTwoCreditsComesBackOnce) {
  const auto subscriber = subscribed(inbox_, twoCredits());
  acknowledge(subscriber, inbox_->last().meta.resultId);
  edited();
  ASSERT_EQ(inbox_->count(), 2U);
  const std::uint64_t older = inbox_->last().meta.resultId;
  edited();
  ASSERT_EQ(inbox_->count(), 3U);
  edited();
  acknowledge(subscriber, older);
  EXPECT_EQ(inbox_->count(), 4U);
  edited();
  acknowledge(subscriber, older);
  EXPECT_EQ(inbox_->count(), 4U) << "older was acknowledged before";
  acknowledge(subscriber, inbox_->last().meta.resultId);
  EXPECT_EQ(inbox_->count(), 5U);
  edited();
  EXPECT_EQ(inbox_->count(), 6U) << "the newest one's acknowledgement covered both";
}

TEST_F(SessionTest, OneCreditIsAllThatIsGivenUnasked) {
  const auto subscriber = subscribed(inbox_);
  acknowledge(subscriber, inbox_->last().meta.resultId);
  edited();
  edited();
  EXPECT_EQ(inbox_->count(), 2U);
}

TEST_F(SessionTest, AWholeResultIsOwedAgainOnRequest) {
  const auto subscriber = subscribed(inbox_);
  acknowledge(subscriber, inbox_->last().meta.resultId);
  session_->delivery().resend(subscriber);
  rig_.settle();
  ASSERT_EQ(inbox_->count(), 2U);
  EXPECT_EQ(inbox_->last().meta.revision, 1U);
}

// Seen to fail when a call takes whatever volume was made last.
TEST_F(SessionTest, ACallIsAnsweredFromItsRevisionOrALaterOne) {
  std::vector<std::uint64_t> answers;
  const auto ask = [&](std::uint64_t revision) {
    WaitingCall call;
    call.minRevision = revision;
    call.volume = VolumeStage::kTransported;
    call.done = [&answers](Expected<Result> result) { answers.push_back(result ? result->meta.revision : 0); };
    session_->delivery().ask(std::move(call));
    rig_.settle();
  };
  ask(1);
  EXPECT_THAT(answers, testing::ElementsAre(1U));
  edited();
  ask(session_->revision());
  EXPECT_THAT(answers, testing::ElementsAre(1U, 2U));
  EXPECT_EQ(rig_.engine.ticks(), 2);
  ask(1);
  EXPECT_THAT(answers, testing::ElementsAre(1U, 2U, 2U));
  EXPECT_EQ(rig_.engine.ticks(), 2) << "what is there is good enough";
  ask(4);
  edited();
  EXPECT_EQ(answers.size(), 3U) << "revision 3 is not what it waits for";
  edited();
  EXPECT_THAT(answers, testing::ElementsAre(1U, 2U, 2U, 4U));
}

/// What a tick draws is held until it ends.
// Seen to fail where every call that waits is in the next tick.
TEST_F(SessionTest, LargeFramesOfCallsAreMadeOneAfterTheOther) {
  int answers = 0;
  const int before = rig_.engine.ticks();
  for (int i = 0; i < 5; ++i) {
    WaitingCall call;
    call.frame = FrameSettings();
    call.frame->size = {4096, 4096};
    call.frame->camera.camera = Camera();
    call.done = [&answers](const Expected<Result>&) { ++answers; };
    session_->delivery().ask(std::move(call));
  }
  rig_.settle();
  EXPECT_EQ(answers, 5);
  EXPECT_EQ(rig_.engine.ticks() - before, 5);
}

// A stream's frames look at near lights from some pixels, a single frame from each.
// Seen to fail with both, and with neither, reduced.
TEST_F(SessionTest, FramesOfStreamsAreReduced) {
  Subscription subscription;
  subscription.frame = FrameSettings();
  subscribed(inbox_, subscription);
  ASSERT_EQ(inbox_->count(), 1U);
  EXPECT_EQ(rig_.engine.reducedFrames(), 1);
  int answers = 0;
  WaitingCall call;
  call.frame = FrameSettings();
  call.done = [&answers](const Expected<Result>&) { ++answers; };
  session_->delivery().ask(std::move(call));
  rig_.settle();
  EXPECT_EQ(answers, 1);
  EXPECT_EQ(rig_.engine.reducedFrames(), 1);
}

TEST_F(SessionTest, ATickThatFailsEndsItsCallsAndIsTriedAgain) {
  rig_.engine.failWith(Status(Code::kInternal, "out of memory"));
  std::vector<Status> answers;
  WaitingCall call;
  call.volume = VolumeStage::kTransported;
  call.done = [&answers](Expected<Result> result) { answers.push_back(result.status()); };
  session_->delivery().ask(std::move(call));
  subscribed(inbox_);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].message(), "out of memory");
  EXPECT_EQ(inbox_->count(), 0U);
  rig_.engine.failWith({});
  EXPECT_TRUE(test::eventually([&] { return inbox_->count() == 1; })) << "the reader is owed it still";
}

TEST_F(SessionTest, ACameraMakesAFrameAndAnOlderOneDoesNotReturn) {
  Subscription subscription;
  subscription.frame = FrameSettings();
  subscription.frame->cameraSequence = 5;
  const auto subscriber = subscribed(inbox_, subscription);
  acknowledge(subscriber, inbox_->last().meta.resultId);
  FrameSettings next = *subscription.frame;
  next.cameraSequence = 6;
  ASSERT_TRUE(session_->delivery().updateSubscription(subscriber, next, std::nullopt).ok());
  rig_.settle();
  ASSERT_EQ(inbox_->count(), 2U);
  EXPECT_EQ(inbox_->last().cameraSequence, 6U);
  EXPECT_EQ(inbox_->last().meta.revision, 1U);
  next.cameraSequence = 4;
  ASSERT_TRUE(session_->delivery().updateSubscription(subscriber, next, std::nullopt).ok());
  EXPECT_EQ(session_->delivery().subscriptionOf(subscriber).frame->cameraSequence, 6U);
}

// Seen to fail when the outcome is not recorded.
TEST_F(SessionTest, ARepeatedSequenceIsAppliedOnce) {
  const ClientIdentity me = *session_->join();
  const EditOutcome first = session_->apply(me, editOf({createLight("Mine")}, 1));
  const EditOutcome again = session_->apply(me, editOf({createLight("Mine")}, 1));
  EXPECT_EQ(again.revision, first.revision);
  EXPECT_EQ(again.names, first.names);
  EXPECT_EQ(session_->summary().lights, 2U);
  const Status unreadable(Code::kInvalidArgument, "no number", "edit.operations[0]");
  EXPECT_EQ(session_->recordRejected(me, 2, unreadable).status.message(), "no number");
  EXPECT_EQ(session_->apply(me, editOf({createLight("Mine")}, 2)).status.message(), "no number");
  EXPECT_TRUE(session_->recordRejected(me, 1, unreadable).status.ok()) << "the first outcome of 1 was another";
  EXPECT_EQ(session_->recordRejected({"c-stranger", ""}, 3, unreadable).status.code(), Code::kPermissionDenied);
  EXPECT_EQ(session_->revision(), first.revision);
}

// Seen to fail when the time to live is not looked at, and when a reader does not count as use.
TEST_F(SessionTest, ExpiresAfterItsTimeWithoutUse) {
  const auto now = std::chrono::system_clock::now();
  const auto later = now + std::chrono::seconds(70);
  EXPECT_FALSE(session_->expired(now + std::chrono::seconds(50)));
  EXPECT_TRUE(session_->expired(later));
  const std::uint64_t watcher = session_->watch([] {}, [](Closing) {});
  EXPECT_FALSE(session_->expired(later));
  session_->unwatch(watcher);
  EXPECT_TRUE(session_->expired(later));
  const auto subscriber = subscribed(inbox_);
  EXPECT_FALSE(session_->expired(later));
  session_->delivery().unsubscribe(subscriber);
  WaitingCall call;
  call.minRevision = 100;
  call.volume = VolumeStage::kTransported;
  call.done = [](const Expected<Result>&) {};
  const auto waiting = session_->delivery().ask(std::move(call));
  EXPECT_FALSE(session_->expired(later));
  session_->delivery().forget(waiting);
  EXPECT_TRUE(session_->expired(later));
  EXPECT_FALSE(rig_.session({std::chrono::seconds(0), ""})->expired(now + std::chrono::hours(100000))) << "0 is never";
}

/// What a session that has ended answers, by why it ended.
class ClosedSession : public SessionTest, public testing::WithParamInterface<Closing> {};

TEST_P(ClosedSession, SaysWhyToWhoeverIsThereAndWhoeverComes) {
  const bool draining = GetParam() == Closing::kDraining;
  const Code code = draining ? Code::kUnavailable : Code::kNotFound;
  subscribed(inbox_);
  std::optional<Closing> watcher;
  session_->watch([] {}, [&watcher](Closing why) { watcher = why; });
  Status answer;
  WaitingCall call;
  call.minRevision = 100;
  call.volume = VolumeStage::kTransported;
  call.done = [&answer](Expected<Result> result) { answer = result.status(); };
  session_->delivery().ask(call);
  session_->close(GetParam());
  rig_.settle();
  EXPECT_EQ(inbox_->closed(), GetParam());
  EXPECT_EQ(watcher, GetParam());
  EXPECT_EQ(answer.code(), code);

  watcher.reset();
  session_->watch([] {}, [&watcher](Closing why) { watcher = why; });
  answer = Status();
  session_->delivery().ask(call);
  rig_.settle();
  EXPECT_EQ(watcher, GetParam()) << "of one that came late";
  EXPECT_EQ(answer.code(), code);
  EXPECT_EQ(session_->apply({}, editOf({setRadiance("Lamp", 2.0)})).status.code(), code);
  EXPECT_EQ(session_->delivery().subscribe(volumes(), inbox_).status().code(), code);
  EXPECT_EQ(session_->addBlob(nullptr).status().code(), code);
  EXPECT_EQ(session_->revision(), 1U);
}

INSTANTIATE_TEST_SUITE_P(All, ClosedSession, testing::Values(Closing::kDeleted, Closing::kDraining),
                         [](const auto& row) { return row.param == Closing::kDeleted ? "Deleted" : "Draining"; });

}  // namespace
}  // namespace lpv
