// The door with a lock: access tokens, TLS, certificates of clients. Real servers, real handshakes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <thread>

#include "lpv/edits.h"
#include "lpv/watch.h"
#include "rpc/security/certificates.h"
#include "rpc/streams/watched.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using testing::HasSubstr;

std::string textOf(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

constexpr const char* kAdmin = "the admin's token, for a test";

const Authority& authority() {
  static const Authority authority("lpv test authority");
  return authority;
}

client::Client connect(const std::string& address, const std::string& token = {}, client::TlsOptions tls = {}) {
  client::ConnectOptions options;
  options.address = address;
  options.token = token;
  options.tls = std::move(tls);
  options.timeout = std::chrono::seconds(20);
  Expected<client::Client> client = client::Client::connect(options);
  EXPECT_TRUE(client.ok()) << client.status().message();
  return *client;
}

Code codeOf(const Status& status) { return status.code(); }
template <typename T>
Code codeOf(const Expected<T>& value) {
  return value.status().code();
}

pb::Edit move(const std::string& light, double x) {
  pb::Edit edit;
  *edit.add_operations() = moveTo(light, {x, 0, 0});
  return edit;
}

/// A server that asks for tokens, with a session that has a lamp.
class Tokens : public testing::Test {
 protected:
  Tokens() {
    pb::CreateSessionRequest request;
    request.set_session_id("lit");
    *request.mutable_settings() = settings();
    const auto made = admin_.createSession(request);
    EXPECT_TRUE(made.ok()) << made.status().message();
    ownerToken_ = made->owner_token();
    pb::Edit edit;
    *edit.add_operations()->mutable_create_light() = light("Lamp");
    EXPECT_TRUE(as(ownerToken_).applyEdit("lit", edit).ok());
  }

  client::Client as(const std::string& token) { return connect(server_.address(), token); }
  pb::CreateTokenResponse mint(pb::Role role, std::int64_t seconds = 600) {
    pb::CreateTokenRequest request;
    request.set_session("sessions/lit");
    request.set_role(role);
    request.mutable_ttl()->set_seconds(seconds);
    const auto made = as(ownerToken_).createToken(request);
    EXPECT_TRUE(made.ok()) << made.status().message();
    return *made;
  }

  const std::string adminFile_ = authority().write("admin", std::string(kAdmin) + "\n");
  ServerProcess server_{{"--admin-token-file", adminFile_}};
  client::Client admin_ = connect(server_.address(), kAdmin);
  std::string ownerToken_;
};

TEST_F(Tokens, MissingWrongAndForeignTokensAreRefusedEverywhere) {
  for (const std::string& token : {std::string(), std::string("lpv_0123456789abcdef_0123456789abcdef0123456789abcdef"),
                                   std::string(kAdmin) + "?", std::string("Bearer")}) {
    client::Client nobody = as(token);
    EXPECT_EQ(codeOf(nobody.serverInfo()), Code::kUnauthenticated);
    EXPECT_EQ(codeOf(nobody.sessions()), Code::kUnauthenticated);
    EXPECT_EQ(codeOf(nobody.session("lit")), Code::kUnauthenticated);
    EXPECT_EQ(codeOf(nobody.applyEdit("lit", move("Lamp", 0.1))), Code::kUnauthenticated);
    EXPECT_EQ(codeOf(nobody.probe("lit", {{{0, 0, 0.5}, {0, 0, -1}}})), Code::kUnauthenticated);
    EXPECT_EQ(codeOf(nobody.volume([] {
                pb::GetVolumeRequest request;
                request.set_session("sessions/lit");
                return request;
              }())),
              Code::kUnauthenticated);
    EXPECT_EQ(codeOf(nobody.deleteSession("lit")), Code::kUnauthenticated);
  }
  EXPECT_TRUE(admin_.healthy().ok());
  EXPECT_TRUE(as({}).healthy().ok());  // probes show no token
}

// Broken by taking each role for the one above it.
TEST_F(Tokens, EachRoleDoesWhatItMay) {
  client::Client viewer = as(mint(pb::ROLE_VIEWER).token());
  client::Client editor = as(mint(pb::ROLE_EDITOR).token());
  client::Client owner = as(ownerToken_);
  EXPECT_TRUE(viewer.session("lit").ok());
  EXPECT_TRUE(viewer.probe("lit", {{{0, 0, 0.5}, {0, 0, -1}}}).ok());
  const Status refused = viewer.applyEdit("lit", move("Lamp", 0.1)).status();
  EXPECT_EQ(refused.code(), Code::kPermissionDenied);
  EXPECT_THAT(refused.message(), HasSubstr("editor"));
  EXPECT_EQ(codeOf(viewer.fitSession("lit")), Code::kPermissionDenied);
  EXPECT_TRUE(editor.applyEdit("lit", move("Lamp", 0.1)).ok());
  pb::CreateTokenRequest request;
  request.set_session("sessions/lit");
  request.set_role(pb::ROLE_OWNER);
  EXPECT_EQ(codeOf(editor.createToken(request)), Code::kPermissionDenied);
  EXPECT_EQ(codeOf(editor.deleteSession("lit")), Code::kPermissionDenied);
  EXPECT_EQ(codeOf(editor.stats()), Code::kPermissionDenied);
  EXPECT_EQ(codeOf(owner.createSession({})), Code::kPermissionDenied);
  EXPECT_TRUE(owner.deleteSession("lit").ok());
  EXPECT_EQ(codeOf(viewer.session("lit")), Code::kUnauthenticated);  // its tokens went with it
}

TEST_F(Tokens, ATokenIsForItsSessionAlone) {
  pb::CreateSessionRequest request;
  request.set_session_id("other");
  ASSERT_TRUE(admin_.createSession(request).ok());
  client::Client owner = as(ownerToken_);
  EXPECT_EQ(codeOf(owner.session("other")), Code::kPermissionDenied);
  EXPECT_EQ(codeOf(owner.deleteSession("other")), Code::kPermissionDenied);
  EXPECT_EQ(codeOf(owner.session("missing")), Code::kPermissionDenied);  // nor does it tell which there are
  const auto listed = owner.sessions();
  ASSERT_TRUE(listed.ok());
  ASSERT_EQ(listed->size(), 1U);
  EXPECT_EQ((*listed)[0].name(), "sessions/lit");
  EXPECT_EQ(admin_.sessions()->size(), 2U);
}

// Broken by: a session from a file that nobody owns.
TEST_F(Tokens, WhoLoadsASessionGetsItsOwnersToken) {
  std::string file;
  ASSERT_TRUE(
      as(ownerToken_).exportSession("lit", [&](const std::string& part) { return !(file += part).empty(); }).ok());
  EXPECT_EQ(codeOf(as(ownerToken_).importSession("copy", file)), Code::kPermissionDenied);
  const auto made = admin_.importSession("copy", file);
  ASSERT_TRUE(made.ok()) << made.status().message();
  EXPECT_EQ(codeOf(as(ownerToken_).session("copy")), Code::kPermissionDenied);
  EXPECT_TRUE(as(made->owner_token()).deleteSession("copy").ok());
}

// Broken by leaving streams alone where a token is revoked.
TEST_F(Tokens, RevocationAndExpiryEndStreams) {
  const pb::CreateTokenResponse revoked = mint(pb::ROLE_VIEWER);
  const pb::CreateTokenResponse brief = mint(pb::ROLE_VIEWER, 2);
  const auto openStream = [this](grpc::ClientContext& context, Stubs& stubs, const std::string& token) {
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));  // ends a hang
    context.AddMetadata("authorization", "Bearer " + token);
    pb::WatchVolumeRequest request;
    request.mutable_subscription()->set_session("sessions/lit");
    return stubs.result->WatchVolume(&context, request);
  };
  Stubs stubs(server_.address());
  grpc::ClientContext first;
  grpc::ClientContext second;
  const auto a = openStream(first, stubs, revoked.token());
  const auto b = openStream(second, stubs, brief.token());
  pb::WatchVolumeResponse response;
  ASSERT_TRUE(a->Read(&response));
  ASSERT_TRUE(as(ownerToken_).revokeToken("lit", revoked.token_id()).ok());
  while (a->Read(&response)) {
  }
  while (b->Read(&response)) {
  }
  EXPECT_EQ(a->Finish().error_code(), StatusCode::UNAUTHENTICATED);
  EXPECT_EQ(b->Finish().error_code(), StatusCode::UNAUTHENTICATED);
  EXPECT_EQ(codeOf(as(revoked.token()).session("lit")), Code::kUnauthenticated);
  EXPECT_EQ(codeOf(as(brief.token()).session("lit")), Code::kUnauthenticated);
}

// Broken by reading the file at the start only.
TEST_F(Tokens, AHangupReadsTheAdminTokenAgain) {
  authority().write("admin", "the next admin's token, for a test\n");
  server_.process().signal(SIGHUP);
  client::Client next = as("the next admin's token, for a test");
  EXPECT_TRUE(eventually([&] { return next.sessions().ok(); }));
  EXPECT_EQ(codeOf(admin_.sessions()), Code::kUnauthenticated);
  EXPECT_TRUE(as(ownerToken_).session("lit").ok());
  authority().write("admin", "short\n");
  server_.process().signal(SIGHUP);
  EXPECT_TRUE(eventually([&] { return server_.log().find("what was read before is kept") != std::string::npos; }));
  EXPECT_TRUE(next.sessions().ok());
}

TEST(KeptTokens, AreGoodAfterAKill) {
  const std::string state = authority().folder() + "/state";
  const std::vector<std::string> arguments{"--admin-token-file", authority().write("admin", kAdmin), "--state-dir",
                                           state};
  std::string token;
  {
    ServerProcess server(arguments);
    const auto made = connect(server.address(), kAdmin).createSession({});
    ASSERT_TRUE(made.ok());
    token = made->owner_token();
    server.process().signal(SIGKILL);
  }
  ServerProcess server(arguments);
  const auto listed = connect(server.address(), token).sessions();
  ASSERT_TRUE(listed.ok()) << listed.status().message();
  EXPECT_EQ(listed->size(), 1U);
}

TEST(Tls, IsSpokenByThoseWhoTrustTheAuthority) {
  const CertificateFiles files = authority().issue("server");
  ServerProcess server({"--tls-cert", files.certificate, "--tls-key", files.key});
  EXPECT_TRUE(connect(server.address(), {}, {.caFile = authority().file()}).serverInfo().ok());
  const Authority stranger("a stranger");
  EXPECT_EQ(codeOf(connect(server.address(), {}, {.caFile = stranger.file()}).serverInfo()), Code::kUnavailable);
  EXPECT_EQ(codeOf(connect(server.address()).serverInfo()), Code::kUnavailable);  // plain text on the TLS port
}

// Broken by asking for certificates without requiring them.
TEST(Tls, ClientsNeedACertificateWhereAuthoritiesAreGiven) {
  const CertificateFiles files = authority().issue("server");
  const CertificateFiles ours = authority().issue("client");
  const Authority stranger("a stranger");
  const CertificateFiles theirs = stranger.issue("client");
  ServerProcess server(
      {"--tls-cert", files.certificate, "--tls-key", files.key, "--tls-client-ca", authority().file()});
  const auto answer = [&](const CertificateFiles& shown) {
    return codeOf(connect(server.address(), {}, {authority().file(), shown.certificate, shown.key}).serverInfo());
  };
  EXPECT_EQ(answer(ours), Code::kOk);
  EXPECT_EQ(answer({}), Code::kUnavailable);
  EXPECT_EQ(answer(theirs), Code::kUnavailable);
}

TEST(Tls, ANewCertificateIsTakenUpWithoutARestart) {
  const Authority next("the next authority");
  const std::string folder = authority().folder();
  const CertificateFiles old = authority().issue("server");
  const CertificateFiles fresh = next.issue("server");
  std::filesystem::create_directory(folder + "/first");
  std::filesystem::create_directory(folder + "/second");
  for (const auto& [files, to] : {std::pair(old, folder + "/first"), std::pair(fresh, folder + "/second")}) {
    std::filesystem::copy(files.certificate, to + "/cert");
    std::filesystem::copy(files.key, to + "/key");
  }
  std::filesystem::create_directory_symlink(folder + "/first", folder + "/now");
  ServerProcess server({"--tls-cert", folder + "/now/cert", "--tls-key", folder + "/now/key"});
  client::Client before = connect(server.address(), {}, {.caFile = authority().file()});
  ASSERT_TRUE(before.serverInfo().ok());
  std::filesystem::create_directory_symlink(folder + "/second", folder + "/next");
  std::filesystem::rename(folder + "/next", folder + "/now");
  EXPECT_TRUE(eventually([&] { return connect(server.address(), {}, {.caFile = next.file()}).serverInfo().ok(); }));
  EXPECT_TRUE(before.serverInfo().ok());  // open connections stay
}

/// A server whose key and chain are replaced where they lie, one file after the other.
class ChangingCertificate : public testing::Test {
 protected:
  void put(const std::string& from, const std::string& to) const {
    std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing);
  }
  void putPair(const CertificateFiles& files) const {
    put(files.certificate, certificate_);
    put(files.key, key_);
  }
  void truncate(const std::string& path) const {
    std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  }
  bool answersTo(const Authority& trusted) const {
    return connect(watched_.server().address(), {}, {.caFile = trusted.file()}).serverInfo().ok();
  }
  bool readySays(const std::string& words) const {
    return eventually([&] { return watched_.get("/ready").body.find(words) != std::string::npos; });
  }

  const Authority next_{"the next authority"};
  const CertificateFiles old_ = authority().issue("old");
  const CertificateFiles fresh_ = next_.issue("fresh");
  const std::string certificate_ = authority().folder() + "/changing.pem";
  const std::string key_ = authority().folder() + "/changing.key";
  const bool put_ = (putPair(old_), true);
  mutable Watched watched_{{"--tls-cert", certificate_, "--tls-key", key_}};
};

// Broken by: gRPC's own watcher, which serves nobody while key and chain do not go together.
TEST_F(ChangingCertificate, WhatIsHalfChangedIsToldAndNotUsed) {
  const std::vector<std::pair<std::string, std::function<void()>>> spoiled = {
      {"is not the key of the certificate", [&] { put(fresh_.certificate, certificate_); }},
      {"is no PEM file of certificates", [&] { truncate(certificate_); }},
      {"is no PEM file of a private key", [&] { putPair(old_), truncate(key_); }},
      {"is cut off, or broken, after certificate 1",
       [&] { std::ofstream(certificate_, std::ios::app) << "-----BEGIN CERTIFICATE-----\nMIIB\n"; }},
      {"has not signed the one before it",
       [&] { std::ofstream(certificate_, std::ios::app) << std::ifstream(next_.file()).rdbuf(); }},
      {"has expired", [&] { putPair(authority().issue("expired", -60)); }},
      {"cannot be read", [&] { std::filesystem::remove(key_); }},
  };
  int told = 0;
  for (const auto& [says, spoil] : spoiled) {
    spoil();
    EXPECT_TRUE(readySays(says)) << says << ": " << watched_.get("/ready").body;
    EXPECT_EQ(watched_.get("/ready").status, 200) << "it serves";
    EXPECT_TRUE(answersTo(authority())) << says;
    EXPECT_THAT(watched_.server().log(), HasSubstr(says));
    EXPECT_EQ(watched_.metric("lpv_certificate_failures_total"), ++told);
    putPair(old_);
    EXPECT_TRUE(eventually([&] { return watched_.get("/ready").body == "ok\n"; })) << says;
  }
  putPair(fresh_);
  EXPECT_TRUE(eventually([&] { return answersTo(next_); }));
}

// Clients trust both authorities: each handshake meets a whole pair, old or new. Broken by: gRPC's watcher on the files
// themselves, which are half changed for half of the time here.
TEST_F(ChangingCertificate, NoHandshakeFailsWhileItChanges) {
  const std::string both = authority().write("both.pem", textOf(authority().file()) + textOf(next_.file()));
  std::atomic<bool> done = false;
  std::atomic<int> handshakes = 0;
  std::atomic<int> failed = 0;
  std::thread client([&] {
    for (; !done; ++handshakes)
      failed += int(!connect(watched_.server().address(), {}, {.caFile = both}).serverInfo().ok());
  });
  for (int change = 1; change <= 200; ++change) {
    const CertificateFiles& files = change % 2 == 0 ? old_ : fresh_;
    put(files.certificate, certificate_);
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    put(files.key, key_);
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
  }
  putPair(fresh_);
  EXPECT_TRUE(eventually([&] { return answersTo(next_); }));
  done = true;
  client.join();
  EXPECT_GT(handshakes, 20);
  EXPECT_EQ(failed, 0) << "of " << handshakes;
}

// Broken by: removing nothing; removing the folder of a server that lives.
TEST(PrivateFolder, OfAKilledServerIsRemovedByTheNext) {
  const std::string folder = makeDirectory();
  setenv("RUNTIME_DIRECTORY", folder.c_str(), 1);
  const auto folders = [&] {
    return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
  };
  const CertificateFiles files = authority().issue("kept");
  const std::vector<std::string> arguments{"--tls-cert", files.certificate, "--tls-key", files.key};
  {
    const ServerProcess living(arguments);
    ServerProcess killed(arguments);
    EXPECT_EQ(folders(), 2);
    killed.process().signal(SIGKILL);
    killed.process().wait();
    ServerProcess next(arguments);
    EXPECT_EQ(folders(), 2) << "those that live";
    next.process().signal(SIGTERM);
    EXPECT_EQ(next.process().wait(), 0);
    EXPECT_EQ(folders(), 1);
  }
  unsetenv("RUNTIME_DIRECTORY");
  std::filesystem::remove_all(folder);
}

struct Start {
  std::vector<std::string> arguments;
  std::string says;
};
class RefusedAtStart : public testing::TestWithParam<Start> {};

TEST_P(RefusedAtStart, WithWhatIsWrong) {
  const Finished run = runServer(GetParam().arguments);
  EXPECT_EQ(run.status.value_or(0), 2) << run.errors;
  EXPECT_THAT(run.errors, HasSubstr(GetParam().says));
}

std::vector<Start> starts() {
  const CertificateFiles good = authority().issue("good");
  const CertificateFiles other = authority().issue("other");
  const CertificateFiles expired = authority().issue("expired", -60);
  const std::string admin = authority().write("admin", kAdmin);
  const std::string text = authority().write("text", "no certificate");
  return {
      {{"--listen", "0.0.0.0:0"}, "not a loopback address"},
      {{"--listen", "0.0.0.0:0", "--admin-token-file", admin}, "not a loopback address"},
      {{"--listen", "0.0.0.0:0", "--tls-cert", good.certificate, "--tls-key", good.key}, "--admin-token-file"},
      {{"--tls-cert", good.certificate}, "go together"},
      {{"--tls-client-ca", authority().file()}, "go together"},
      {{"--tls-cert", good.certificate, "--tls-key", other.key}, "not the key of the certificate"},
      {{"--tls-cert", expired.certificate, "--tls-key", expired.key}, "expired"},
      {{"--tls-cert", text, "--tls-key", good.key}, "no PEM file"},
      {{"--tls-cert", good.certificate, "--tls-key", "/nowhere"}, "cannot be read"},
  };
}
INSTANTIATE_TEST_SUITE_P(Door, RefusedAtStart, testing::ValuesIn(starts()));

TEST(RefusedWithoutAnAdminToken, NamesTheFile) {
  const Finished missing = runServer({"--admin-token-file", "/nowhere"});
  EXPECT_NE(missing.status.value_or(0), 0);
  EXPECT_THAT(missing.errors, HasSubstr("--admin-token-file /nowhere"));
  const Finished weak = runServer({"--admin-token-file", authority().write("weak", "hunter2\n")});
  EXPECT_NE(weak.status.value_or(0), 0);
  EXPECT_THAT(weak.errors, HasSubstr("7 bytes, allowed are 16 to 512"));
}

}  // namespace
}  // namespace lpv::rpc
