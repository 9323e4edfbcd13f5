// Access tokens: who is let in, as what, for how long.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <future>

#include "persistence/persistent_journal.h"
#include "session/access.h"
#include "session/memory_journal.h"
#include "unit/store/store_rig.h"

namespace lpv {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
using testing::HasSubstr;

constexpr const char* kAdmin = "an admin's token of some length";

class AccessTest : public testing::Test {
 protected:
  AccessTest() { EXPECT_TRUE(access_.require(kAdmin).ok()); }
  ~AccessTest() override { timers_.stop(); }

  std::string mint(const std::string& session, Role role, seconds life = hours(1)) {
    Expected<MintedToken> made = access_.mint(session, role, life);
    EXPECT_TRUE(made.ok()) << made.status().message();
    return made->token;
  }
  Code refusalOf(const std::string& token) const { return access_.verify(token).status().code(); }

  MemoryJournal journal_;
  Timers timers_;
  Access access_{journal_, timers_};
};

TEST_F(AccessTest, EverybodyIsAnAdminUntilTokensAreAskedFor) {
  Access open(journal_, timers_);
  const Expected<Grant> grant = open.verify("");
  ASSERT_TRUE(grant.ok());
  EXPECT_EQ(grant->role, Role::kAdmin);
  EXPECT_FALSE(open.required());
}

// Broken by comparing ids alone, and by leaving the hash out of the comparison.
TEST_F(AccessTest, OnlyTheWholeTokenIsKnown) {
  const std::string token = mint("a", Role::kEditor);
  const Expected<Grant> grant = access_.verify(token);
  ASSERT_TRUE(grant.ok());
  EXPECT_EQ(grant->role, Role::kEditor);
  EXPECT_EQ(grant->session, "a");
  for (std::size_t i = 0; i < token.size(); ++i) {
    std::string other = token;
    other[i] = other[i] == '0' ? '1' : '0';
    EXPECT_EQ(refusalOf(other), Code::kUnauthenticated) << i;
  }
  for (const std::string& other : {std::string(), token + "0", token.substr(1), token.substr(0, token.size() - 1),
                                   std::string(100000, 'x'), std::string(kAdmin) + " ", std::string("lpv_")}) {
    EXPECT_EQ(refusalOf(other), Code::kUnauthenticated);
  }
}

TEST_F(AccessTest, TheAdminTokenCanBeReplaced) {
  EXPECT_EQ(access_.verify(kAdmin)->role, Role::kAdmin);
  const std::string token = mint("a", Role::kViewer);
  ASSERT_TRUE(access_.require("another admin's token").ok());
  EXPECT_EQ(refusalOf(kAdmin), Code::kUnauthenticated);
  EXPECT_EQ(access_.verify("another admin's token")->role, Role::kAdmin);
  EXPECT_TRUE(access_.verify(token).ok());
  EXPECT_FALSE(access_.require("too short").ok());
  EXPECT_TRUE(access_.verify("another admin's token").ok());
}

// Broken by looking at the expiry when a token is made only.
TEST_F(AccessTest, TokensExpireAndWhatTheyOpenedEnds) {
  const std::string token = mint("a", Role::kViewer, seconds(1));
  const std::string other = mint("a", Role::kViewer);
  const Expected<Grant> grant = access_.verify(token);
  ASSERT_TRUE(grant.ok());
  std::promise<Status> ended;
  const auto ward = access_.watch(*grant, [&ended](const Status& why) { ended.set_value(why); });
  const Status why = ended.get_future().get();
  EXPECT_EQ(why.code(), Code::kUnauthenticated);
  EXPECT_THAT(why.message(), HasSubstr("expired"));
  EXPECT_THAT(access_.verify(token).status().message(), HasSubstr("expired"));
  EXPECT_TRUE(access_.verify(other).ok());
}

TEST_F(AccessTest, RevokedTokensEndWhatTheyOpenedAndNothingElse) {
  const std::string token = mint("a", Role::kEditor);
  const std::string other = mint("a", Role::kEditor);
  int ends = 0;
  int others = 0;
  const auto ward = access_.watch(*access_.verify(token), [&ends](const Status&) { ++ends; });
  auto gone = access_.watch(*access_.verify(token), [&others](const Status&) { ++others; });
  const auto beside = access_.watch(*access_.verify(other), [&others](const Status&) { ++others; });
  gone.reset();
  const std::string id = access_.verify(token)->tokenId;
  EXPECT_EQ(access_.revoke("b", id).status().code(), Code::kNotFound);  // a token of another session
  EXPECT_EQ(ends, 0);
  EXPECT_TRUE(access_.revoke("a", id).ok());
  EXPECT_EQ(ends, 1);
  EXPECT_EQ(others, 0);
  EXPECT_EQ(refusalOf(token), Code::kUnauthenticated);
  EXPECT_EQ(access_.revoke("a", id).status().code(), Code::kNotFound);
}

// Broken by watching whatever grant is given: a stream whose token went while it was opened never ended.
TEST_F(AccessTest, WhatIsOpenedWhileItsTokenGoesEndsAtOnce) {
  const Expected<Grant> grant = access_.verify(mint("a", Role::kViewer));
  ASSERT_TRUE(grant.ok());
  ASSERT_TRUE(access_.revoke("a", grant->tokenId).ok());
  Status why;
  const auto ward = access_.watch(*grant, [&why](const Status& status) { why = status; });
  EXPECT_EQ(why.code(), Code::kUnauthenticated);
  EXPECT_EQ(ward, nullptr);
}

// Broken by listing every session's, expired ones, and by another order.
TEST_F(AccessTest, ASessionsTokensAreListedInOrderOfTheirIds) {
  EXPECT_TRUE(access_.tokensOf("a").empty());
  for (const Role role : {Role::kViewer, Role::kOwner, Role::kEditor}) (void)mint("a", role);
  (void)mint("b", Role::kViewer);
  const std::string brief = mint("a", Role::kViewer, seconds(1));
  EXPECT_EQ(access_.tokensOf("a").size(), 4U);
  std::promise<void> ended;
  const auto ward = access_.watch(*access_.verify(brief), [&ended](const Status&) { ended.set_value(); });
  ended.get_future().wait();
  const std::vector<AccessToken> listed = access_.tokensOf("a");
  ASSERT_EQ(listed.size(), 3U);
  EXPECT_TRUE(std::is_sorted(listed.begin(), listed.end(), [](const auto& a, const auto& b) { return a.id < b.id; }));
  for (const AccessToken& token : listed) EXPECT_EQ(token.session, "a");
  ASSERT_TRUE(access_.revoke("a", listed[1].id).ok());
  EXPECT_EQ(access_.tokensOf("a").size(), 2U);
}

TEST_F(AccessTest, SessionsTakeTheirTokensAlong) {
  const std::string token = mint("a", Role::kOwner);
  const std::string other = mint("b", Role::kOwner);
  access_.forget("a");
  EXPECT_EQ(refusalOf(token), Code::kUnauthenticated);
  EXPECT_TRUE(access_.verify(other).ok());
}

TEST_F(AccessTest, LivesAndNumbersAreLimited) {
  for (const seconds life : {seconds(0), seconds(-1), seconds(kMaxTokenLife) + seconds(1)}) {
    EXPECT_EQ(access_.mint("a", Role::kViewer, life).status().field(), "ttl");
  }
  for (std::size_t i = 0; i < kMaxTokensPerSession; ++i) (void)mint("a", Role::kViewer, kMaxTokenLife);
  EXPECT_EQ(access_.mint("a", Role::kViewer, hours(1)).status().code(), Code::kResourceExhausted);
  EXPECT_TRUE(access_.mint("b", Role::kViewer, hours(1)).ok());
}

// Broken by leaving the token's row where its session is removed, and by not writing the removal of a revoked one.
TEST(KeptTokens, ComeBackUnlessTheyOrTheirSessionsAreGone) {
  const store::Folder folder;
  std::string stays;
  std::string revoked;
  std::string orphan;
  {
    const auto sqlite = store::openStore(folder);
    api::PersistentJournal journal(*sqlite);
    Timers timers;
    Access access(journal, timers);
    ASSERT_TRUE(access.require(kAdmin).ok());
    (void)store::createSession(*sqlite, "a");
    (void)store::createSession(*sqlite, "b");
    stays = access.mint("a", Role::kEditor, hours(1))->token;
    revoked = access.mint("a", Role::kOwner, hours(1))->token;
    orphan = access.mint("b", Role::kOwner, hours(1))->token;
    (void)access.mint("nobody", Role::kOwner, hours(1));
    ASSERT_TRUE(access.revoke("a", access.verify(revoked)->tokenId).ok());
    const Position gone = sqlite->remove("b");
    ASSERT_TRUE(store::keptAt(*sqlite, gone, "b").ok());
    timers.stop();
  }
  const auto sqlite = store::openStore(folder);
  EXPECT_EQ(store::ask(folder, "SELECT count(*) FROM tokens"), 1);
  EXPECT_EQ(store::ask(folder, "SELECT count(*) FROM tokens WHERE instr(hash, '" + stays.substr(21) + "')"), 0);
  api::PersistentJournal journal(*sqlite);
  Timers timers;
  Access access(journal, timers);
  ASSERT_TRUE(access.open().ok());
  ASSERT_TRUE(access.require(kAdmin).ok());
  const Expected<Grant> grant = access.verify(stays);
  ASSERT_TRUE(grant.ok());
  EXPECT_EQ(grant->role, Role::kEditor);
  EXPECT_EQ(grant->session, "a");
  EXPECT_FALSE(access.verify(revoked).ok());
  EXPECT_FALSE(access.verify(orphan).ok());
  timers.stop();
}

}  // namespace
}  // namespace lpv
