// The proxy that is deployed: its configuration is valid, it serves, and it cuts off who floods.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "rpc/attacks/bystander.h"
#include "rpc/attacks/deployed_proxy.h"
#include "rpc/streams/watched.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"
#include "rpc/support/web_client.h"
#include "rpc/web/browsers.h"

namespace lpv::rpc {
namespace {

using ::testing::HasSubstr;

std::shared_ptr<grpc::Channel> channelTo(const DeployedProxy& proxy, const Authority& authority) {
  std::ifstream file(authority.file());
  grpc::SslCredentialsOptions options;
  options.pem_root_certs.assign(std::istreambuf_iterator<char>(file), {});
  return grpc::CreateChannel(proxy.address(), grpc::SslCredentials(options));
}

/// A server with TLS, as it is deployed behind the proxy, and the proxy.
class BehindTheProxy : public ::testing::Test {
 protected:
  grpc::Status getInfo(const DeployedProxy& proxy) {
    pb::GetServerInfoResponse response;
    return pb::ServerService::NewStub(channelTo(proxy, authority_))->GetServerInfo(Call(), {}, &response);
  }

  Authority authority_{"authority"};
  CertificateFiles own_ = authority_.issue("lpvd");
  Watched watched_{{"--tls-cert", own_.certificate, "--tls-key", own_.key}};
};

TEST(ProxyConfiguration, IsValid) {
  const Authority authority("authority");
  std::string said;
  EXPECT_EQ(DeployedProxy::check(authority, &said), 0) << said;
  EXPECT_THAT(said, ::testing::Not(HasSubstr("WARNING"))) << said;
}

TEST_F(BehindTheProxy, CallsAreAnswered) {
  const DeployedProxy proxy(authority_, watched_.server().port(), watched_.port());
  EXPECT_THAT(getInfo(proxy), IsOk()) << proxy.errors();
}

/// The proxy talks to nobody whose certificate is another's.
TEST_F(BehindTheProxy, AnotherServerIsNotTrusted) {
  const Authority stranger("stranger");
  const DeployedProxy proxy(authority_, watched_.server().port(), watched_.port(),
                            {{"LPV_BACKEND_CA", stranger.file()}});
  EXPECT_THAT(getInfo(proxy), HasCode(StatusCode::UNAVAILABLE));
  const DeployedProxy renamed(authority_, watched_.server().port(), watched_.port(),
                              {{"LPV_BACKEND_NAME", "lpvd.example"}});
  EXPECT_THAT(getInfo(renamed), HasCode(StatusCode::UNAVAILABLE));
}

/// Where /ready says no, nothing is sent.
TEST_F(BehindTheProxy, ReadinessIsAskedOnTheOpsPort) {
  const DeployedProxy proxy(authority_, watched_.server().port(), freePort());
  const auto stub = pb::ServerService::NewStub(channelTo(proxy, authority_));
  EXPECT_TRUE(eventually([&] {
    pb::GetServerInfoResponse response;
    return stub->GetServerInfo(Call(), {}, &response).error_code() == StatusCode::UNAVAILABLE;
  })) << "a server that nobody finds ready is still used";
}

/// A browser knows the proxy's name alone: lpvd has to know itself by that.
constexpr char kPublicHost[] = "light.example.org";
const std::string kPublicOrigin = std::string("https://") + kPublicHost;

/// A server that has the page, too, and the proxy before both doors.
class PageBehindTheProxy : public ::testing::Test {
 protected:
  Knock knock(const std::string& path) const {
    return {.host = kPublicHost, .origin = kPublicOrigin, .path = path, .authority = authority_.file()};
  }

  Authority authority_{"authority"};
  CertificateFiles own_ = authority_.issue("lpvd");
  Browsers browsers_{{"--tls-cert", own_.certificate, "--tls-key", own_.key, "--web-origins", kPublicOrigin}};
  DeployedProxy proxy_{authority_,
                       browsers_.server().port(),
                       browsers_.watched().port(),
                       {{"LPV_BACKEND_WEB", "127.0.0.1:" + std::to_string(browsers_.port())}}};
};

TEST_F(PageBehindTheProxy, ComesThroughAndItsCallsAreAnswered) {
  EXPECT_TRUE(eventually([&] { return WebSocketClient(proxy_.port(), knock("/")).status() == 200; }))
      << WebSocketClient(proxy_.port(), knock("/")).answer() << proxy_.errors();
  PageClient page(proxy_.port(), {}, knock("/ws"));
  ASSERT_EQ(page.socket().status(), 101) << page.socket().answer();
  pb::CreateSessionResponse made;
  EXPECT_EQ(page.call("SessionService/CreateSession", pb::CreateSessionRequest(), &made).code(), 0);
  EXPECT_THAT(made.session().name(), ::testing::Not(::testing::IsEmpty()));
}

/// What the page must not be asked by another site's page, it must not be asked through the proxy either.
TEST_F(PageBehindTheProxy, OtherSitesAreRefusedByName) {
  Knock foreign = knock("/ws");
  foreign.origin = "https://elsewhere.example.org";
  EXPECT_TRUE(eventually([&] { return WebSocketClient(proxy_.port(), foreign).status() == 403; }))
      << WebSocketClient(proxy_.port(), foreign).answer();
  EXPECT_THAT(WebSocketClient(proxy_.port(), foreign).answer(), HasSubstr("elsewhere.example.org"));
}

TEST_F(BehindTheProxy, WhoFloodsIsCutOffAndOthersAreNot) {
  const DeployedProxy proxy(
      authority_, watched_.server().port(), watched_.port(),
      {{"LPV_MAX_REQUEST_RATE", "3000"}, {"LPV_FLOOD_RATE", "6000"}, {"LPV_MAX_CONNECTION_RATE", "50"}});
  const auto channel = channelTo(proxy, authority_);
  pb::CreateSessionResponse session;
  ASSERT_THAT(pb::SessionService::NewStub(channel)->CreateSession(Call(), {}, &session), IsOk());
  Bystander bystander(channel, session.session().name());
  const std::string port = std::to_string(proxy.port());
  ChildProcess reset(ATTACKER_PATH, {"reset", port, "127.0.0.2", "tls", "3"});
  ChildProcess continuation(ATTACKER_PATH, {"continuation", port, "127.0.0.3", "tls", "3"});
  EXPECT_EQ(reset.wait(), 0);
  EXPECT_EQ(continuation.wait(), 0);
  const Calls calls = bystander.take();
  EXPECT_EQ(calls.failed, 0) << calls.lastError << "\n" << proxy.errors();
  EXPECT_GT(calls.milliseconds.size(), 0U);
  long connections = 0;
  ASSERT_EQ(std::sscanf(reset.output().c_str(), "reset: %ld", &connections), 1) << reset.output();
  EXPECT_GT(connections, 1) << "the connection of the flood was closed";
  ASSERT_EQ(std::sscanf(continuation.output().c_str(), "continuation: %ld", &connections), 1);
  EXPECT_GT(connections, 1) << "headers without an end were read on";
  EXPECT_TRUE(watched_.server().running());
}

/// Whether a connection from that address gets HTTP/2's first frame, which servers send unasked.
bool isGreeted(int port, const char* source) {
  const int file = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in from{}, to{};
  from.sin_family = to.sin_family = AF_INET;
  inet_pton(AF_INET, source, &from.sin_addr);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  to.sin_port = htons(std::uint16_t(port));
  char first = 0;
  const bool greeted = bind(file, reinterpret_cast<sockaddr*>(&from), sizeof from) == 0 &&
                       connect(file, reinterpret_cast<sockaddr*>(&to), sizeof to) == 0 && recv(file, &first, 1, 0) == 1;
  close(file);
  return greeted;
}

TEST(WithoutAProxy, AFloodLosesItsConnectionsAndGetsNoOthers) {
  Watched watched({"--trusted-proxy", "none", "--max-calls-per-second-per-address", "500"});
  ServerProcess& server = watched.server();
  Stubs stubs(server.address());
  Bystander bystander(stubs.channel, makeSession(stubs));
  ChildProcess reset(ATTACKER_PATH, {"reset", std::to_string(server.port()), "127.0.0.2", "plain", "2"});
  EXPECT_EQ(reset.wait(), 0);
  long connections = 0;
  ASSERT_EQ(std::sscanf(reset.output().c_str(), "reset: %ld", &connections), 1) << reset.output();
  EXPECT_GT(connections, 1);
  EXPECT_EQ(watched.metric("lpv_address_bans_total"), 1.0);
  EXPECT_FALSE(isGreeted(server.port(), "127.0.0.2")) << "what comes from there is closed unread";
  EXPECT_TRUE(isGreeted(server.port(), "127.0.0.5"));
  const Calls calls = bystander.take();
  EXPECT_EQ(calls.failed, 0) << calls.lastError;
  EXPECT_TRUE(server.running());
}

}  // namespace
}  // namespace lpv::rpc
