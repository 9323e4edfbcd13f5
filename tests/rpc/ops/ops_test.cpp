// What those see who run the server besides its metrics: health, log, audit log, and what signals do.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "rpc/streams/seen.h"
#include "rpc/streams/watched.h"
#include "rpc/support/http2_client.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kTrace = "4bf92f3577b34da6a3ce929d0e0e4736";
constexpr const char* kTraceparent = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";

TEST(Endpoint, AnswersNothingElse) {
  const Watched watched;
  EXPECT_EQ(watched.get("/live").body, "ok\n");
  EXPECT_EQ(watched.get("/ready").body, "ok\n");
  EXPECT_EQ(watched.get("/").status, 404);
  EXPECT_EQ(watched.get("/live/on").status, 404);
  EXPECT_EQ(watched.get("/../../../../etc/passwd").status / 100, 4);
}

/// Connections that are open and say nothing.
class Idle {
 public:
  Idle(int port, int count) {
    for (int i = 0; i < count; ++i) {
      sockets_.push_back(::socket(AF_INET, SOCK_STREAM, 0));
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_port = htons(std::uint16_t(port));
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      EXPECT_EQ(connect(sockets_.back(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    }
  }
  ~Idle() {
    for (const int socket : sockets_) close(socket);
  }
  Idle(const Idle&) = delete;
  Idle& operator=(const Idle&) = delete;

 private:
  std::vector<int> sockets_;
};

// More than the endpoint lets be open. Broken by: civetweb, whose four
// threads waited for the first four of these.
TEST(Endpoint, IdleConnectionsDoNotDelayLiveness) {
  const Watched watched;
  const Idle few(watched.port(), 16);
  EXPECT_EQ(watched.get("/live").body, "ok\n");
  const Idle many(watched.port(), 600);
  EXPECT_EQ(watched.get("/live").body, "ok\n");
  EXPECT_EQ(watched.get("/metrics").status, 200);
}

TEST(Endpoint, IsOnTheLoopbackUnlessToldOtherwise) {
  Watched usual;
  EXPECT_THAT(usual.server().log(), AllOf(HasSubstr("/metrics on 127.0.0.1:0"), Not(HasSubstr("without a token"))));
  ServerProcess open({"--ops-listen", "0.0.0.0:0"});
  EXPECT_THAT(open.log(), HasSubstr("--ops-listen 0.0.0.0:0: whoever reaches it reads health and metrics"));
  const Finished form = runServer({"--ops-listen", "nowhere"});
  EXPECT_EQ(form.status, 2);
  EXPECT_THAT(form.errors, HasSubstr("HOST:PORT"));
  const Finished taken = runServer({"--listen", "127.0.0.1:0", "--ops-listen", server().address()});
  EXPECT_EQ(taken.status, 1);
  EXPECT_THAT(taken.errors, AllOf(HasSubstr("--ops-listen"), HasSubstr("in use")));
}

TEST(Readiness, EndsWhereTheDiskIsFullAndComesBack) {
  const std::string state = makeDirectory();
  Watched watched({"--state-dir", state});
  Stubs stubs(watched.server().address());
  const std::string session = makeLitSession(stubs);
  EXPECT_EQ(watched.metric("lpv_sessions_kept"), 1);
  EXPECT_EQ(watched.metric("lpv_store_writable"), 1);
  EXPECT_GT(watched.metric("lpv_store_commit_seconds_count"), 0);
  EXPECT_EQ(watched.metric("lpv_store_failures_total"), 0);
  EXPECT_EQ(watched.metric("lpv_store_queued_changes"), 0);
  ASSERT_EQ(watched.get("/ready").status, 200);

  rlimit before{};
  const auto bytes = std::filesystem::file_size(state + "/sessions.db-wal");
  const pid_t pid = watched.server().process().pid();
  ASSERT_EQ(prlimit(pid, RLIMIT_FSIZE, nullptr, &before), 0);
  const rlimit full{rlim_t(bytes), before.rlim_max};
  ASSERT_EQ(prlimit(pid, RLIMIT_FSIZE, &full, nullptr), 0);
  const pb::Edit edit = client::editOf({client::setRadiance("Lamp", {2, 2, 2})});
  ASSERT_THAT(tryEdit(stubs, session, edit), HasCode(StatusCode::UNAVAILABLE));
  const HttpAnswer failed = watched.get("/ready");
  EXPECT_EQ(failed.status, 503);
  EXPECT_THAT(failed.body, AllOf(HasSubstr("state directory"), HasSubstr(state)));
  EXPECT_EQ(watched.get("/live").status, 200) << "another process would find the same disk";
  EXPECT_EQ(watched.metric("lpv_store_writable"), 0);
  EXPECT_GT(watched.metric("lpv_store_failures_total"), 0);
  EXPECT_GT(watched.metric("lpv_store_queued_changes"), 0);

  ASSERT_EQ(prlimit(pid, RLIMIT_FSIZE, &before, nullptr), 0);
  EXPECT_TRUE(eventually([&] { return watched.get("/ready").status == 200; }));
  EXPECT_EQ(watched.metric("lpv_store_queued_changes"), 0);
  std::error_code ignored;
  std::filesystem::remove_all(state, ignored);
}

/// A call that goes on as long as it likes, and keeps the server from ending until its patience is over. What it writes
/// is larger than the window of a stream that the server does not know yet: it is there.
class OpenImport {
 public:
  explicit OpenImport(Stubs& stubs) : writer_(stubs.session->ImportSession(call_, &response_)) {
    pb::ImportSessionRequest part;
    part.set_data(std::string(1000 * 1000, 'x'));
    EXPECT_TRUE(writer_->Write(part));
  }
  ~OpenImport() {
    call_->TryCancel();
    (void)writer_->Finish();
  }
  OpenImport(const OpenImport&) = delete;
  OpenImport& operator=(const OpenImport&) = delete;

 private:
  Call call_;
  pb::ImportSessionResponse response_;
  std::unique_ptr<grpc::ClientWriter<pb::ImportSessionRequest>> writer_;
};

bool draining(const Watched& watched) {
  const HttpAnswer answer = watched.get("/ready");
  return answer.status == 503 && answer.body == "draining\n";
}

TEST(Signals, TermEndsReadinessBeforeTheProcess) {
  Watched watched;
  Stubs stubs(watched.server().address());
  {
    const OpenImport import(stubs);
    watched.server().process().signal(SIGTERM);
    EXPECT_TRUE(eventually([&] { return draining(watched); }));
    EXPECT_EQ(watched.get("/live").status, 200) << "it is not to be killed";
    EXPECT_GE(watched.metric("process_open_fds"), 0) << "to the end";
  }
  EXPECT_EQ(watched.server().process().wait(), 0);
}

TEST(Signals, ASecondOneEndsAtOnce) {
  for (const int signal : {SIGTERM, SIGINT}) {
    Watched watched;
    Stubs stubs(watched.server().address());
    const OpenImport import(stubs);
    watched.server().process().signal(SIGTERM);
    ASSERT_TRUE(eventually([&] { return draining(watched); }));
    watched.server().process().signal(signal);
    EXPECT_EQ(watched.server().process().wait(), -signal);
  }
}

TEST(Signals, HupEndsNothing) {
  Watched watched;
  for (int i = 1; i <= 2; ++i) {
    watched.server().process().signal(SIGHUP);
    ASSERT_TRUE(eventually([&] {
      const auto lines = linesOf(watched.server().log());
      return std::count_if(lines.begin(), lines.end(), [](const auto& l) { return l.find("SIGHUP") != l.npos; }) == i;
    }));
  }
  EXPECT_EQ(watched.get("/ready").status, 200);
}

/// What a server is configured with, in a file that changes.
class ReloadedLimits : public ::testing::Test {
 protected:
  ~ReloadedLimits() override { std::filesystem::remove_all(directory_); }
  void write(const std::string& text) const { std::ofstream(directory_ + "/lpvd.toml") << text; }
  /// What the file says is taken up, or is said not to be.
  bool reload(const std::string& said) {
    server_->process().signal(SIGHUP);
    return eventually([&] { return server_->log().find(said) != std::string::npos; });
  }
  void start(const std::string& text, std::vector<std::string> flags = {}) {
    write(text);
    flags.insert(flags.end(), {"--config", directory_ + "/lpvd.toml"});
    server_ = std::make_unique<ServerProcess>(flags);
    stubs_ = std::make_unique<Stubs>(server_->address());
  }
  grpc::Status create() {
    pb::CreateSessionRequest request;
    pb::CreateSessionResponse response;
    return stubs_->session->CreateSession(Call(), request, &response);
  }

  const std::string directory_ = makeDirectory();
  std::unique_ptr<ServerProcess> server_;
  std::unique_ptr<Stubs> stubs_;
};

// Of sessions that live and of those to come, and of what calls are checked by; streams go on. Broken by: not reading
// the file again; not telling the registry; not telling its sessions; calls with the limits of the start.
TEST_F(ReloadedLimits, AreTakenUpOnHangup) {
  start("max-sessions=2\nmax-lights=1\n");
  const std::string session = makeLitSession(*stubs_);
  pb::WatchVolumeRequest watch;
  watch.mutable_subscription()->set_session(session);
  Call call;
  const auto reader = stubs_->result->WatchVolume(call, watch);
  Seen<pb::WatchVolumeResponse> seen;
  ASSERT_TRUE(seen.next(*reader));
  const auto addLight = [&](const std::string& name) {
    return tryEdit(*stubs_, session, client::editOf({client::createLight(light(name))}));
  };
  EXPECT_THAT(addLight("Second").error_message(), HasSubstr("allowed are 1"));
  write("max-sessions=1\nmax-lights=2\n");
  ASSERT_TRUE(reload("--max-lights 1 -> 2"));
  EXPECT_NE(server_->log().find("--max-sessions 2 -> 1"), std::string::npos);
  EXPECT_TRUE(eventually([&] { return addLight("Second").ok(); }));
  EXPECT_THAT(create(), Refused(StatusCode::RESOURCE_EXHAUSTED, "max_sessions", "allowed are 1"));
  pb::GetServerInfoRequest ask;
  pb::GetServerInfoResponse info;
  ASSERT_THAT(stubs_->server->GetServerInfo(Call(), ask, &info), IsOk());
  EXPECT_EQ(info.limits().max_lights(), 2);
  seen.waitHeartbeats(*reader, 1);  // the stream goes on
  call->TryCancel();
}

// Broken by: taking for read what was not; a file that is wrong in one line changing another.
TEST_F(ReloadedLimits, WhatCannotChangeIsNamedAndWhatIsWrongChangesNothing) {
  start("max-sessions=1\nmax-lights=5\n", {"--max-lights", "7"});
  write("max-sessions=3\nmax-lights=6\nretain=\"5d\"\nlisten=\"127.0.0.1:1\"\n");
  ASSERT_TRUE(reload("--max-sessions 1 -> 3"));
  EXPECT_TRUE(eventually([&] { return server_->log().find("--retain has changed") != std::string::npos; }));
  EXPECT_EQ(server_->log().find("--max-lights"), std::string::npos) << "a flag wins over the file, now as before";
  EXPECT_EQ(server_->log().find("--listen has changed"), std::string::npos) << "likewise";
  EXPECT_THAT(create(), IsOk());
  write("max-sessions=\"many\"\n");
  ASSERT_TRUE(reload("the limits stay as they were"));
  EXPECT_THAT(create(), IsOk());
}

// Too dear a session, refused by what the device was measured to take.
TEST_F(ReloadedLimits, BoundWhatATickMayTake) {
  start("max-tick-seconds=30\n");
  EXPECT_THAT(create(), IsOk());
  write("max-tick-seconds=0.001\n");
  ASSERT_TRUE(reload("--max-tick-seconds 30 -> 0.001"));
  pb::CreateSessionRequest request;
  *request.mutable_settings() = propagating(settings(128));
  pb::CreateSessionResponse response;
  EXPECT_THAT(stubs_->session->CreateSession(Call(), request, &response),
              Refused(StatusCode::RESOURCE_EXHAUSTED, "max_tick_seconds", "predicted to take"));
}

/// Logs as JSON, and of what is no audit line only warnings.
class AuditLog : public ::testing::Test {
 protected:
  AuditLog() : server_({"--log-format", "json", "--log-level", "warn", "--max-sessions", "1"}) {}

  /// Every line that is an object; none may be broken.
  std::vector<json> events(const std::string& name) {
    std::vector<json> out;
    for (const std::string& line : linesOf(server_.log())) {
      if (!line.starts_with("{")) continue;
      const json event = json::parse(line, nullptr, false);
      EXPECT_FALSE(event.is_discarded()) << line;
      if (event.value("event", "") == name) out.push_back(event);
    }
    return out;
  }
  grpc::Status create(const std::string& id, const std::vector<std::string>& traceparents) {
    Call call;
    for (const std::string& header : traceparents) call->AddMetadata("traceparent", header);
    pb::CreateSessionRequest request;
    request.set_session_id(id);
    pb::CreateSessionResponse response;
    return stubs_.session->CreateSession(call, request, &response);
  }
  grpc::Status remove(const std::string& id) {
    pb::DeleteSessionRequest request;
    request.set_name("sessions/" + id);
    pb::DeleteSessionResponse response;
    return stubs_.session->DeleteSession(Call(), request, &response);
  }

  ServerProcess server_;
  Stubs stubs_{server_.address()};
};

TEST_F(AuditLog, HasWhoMadeAndRemovedWhat) {
  ASSERT_THAT(create("room", {kTraceparent}), IsOk());
  ASSERT_THAT(remove("room"), IsOk());
  const auto created = events("create");
  ASSERT_EQ(created.size(), 1U);
  EXPECT_EQ(created[0]["logger"], "audit");
  EXPECT_EQ(created[0]["level"], "info");
  EXPECT_EQ(created[0]["session"], "room");
  EXPECT_EQ(created[0]["trace"], kTrace);
  EXPECT_THAT(created[0]["peer"].get<std::string>(), ::testing::StartsWith("ipv4:127.0.0.1:"));
  const auto deleted = events("delete");
  ASSERT_EQ(deleted.size(), 1U);
  EXPECT_EQ(deleted[0]["session"], "room");
  EXPECT_FALSE(deleted[0].contains("trace")) << "none was sent";
}

TEST_F(AuditLog, HasASessionsOwnNameAndAnImport) {
  const std::string session = makeSession(stubs_);
  ASSERT_EQ(events("create").size(), 1U);
  EXPECT_EQ("sessions/" + events("create")[0]["session"].get<std::string>(), session);
  auto client = clientOf(server_.address());
  std::string file;
  ASSERT_TRUE(client
                  .exportSession(session,
                                 [&file](const std::string& part) {
                                   file += part;
                                   return true;
                                 })
                  .ok());
  ASSERT_THAT(remove(session.substr(session.find('/') + 1)), IsOk());
  Call call;
  pb::ImportSessionResponse imported;
  const auto writer = stubs_.session->ImportSession(call, &imported);
  pb::ImportSessionRequest part;
  part.set_session_id("copy");
  part.set_data(file);
  writer->Write(part);
  writer->WritesDone();
  ASSERT_THAT(writer->Finish(), IsOk());
  ASSERT_EQ(events("import").size(), 1U);
  EXPECT_EQ(events("import")[0]["session"], "copy");
}

TEST_F(AuditLog, IgnoresMalformedTraces) {
  ASSERT_THAT(create("room", {"00-4bf92f3577b34da6a3ce929d0e0e4736-0000000000000000-01"}), IsOk());
  ASSERT_THAT(remove("room"), IsOk());
  ASSERT_THAT(create("hall", {kTraceparent, kTraceparent}), IsOk());
  const auto created = events("create");
  ASSERT_EQ(created.size(), 2U);
  EXPECT_FALSE(created[0].contains("trace"));
  EXPECT_FALSE(created[1].contains("trace")) << "two are as good as none";
}

TEST_F(AuditLog, HasWhoWasRefusedAndWhy) {
  ASSERT_THAT(create("room", {}), IsOk());
  ASSERT_THAT(create("hall", {kTraceparent}), HasCode(StatusCode::RESOURCE_EXHAUSTED));
  const std::string hostile = "a\"}\n{\"event\":\"delete\"}\x7f";
  ASSERT_THAT(create(hostile, {}), HasCode(StatusCode::INVALID_ARGUMENT));
  ASSERT_THAT(remove("nowhere"), HasCode(StatusCode::NOT_FOUND));
  const auto refused = events("refusal");
  ASSERT_EQ(refused.size(), 3U);
  EXPECT_EQ(refused[0]["method"], "CreateSession");
  EXPECT_EQ(refused[0]["reason"], "max_sessions");
  EXPECT_EQ(refused[0]["session"], "hall");
  EXPECT_EQ(refused[0]["trace"], kTrace);
  EXPECT_EQ(refused[1]["session"], hostile);
  EXPECT_EQ(refused[1]["reason"], "invalid_argument");
  EXPECT_EQ(refused[2]["method"], "DeleteSession");
  EXPECT_EQ(refused[2]["reason"], "not_found");
  EXPECT_TRUE(events("delete").empty());
}

TEST_F(AuditLog, HasSessionsThatExpire) {
  pb::SessionSettings idle = settings();
  idle.mutable_ttl()->set_seconds(1);
  const std::string session = makeSession(stubs_, idle);
  ASSERT_TRUE(eventually([&] { return !events("expire").empty(); }));
  EXPECT_EQ("sessions/" + events("expire")[0]["session"].get<std::string>(), session);
}

TEST(Log, OfCallsNamesSessionAndTrace) {
  ServerProcess server({"--log-level", "debug"});
  Stubs stubs(server.address());
  const std::string session = makeSession(stubs);
  Call call;
  call->AddMetadata("traceparent", kTraceparent);
  pb::JoinSessionRequest request;
  request.set_session(session);
  pb::JoinSessionResponse response;
  ASSERT_THAT(stubs.session->JoinSession(call, request, &response), IsOk());
  const std::string id = session.substr(session.find('/') + 1);
  EXPECT_THAT(linesOf(server.log()), Contains(HasSubstr("JoinSession: ok session=" + id + " trace=" + kTrace)));
}

/// Calls whose headers gRPC complains about, a line each.
void sendBadHeaders(int port, int count) {
  for (int i = 0; i < count; ++i)
    (void)rawCall(port, "/lpv.v1.ServerService/GetServerInfo", {{"grpc-timeout", "soon"}}, framed(false, ""));
}

// Broken by: the library's lines as they come, 34,000 raw ones in 5 s among lines of JSON.
TEST(Log, OfWhatStrangersSendIsBoundedAndAsConfigured) {
  ServerProcess server({"--log-format", "json", "--log-level", "warn"});
  sendBadHeaders(server.port(), 60);
  const auto lines = linesOf(server.log());
  EXPECT_LE(lines.size(), 40U);
  int complaints = 0;
  for (const std::string& line : lines) {
    const json event = json::parse(line, nullptr, false);
    ASSERT_FALSE(event.is_discarded()) << line;
    if (event["message"].get<std::string>().find("grpc-timeout") == std::string::npos) continue;
    ++complaints;
    EXPECT_EQ(event["level"], "warning");
    EXPECT_THAT(event["message"], ::testing::StartsWith("gRPC: "));
  }
  EXPECT_GT(complaints, 0) << "they are told of";
}

TEST(Log, RefusesUnknownFormats) {
  const Finished finished = runServer({"--log-format", "xml"});
  EXPECT_EQ(finished.status, 2);
  EXPECT_THAT(finished.errors, HasSubstr("text, json"));
}

}  // namespace
}  // namespace lpv::rpc
