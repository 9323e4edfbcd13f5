// Many calls on one socket, whose network the test plays: what is refused, what is counted, and how calls end.

#include "web/calls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "convert/scene.h"
#include "lpv/v1/blob.pb.h"
#include "lpv/v1/scene.pb.h"
#include "lpv/v1/session.pb.h"
#include "unit/api/door_rig.h"
#include "unit/web/page_rig.h"

namespace lpv::web_door {
namespace {

using test::beginStep;
using test::messageStep;
using testing::HasSubstr;
using web::v1::ToServer;

/// A page that has said hello.
class WebCallsTest : public testing::Test {
 protected:
  WebCallsTest() {
    ToServer hello;
    hello.mutable_hello();
    say(hello);
  }
  ~WebCallsTest() override {
    if (calls_) calls_->lost();
    socket_->settle();
  }

  void say(const ToServer& step) { calls_->receive(step.SerializeAsString()); }
  void end(std::uint32_t call) {
    ToServer step;
    step.set_call(call);
    step.set_end(true);
    say(step);
  }
  /// How a call has ended; nothing where it has not.
  std::optional<v1::Status> ended(std::uint32_t call) const {
    std::optional<v1::Status> out;
    for (const auto& step : socket_->said) {
      if (step.call() != call || !step.has_end()) continue;
      EXPECT_FALSE(out) << "ends twice";
      out = step.end();
    }
    return out;
  }
  std::uint32_t taken(std::uint32_t call) const {
    std::uint32_t out = 0;
    for (const auto& step : socket_->said) out += step.call() == call ? step.taken() : 0;
    return out;
  }
  static std::string aboutTheRoom() {
    v1::GetSessionRequest request;
    request.set_name("sessions/room");
    return request.SerializeAsString();
  }

  test::DoorRig rig_{false};
  std::shared_ptr<test::PageSocket> socket_ = std::make_shared<test::PageSocket>();
  std::shared_ptr<Calls> calls_ = std::make_shared<Calls>(rig_.context, "ipv4:127.0.0.1:1", socket_);
};

TEST_F(WebCallsTest, AnswersAndForgets) {
  EXPECT_EQ(socket_->greetedGood, true);
  ASSERT_EQ(socket_->said.size(), 1U);
  EXPECT_TRUE(socket_->said[0].has_welcome());
  say(beginStep(1, "SessionService/GetSession"));
  EXPECT_EQ(calls_->count(), 1U);
  say(messageStep(1, aboutTheRoom()));
  socket_->settle();
  ASSERT_TRUE(ended(1));
  EXPECT_EQ(ended(1)->code(), 0) << ended(1)->message();
  EXPECT_EQ(taken(1), 1U);
  EXPECT_EQ(calls_->count(), 0U);
}

// Nothing that comes after the one message of a unary call is held.
TEST_F(WebCallsTest, WhatAQuestionDoesNotNeedIsNotKept) {
  say(beginStep(1, "SessionService/GetSession"));
  for (int i = 0; i < 50; ++i) say(messageStep(1, aboutTheRoom()));
  EXPECT_FALSE(socket_->closedWith);
  socket_->settle();
  EXPECT_EQ(ended(1)->code(), 0);
  EXPECT_EQ(taken(1), 1U);
}

TEST_F(WebCallsTest, EightMessagesMayWait) {
  say(beginStep(1, "SceneService/StreamEdits"));
  for (std::size_t i = 0; i < kMostUntaken; ++i) say(messageStep(1, ""));
  EXPECT_FALSE(socket_->closedWith);
  say(messageStep(1, ""));
  EXPECT_EQ(socket_->closedWith, CloseCode::kPolicy);
  EXPECT_THAT(socket_->reason, HasSubstr("8 messages"));
  EXPECT_LE(socket_->reason.size(), 123U);
}

// Broken by: counting what was taken and not what a call's end has dropped.
TEST_F(WebCallsTest, ASocketThatIsAheadIsNotRead) {
  const std::string large(900'000, 'x');
  std::uint32_t call = 0;
  while (!calls_->full() && call < 20) {
    say(beginStep(++call, "SceneService/StreamEdits"));
    say(messageStep(call, large));
    say(messageStep(call, large));
  }
  EXPECT_EQ(call, kMostUntakenBytes / (2 * large.size()) + 1);
  EXPECT_EQ(socket_->roomAgains, 0);
  socket_->settle();  // they are no messages, so that their calls end
  EXPECT_FALSE(calls_->full());
  EXPECT_EQ(socket_->roomAgains, 1);
  EXPECT_EQ(calls_->count(), 0U);
}

TEST_F(WebCallsTest, AHundredCallsAtOnce) {
  for (std::uint32_t call = 1; call <= kMostCalls; ++call) say(beginStep(call, "SceneService/WatchScene"));
  EXPECT_EQ(calls_->count(), kMostCalls);
  say(beginStep(200, "SessionService/GetSession"));
  ASSERT_TRUE(ended(200));
  EXPECT_EQ(ended(200)->code(), int(Code::kResourceExhausted));
  EXPECT_FALSE(socket_->closedWith);
  for (std::uint32_t call = 1; call <= kMostCalls; ++call) end(call);
  socket_->settle();
  EXPECT_EQ(calls_->count(), 0U);
  EXPECT_EQ(ended(1)->code(), int(Code::kInvalidArgument)) << "it said nothing";
  say(beginStep(201, "SessionService/GetSession"));
  say(messageStep(201, aboutTheRoom()));
  socket_->settle();
  EXPECT_EQ(ended(201)->code(), 0);
}

TEST_F(WebCallsTest, StepsOfACallThatHasEndedArePassedOver) {
  say(beginStep(1, "SessionService/GetSession"));
  say(messageStep(1, aboutTheRoom()));
  socket_->settle();
  ToServer cancel;
  cancel.set_call(1);
  cancel.set_cancel(true);
  say(cancel);
  end(1);
  say(messageStep(1, ""));
  socket_->settle();
  EXPECT_FALSE(socket_->closedWith);
  EXPECT_EQ(ended(1)->code(), 0);
}

// Streams end with the socket, also where what they were sending never goes out.
TEST_F(WebCallsTest, ALostSocketLeavesNothing) {
  v1::WatchSceneRequest watch;
  watch.set_session("sessions/room");
  socket_->holdsBack = true;
  for (std::uint32_t call = 1; call <= 3; ++call) {
    say(beginStep(call, "SceneService/WatchScene"));
    say(messageStep(call, watch.SerializeAsString()));
  }
  socket_->settle();
  EXPECT_EQ(calls_->count(), 3U);
  calls_->lost();
  socket_->holdsBack = false;
  socket_->settle();
  EXPECT_EQ(calls_->count(), 0U);
  const std::weak_ptr<Calls> left = calls_;
  calls_.reset();
  EXPECT_TRUE(left.expired()) << "no call holds it";
}

TEST_F(WebCallsTest, AShownTokenIsOfTheCallsThatFollow) {
  ASSERT_TRUE(rig_.access.require(test::kAdminToken).ok());
  ToServer hello;
  hello.mutable_hello()->set_token("lpv_wrong");
  say(hello);
  EXPECT_EQ(socket_->greetedGood, false);
  say(beginStep(1, "SessionService/GetSession"));
  socket_->settle();
  EXPECT_EQ(ended(1)->code(), int(Code::kUnauthenticated));
  hello.mutable_hello()->set_token(test::kAdminToken);
  say(hello);
  EXPECT_EQ(socket_->greetedGood, true);
  say(beginStep(2, "SessionService/GetSession"));
  say(messageStep(2, aboutTheRoom()));
  socket_->settle();
  EXPECT_EQ(ended(2)->code(), 0);
}

}  // namespace
}  // namespace lpv::web_door
