// ListTokens, by the library, by lpvctl and raw: an owner sees which tokens a session has, and nobody else does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "rpc/cli/cli_run.h"
#include "rpc/support/rpc.h"

namespace lpv::cli {
namespace {

namespace pb = lpv::v1;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kAdmin = "the admin's token, for a test";
constexpr std::size_t kPrefixBytes = 4;  ///< "lpv_", then the id
constexpr std::size_t kIdBytes = 16;

class TokenList : public testing::Test {
 protected:
  TokenList() {
    for (const char* id : {"lit", "other"}) {
      pb::CreateSessionRequest request;
      request.set_session_id(id);
      const auto made = as(kAdmin).createSession(request);
      EXPECT_TRUE(made.ok()) << made.status().message();
      if (std::string(id) == "lit") owner_ = made->owner_token();
    }
  }

  client::Client as(const std::string& token) const {
    client::ConnectOptions options;
    options.address = server_.address();
    options.token = token;
    return *client::Client::connect(options);
  }
  pb::CreateTokenResponse mint(pb::Role role) const {
    pb::CreateTokenRequest request;
    request.set_session("sessions/lit");
    request.set_role(role);
    const auto made = as(owner_).createToken(request);
    EXPECT_TRUE(made.ok()) << made.status().message();
    return *made;
  }
  /// lpvctl session tokens lit, with this token.
  Outcome listed(const std::string& token, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"--server", server_.address(), "--token-file",
                                       folder_.write("token", token + "\n")};
    arguments.insert(arguments.end(), {"session", "tokens", "lit"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runLpvctl(arguments);
  }

  TemporaryFolder folder_;
  rpc::ServerProcess server_{{"--admin-token-file", folder_.write("admin", std::string(kAdmin) + "\n")}};
  std::string owner_;
};

// Broken by naming the tokens of other sessions, and by an editor's role in the table of methods.
TEST_F(TokenList, HasIdRoleAndExpiryForTheOwnerAlone) {
  const pb::CreateTokenResponse viewer = mint(pb::ROLE_VIEWER);
  const pb::CreateTokenResponse editor = mint(pb::ROLE_EDITOR);
  const auto tokens = as(owner_).tokens("lit");
  ASSERT_TRUE(tokens.ok()) << tokens.status().message();
  std::map<std::string, pb::AccessToken> byId;
  for (const pb::AccessToken& token : *tokens) byId[token.token_id()] = token;
  ASSERT_EQ(byId.size(), 3U);
  EXPECT_EQ(byId[owner_.substr(kPrefixBytes, kIdBytes)].role(), pb::ROLE_OWNER);
  EXPECT_EQ(byId[editor.token_id()].role(), pb::ROLE_EDITOR);
  EXPECT_EQ(byId[viewer.token_id()].role(), pb::ROLE_VIEWER);
  EXPECT_EQ(byId[viewer.token_id()].expire_time().seconds(), viewer.expire_time().seconds());
  for (const std::string& token : {viewer.token(), editor.token()}) {
    EXPECT_EQ(as(token).tokens("lit").status().code(), Code::kPermissionDenied);
  }
  EXPECT_EQ(as(owner_).tokens("other").status().code(), Code::kPermissionDenied);
  EXPECT_EQ(as(kAdmin).tokens("other")->size(), 1U);
  ASSERT_TRUE(as(owner_).revokeToken("lit", editor.token_id()).ok());
  EXPECT_EQ(as(owner_).tokens("lit")->size(), 2U);
  EXPECT_THAT(server_.log(), HasSubstr("audit tokens"));
}

// Broken by a page that repeats or skips.
TEST_F(TokenList, ComesInPages) {
  for (int i = 0; i < 4; ++i) (void)mint(pb::ROLE_VIEWER);
  rpc::Stubs stubs(server_.address());
  std::set<std::string> seen;
  pb::ListTokensRequest request;
  request.set_session("sessions/lit");
  request.set_page_size(2);
  int pages = 0;
  do {
    rpc::Call call;
    call->AddMetadata("authorization", "Bearer " + owner_);
    pb::ListTokensResponse page;
    ASSERT_THAT(stubs.session->ListTokens(call, request, &page), rpc::IsOk());
    EXPECT_LE(page.tokens_size(), 2);
    for (const pb::AccessToken& token : page.tokens()) EXPECT_TRUE(seen.insert(token.token_id()).second);
    request.set_page_token(page.next_page_token());
    ++pages;
  } while (!request.page_token().empty());
  EXPECT_EQ(pages, 3);
  EXPECT_EQ(seen.size(), 5U);
}

// Broken by printing the request's id, and by a list that is printed where it was refused.
TEST_F(TokenList, IsWhatLpvctlPrints) {
  const pb::CreateTokenResponse viewer = mint(pb::ROLE_VIEWER);
  const Outcome text = listed(owner_);
  EXPECT_EQ(text.exit, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr(viewer.token_id() + "  viewer  until 2"), HasSubstr("  owner   until 2")));
  EXPECT_THAT(text.out, Not(HasSubstr(viewer.token()))) << "secrets are not kept";
  const Outcome json = listed(owner_, {"--json"});
  EXPECT_THAT(json.out, HasSubstr("\"tokenId\":\"" + viewer.token_id() + "\",\"role\":\"ROLE_VIEWER\""));
  const Outcome refused = listed(viewer.token());
  EXPECT_EQ(refused.exit, 4);
  EXPECT_EQ(refused.out, "");
  EXPECT_THAT(refused.err, HasSubstr("owner"));
}

// Broken by answering an empty list: whoever reads it believes that nobody has access.
TEST(OpenServer, RefusesToListTokens) {
  const auto made = rpc::clientOf(rpc::server().address()).createSession({});
  ASSERT_TRUE(made.ok());
  const Status refused = rpc::clientOf(rpc::server().address()).tokens(made->session().name()).status();
  EXPECT_EQ(refused.code(), Code::kFailedPrecondition);
  EXPECT_THAT(refused.message(), HasSubstr("--admin-token-file"));
}

}  // namespace
}  // namespace lpv::cli
