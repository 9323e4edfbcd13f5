// lpvd as a process: its exit codes, clients that are killed, and its own end.

#include <google/protobuf/wrappers.pb.h>
#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>

#include <signal.h>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <thread>

#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using ::testing::HasSubstr;

TEST(CommandLine, RefusesWhatItCannotDo) {
  const Finished device = runServer({"--device", "abacus"});
  EXPECT_EQ(device.status, 2);
  EXPECT_THAT(device.errors, HasSubstr("abacus"));
  const Finished absent = runServer({"--device", "77", "--listen", "127.0.0.1:0"});
  EXPECT_EQ(absent.status, 1) << "a device that is not there";
  EXPECT_THAT(absent.errors, HasSubstr("77"));
  const Finished form = runServer({"--listen", "nowhere"});
  EXPECT_EQ(form.status, 2);
  EXPECT_THAT(form.errors, HasSubstr("HOST:PORT"));
  const Finished open = runServer({"--listen", "0.0.0.0:0"});
  EXPECT_EQ(open.status, 2);
  EXPECT_THAT(open.errors, HasSubstr("--insecure"));
  EXPECT_EQ(runServer({"--no-such-option"}).status, 2);
  EXPECT_EQ(runServer({"--max-sessions", "0"}).status, 2);
  const Finished web = runServer({"--web", "0.0.0.0:0"});
  EXPECT_EQ(web.status, 2);
  EXPECT_THAT(web.errors, testing::AllOf(HasSubstr("--web 0.0.0.0:0"), HasSubstr("--insecure")));
  const Finished origins = runServer({"--web-origins", "light.example.org"});
  EXPECT_EQ(origins.status, 2);
  EXPECT_THAT(origins.errors, HasSubstr("https://light.example.org"));
  const Finished files = runServer({"--listen", "127.0.0.1:0", "--web", ":0", "--web-files", "/nowhere"});
  EXPECT_EQ(files.status, 1);
  EXPECT_THAT(files.errors, HasSubstr("--web-files /nowhere"));
}

TEST(CommandLine, RefusesAPortInUse) {
  const Finished second = runServer({"--listen", server().address()});
  EXPECT_EQ(second.status, 1) << "two servers must not share a port";
  EXPECT_THAT(second.errors, HasSubstr("in use"));
  EXPECT_TRUE(server().running());
}

TEST(CommandLine, PrintsWhatItIsAndHas) {
  const Finished devices = runServer({"--list-devices"});
  EXPECT_EQ(devices.status, 0);
  EXPECT_FALSE(devices.output.empty());
  const Finished config = runServer({"--max-sessions", "7", "--print-config"});
  EXPECT_EQ(config.status, 0);
  EXPECT_THAT(config.output, HasSubstr("max-sessions=7"));
  EXPECT_THAT(config.output, HasSubstr("listen"));
  const Finished version = runServer({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_THAT(version.output, ::testing::MatchesRegex("lpvd [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

/// A configuration file that goes with the test.
class ConfigFile {
 public:
  explicit ConfigFile(const std::string& text) { std::ofstream(path()) << text; }
  ~ConfigFile() { std::filesystem::remove_all(directory_); }
  ConfigFile(const ConfigFile&) = delete;
  ConfigFile& operator=(const ConfigFile&) = delete;
  std::string path() const { return directory_ + "/lpvd.toml"; }

 private:
  const std::string directory_ = makeDirectory();
};

/// A variable of the environment, for a server that is started meanwhile.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) { setenv(name, value, 1); }
  ~Variable() { unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

Finished printedWith(std::vector<std::string> arguments) {
  arguments.push_back("--print-config");
  return runServer(arguments);
}

// admin_token_file = ... started an open server once. Broken by: skipping what is not known, or cannot be read.
TEST(Configuration, WhatIsWrongInAFileIsRefusedWithItsLine) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"max-sessions=1\nadmin-tokenfile=\"x\"\n", ":2: there is no option \"admin-tokenfile\""},
      {"[security]\n", ":1: sections are not taken"},
      {"# fine\n\nmax-sessions 1\n", ":3: \"max-sessions 1\" is not of the form"},
      {"device = auto\n", ":1: the value of device cannot be read"},
      {"device = \"auto\n", ":1: the value of device cannot be read"},
      {"max-lights=1\nmax_lights=2\n", ":2: max-lights is given for the second time"},
      {"max-lights=0\n", ":1: --max-lights"},
      {"version=true\n", ":1: there is no option \"version\""},
  };
  for (const auto& [text, says] : files) {
    const ConfigFile file(text);
    const Finished run = printedWith({"--config", file.path()});
    EXPECT_EQ(run.status, 2) << text;
    EXPECT_THAT(run.errors, HasSubstr(file.path() + says));
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
  }
  EXPECT_THAT(printedWith({"--config", "/nowhere"}).errors, HasSubstr("--config /nowhere: cannot be read"));
}

TEST(Configuration, FlagsWinOverVariablesAndTheseOverTheFile) {
  const ConfigFile file("max_sessions = 1 # of ours\nmax-lights=1\nmax-surfaces=1\n");
  const Variable sessions("LPVD_MAX_SESSIONS", "2");
  const Variable lights("LPVD_MAX_LIGHTS", "2");
  const Finished run = printedWith({"--config", file.path(), "--max_sessions=3"});
  EXPECT_EQ(run.status, 0) << run.errors;
  for (const char* line : {"max-sessions=3\n", "max-lights=2\n", "max-surfaces=1\n"}) {
    EXPECT_THAT(run.output, HasSubstr(line));
  }
  EXPECT_THAT(runServer({"--help"}).output, HasSubstr("A flag wins over"));
}

// Kubernetes makes such for a service "lpvd". Broken by: refusing them; a warning each.
TEST(Configuration, VariablesThatAreNoneOfOursAreNamedOnce) {
  const Variable port("LPVD_PORT", "tcp://10.0.0.1:50051");
  const Variable host("LPVD_SERVICE_HOST", "10.0.0.1");
  const Variable mistyped("LPVD_ADMIN_TOKENFILE", "x");
  const ServerProcess warned;
  const std::string log = warned.log();
  EXPECT_THAT(log, HasSubstr("LPVD_ADMIN_TOKENFILE, LPVD_PORT, LPVD_SERVICE_HOST"));
  EXPECT_EQ(log.find("LPVD_PORT"), log.rfind("LPVD_PORT"));
  const Variable wrong("LPVD_MAX_LIGHTS", "many");
  const Finished run = runServer({});
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.errors, HasSubstr("LPVD_MAX_LIGHTS: --max-lights"));
}

// Broken by: text without quotes; the content of a secret.
TEST(Configuration, WhatIsPrintedIsTakenAgain) {
  const ConfigFile secret("not to be told\n");
  const Finished first =
      printedWith({"--admin-token-file", secret.path(), "--insecure", "--retain", "5d", "--state-dir", "a \"b\" \\c#"});
  ASSERT_EQ(first.status, 0) << first.errors;
  EXPECT_THAT(first.output, HasSubstr("admin-token-file=\"" + secret.path() + "\""));
  EXPECT_EQ(first.output.find("not to be told"), std::string::npos);
  const ConfigFile file(first.output);
  const Finished second = printedWith({"--config", file.path()});
  EXPECT_EQ(second.status, 0) << second.errors;
  EXPECT_EQ(second.output, first.output);
}

TEST(Configuration, AddressesAreReadBeforeAnythingStarts) {
  for (const char* flag : {"--listen", "--ops-listen"}) {
    const Finished run = runServer({flag, "127.0.0.1:99999"});
    EXPECT_EQ(run.status, 2);
    EXPECT_THAT(run.errors, HasSubstr(std::string(flag) + " is \"127.0.0.1:99999\": \"99999\" is no port"));
  }
}

TEST(CommandLine, ListensBeyondTheLoopbackOnlyWhenToldTo) {
  ServerProcess open({"--insecure"}, "0.0.0.0:0");
  Stubs stubs(open.address());
  makeSession(stubs);
  EXPECT_THAT(open.log(), HasSubstr("--insecure"));
}

class KilledClients : public ::testing::Test {
 protected:
  /// A client that does `what` and is there: "ready" has come, and `there` says that the server knows it.
  template <typename Condition>
  void killInTheMidst(const std::string& what, Condition there) {
    ChildProcess client(CHILD_CLIENT_PATH, {server().address(), session_, what});
    ASSERT_TRUE(eventually([&] { return !client.output().empty(); })) << what;
    ASSERT_TRUE(eventually(there)) << what;
    client.signal(SIGKILL);
    ASSERT_EQ(client.wait(), -SIGKILL);
  }
  pb::GetStatsResponse stats() {
    pb::GetStatsResponse response;
    EXPECT_THAT(stubs_.server->GetStats(Call(), pb::GetStatsRequest(), &response), IsOk());
    return response;
  }

  Stubs stubs_{server().address()};
  std::string session_ = makeLitSession(stubs_);
};

// Some uploads before the count begins: what the server allocates once for all uploads, and the heap of each thread
// that had one keeps, is no leak. Nor is what the heap has free: the server gives it back from 16 MiB on, so that a
// quarter of what each client had sent says more than the heap's habits only with a dozen of them.
TEST_F(KilledClients, MidUploadLeaveNothing) {
  constexpr int kClients = 12;  // 8 MB of each arrive
  for (int i = 0; i < 4; ++i) {
    killInTheMidst("upload", [] { return true; });
  }
  const std::int64_t before = server().residentBytes();
  for (int i = 0; i < kClients; ++i) {
    killInTheMidst("upload", [] { return true; });
  }
  EXPECT_TRUE(eventually([&] {
    return server().residentBytes() - before < kClients * 2 * kMiB * (kSanitized ? 4 : 1);
  })) << kClients * 8
      << " MB had arrived; still held are " << (server().residentBytes() - before) / kMiB << " MiB";
  EXPECT_EQ(stats().blobs(), 0);
  EXPECT_THAT(upload(stubs_, session_, pb::BLOB_KIND_MESH, sheet(4).SerializeAsString()), IsOk());
}

TEST_F(KilledClients, MidEditStreamLeaveWholeEdits) {
  killInTheMidst("edits", [&] { return getSession(stubs_, session_).revision() > 20; });
  std::uint64_t settled = 0;
  EXPECT_TRUE(eventually([&] {
    const std::uint64_t now = getSession(stubs_, session_).revision();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    settled = getSession(stubs_, session_).revision();
    return now == settled;
  }));
  // Each edit sets the radiance to its number: the last whole one is what is there.
  EXPECT_DOUBLE_EQ(findLight(stubs_, session_, "Lamp").radiance().x(), double(settled - 1));
  EXPECT_EQ(apply(stubs_, session_, {client::setRadiance("Lamp", {1, 1, 1})}).revision(), settled + 1);
}

TEST_F(KilledClients, MidWatchAreNoSubscribersAnyMore) {
  killInTheMidst("frames", [&] { return getSession(stubs_, session_).subscriber_count() == 1; });
  EXPECT_TRUE(eventually([&] { return getSession(stubs_, session_).subscriber_count() == 0; }));
  killInTheMidst("scene", [] { return true; });
  for (int i = 0; i < 10; ++i) apply(stubs_, session_, {client::setRadiance("Lamp", glm::dvec3(1.0 + i))});
  EXPECT_TRUE(eventually([&] { return stats().subscribers() == 0; }));
  EXPECT_GT(probe(stubs_, session_, {{{0, 0, 0.4}, {0, 0, -1}}})[0].x, 0.0);
}

/// grpc.health.v1.Health/Watch: its messages are, on the wire, a StringValue and an Int32Value.
class HealthWatch {
 public:
  explicit HealthWatch(Stubs& stubs) : stub_(stubs.channel) {
    stream_ = stub_.PrepareCall(call_, "/grpc.health.v1.Health/Watch", &queue_);
    stream_->StartCall(nullptr);
    if (!wait()) return;
    stream_->WriteLast({}, grpc::WriteOptions(), nullptr);  // of everything, the service ""
    (void)wait();
  }
  ~HealthWatch() {
    call_->TryCancel();
    grpc::Status status;
    stream_->Finish(&status, nullptr);
    (void)wait();
    queue_.Shutdown();
    while (wait()) {
    }
  }
  HealthWatch(const HealthWatch&) = delete;
  HealthWatch& operator=(const HealthWatch&) = delete;

  /// The next state: 1 = SERVING, 2 = NOT_SERVING; -1 at the end.
  int next() {
    google::protobuf::Int32Value state;
    stream_->Read(&state, nullptr);
    return wait() ? state.value() : -1;
  }

 private:
  using Text = google::protobuf::StringValue;
  using Number = google::protobuf::Int32Value;

  bool wait() {
    void* tag = nullptr;
    bool ok = false;
    return queue_.Next(&tag, &ok) && ok;
  }

  grpc::TemplatedGenericStub<Text, Number> stub_;
  grpc::CompletionQueue queue_;
  Call call_;
  std::unique_ptr<grpc::ClientAsyncReaderWriter<Text, Number>> stream_;
};

/// A watcher of a scene, its snapshot read.
struct SceneWatcher {
  SceneWatcher(Stubs& stubs, const std::string& session) {
    pb::WatchSceneRequest request;
    request.set_session(session);
    reader = stubs.scene->WatchScene(call, request);
    EXPECT_TRUE(reader->Read(&event));
  }
  /// Reads on to the notice.
  void readNotice() {
    while (!event.has_notice() && reader->Read(&event)) {
    }
    EXPECT_EQ(event.notice().kind(), pb::Notice::KIND_DRAINING);
  }
  Call call;
  pb::WatchSceneResponse event;
  std::unique_ptr<grpc::ClientReader<pb::WatchSceneResponse>> reader;
};

/// Who has its notice and asks for health at once must not be sent here again. Many watchers keep the server busy
/// with notices meanwhile. Seen to fail when the streams are told before the health service.
TEST(Termination, SaysThatItDoesNotServeBeforeItTellsItsStreams) {
  constexpr int kConnections = 5;
  constexpr int kWatchersEach = 80;  // of at most 100 streams on a connection
  ServerProcess leaving;
  Stubs stubs(leaving.address());
  pb::CreateSessionRequest first;
  first.set_session_id("a");  // sessions end in the order of their ids
  pb::CreateSessionResponse created;
  ASSERT_THAT(stubs.session->CreateSession(Call(), first, &created), IsOk());
  const std::string others = makeSession(stubs);
  std::vector<std::unique_ptr<Stubs>> connections;
  std::vector<std::unique_ptr<SceneWatcher>> crowd;
  for (int c = 0; c < kConnections; ++c) {
    connections.push_back(std::make_unique<Stubs>(leaving.address()));
    for (int w = 0; w < kWatchersEach; ++w) crowd.push_back(std::make_unique<SceneWatcher>(*connections[c], others));
  }
  SceneWatcher watcher(stubs, "sessions/a");
  auto health = std::make_unique<HealthWatch>(stubs);
  ASSERT_EQ(health->next(), 1);
  client::Client asking = clientOf(leaving.address());
  ASSERT_TRUE(asking.healthy().ok());

  leaving.process().signal(SIGTERM);
  watcher.readNotice();
  const Expected<bool> healthy = asking.healthy();
  EXPECT_FALSE(healthy.ok() && *healthy) << "its notice came first";
  EXPECT_EQ(health->next(), 2);
  health.reset();
  for (const auto& each : crowd) each->readNotice();
  EXPECT_EQ(leaving.process().wait(), 0);
}

/// SIGTERM with streams open: every stream gets its notice, then the process ends with 0.
TEST(Termination, DrainsItsStreams) {
  ServerProcess leaving;
  Stubs stubs(leaving.address());
  const std::string session = makeLitSession(stubs);
  pb::WatchSceneRequest watchScene;
  watchScene.set_session(session);
  Call sceneCall;
  const auto scene = stubs.scene->WatchScene(sceneCall, watchScene);
  pb::WatchSceneResponse sceneEvent;
  ASSERT_TRUE(scene->Read(&sceneEvent));
  pb::WatchVolumeRequest watchVolume;
  watchVolume.mutable_subscription()->set_session(session);
  Call volumeCall;
  const auto volume = stubs.result->WatchVolume(volumeCall, watchVolume);
  pb::WatchVolumeResponse volumeEvent;
  ASSERT_TRUE(volume->Read(&volumeEvent));
  Call editCall;
  const auto edits = stubs.scene->StreamEdits(editCall);
  pb::StreamEditsRequest edit;
  edit.set_session(session);
  *edit.mutable_edit() = client::editOf({client::setRadiance("Lamp", {2, 2, 2})});
  ASSERT_TRUE(edits->Write(edit));
  pb::StreamEditsResponse ack;
  ASSERT_TRUE(edits->Read(&ack));

  leaving.process().signal(SIGTERM);
  pb::Notice noticed;
  while (scene->Read(&sceneEvent)) {
    if (sceneEvent.has_notice()) noticed = sceneEvent.notice();
  }
  EXPECT_EQ(noticed.kind(), pb::Notice::KIND_DRAINING);
  EXPECT_THAT(scene->Finish(), HasCode(StatusCode::UNAVAILABLE));
  noticed.Clear();
  while (volume->Read(&volumeEvent)) {
    if (volumeEvent.event().has_notice()) noticed = volumeEvent.event().notice();
  }
  EXPECT_EQ(noticed.kind(), pb::Notice::KIND_DRAINING);
  EXPECT_THAT(volume->Finish(), HasCode(StatusCode::UNAVAILABLE));
  noticed.Clear();
  while (edits->Read(&ack)) {
    if (ack.has_notice()) noticed = ack.notice();
  }
  EXPECT_EQ(noticed.kind(), pb::Notice::KIND_DRAINING);
  EXPECT_THAT(edits->Finish(), HasCode(StatusCode::UNAVAILABLE));
  EXPECT_EQ(leaving.process().wait(), 0);
}

TEST(Termination, OfAServerWithNothingToDoIsQuick) {
  ServerProcess leaving;
  leaving.process().signal(SIGINT);
  EXPECT_EQ(leaving.process().wait(), 0);
}

}  // namespace
}  // namespace lpv::rpc
