// The books of what answers hold.

#include "session/answer_room.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace lpv {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Limits limitsOf(std::int64_t server, std::int64_t session) {
  Limits limits;
  limits.maxAnswerBytes = server;
  limits.maxAnswerBytesPerSession = session;
  return limits;
}

class AnswerRoomTest : public ::testing::Test {
 protected:
  Expected<AnswerHoldPtr> take(const std::string& session, std::int64_t megabytes) {
    return room_.take(session, megabytes * 1'000'000, limits_);
  }
  std::int64_t heldMegabytes() const { return room_.held() / 1'000'000; }

  Limits limits_ = limitsOf(100'000'000, 40'000'000);
  AnswerRoom room_;
};

TEST_F(AnswerRoomTest, WhatIsTakenIsGivenBack) {
  {
    const auto first = take("a", 30);
    const auto second = take("b", 20);
    ASSERT_TRUE(first.ok() && second.ok());
    EXPECT_EQ(heldMegabytes(), 50);
    (*first)->shrinkTo(5'000'000);
    EXPECT_EQ(heldMegabytes(), 25);
    (*first)->shrinkTo(9'000'000);
    EXPECT_EQ(heldMegabytes(), 25) << "a hold never grows";
    EXPECT_TRUE(take("a", 35).ok()) << "what it shrank by is there for others";
  }
  EXPECT_EQ(room_.held(), 0);
  EXPECT_EQ(room_.peak(), 60'000'000);
}

TEST_F(AnswerRoomTest, ASessionHasItsShare) {
  const auto first = take("a", 30);
  const Status refused = take("a", 11).status();
  EXPECT_EQ(refused.code(), Code::kResourceExhausted);
  EXPECT_EQ(refused.reason(), Reason::kMaxAnswerBytesPerSession);
  EXPECT_GT(refused.retryAfter().count(), 0);
  EXPECT_THAT(refused.message(),
              AllOf(HasSubstr("max_answer_bytes_per_session"), HasSubstr("hold 30 MB"), HasSubstr("up to 11 MB"),
                    HasSubstr("allowed are 40 MB"), HasSubstr("then ask again")));
  EXPECT_TRUE(take("a", 10).ok());
  EXPECT_TRUE(take("b", 40).ok());
}

TEST_F(AnswerRoomTest, WhatIsLargerThanAShareIsMadeAlone) {
  {
    const auto large = take("a", 90);
    ASSERT_TRUE(large.ok()) << large.status().message();
    EXPECT_EQ(take("a", 1).status().reason(), Reason::kMaxAnswerBytesPerSession);
  }
  const auto small = take("a", 1);
  EXPECT_EQ(take("a", 90).status().reason(), Reason::kMaxAnswerBytesPerSession);
}

TEST_F(AnswerRoomTest, AServerHasItsLimit) {
  const auto first = take("a", 40);
  const auto second = take("b", 40);
  const Status refused = take("c", 21).status();
  EXPECT_EQ(refused.reason(), Reason::kMaxAnswerBytes);
  EXPECT_GT(refused.retryAfter().count(), 0);
  EXPECT_THAT(refused.message(), AllOf(HasSubstr("this server hold 80 MB"), HasSubstr("allowed are 100 MB")));
  EXPECT_TRUE(take("c", 20).ok());
}

/// There is no use in repeating it.
TEST_F(AnswerRoomTest, WhatCanNeverBeMadeIsRefusedForGood) {
  const Status refused = take("a", 101).status();
  EXPECT_EQ(refused.reason(), Reason::kMaxAnswerBytes);
  EXPECT_EQ(refused.retryAfter().count(), 0);
  EXPECT_THAT(refused.message(), AllOf(HasSubstr("up to 101 MB"), HasSubstr("--max-answer-bytes")));
}

TEST_F(AnswerRoomTest, ManyThreadsKeepTheBooksRight) {
  std::vector<std::thread> takers;
  for (int i = 0; i < 4; ++i) {
    takers.emplace_back([this, session = std::string(1, char('a' + i))] {
      for (int round = 0; round < 2000; ++round) {
        const auto first = take(session, 30);
        const auto second = take(session, 9);
        if (first) (*first)->shrinkTo(1'000'000);
      }
    });
  }
  for (std::thread& taker : takers) taker.join();
  EXPECT_EQ(room_.held(), 0);
  EXPECT_LE(room_.peak(), 100'000'000);
}

}  // namespace
}  // namespace lpv
