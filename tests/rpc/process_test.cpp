// lpvd as a process: its exit codes, clients that are killed, and its own end.

#include <gtest/gtest.h>
#include <signal.h>

#include <thread>

#include "rpc/rpc.h"
#include "rpc/server_process.h"

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
  const Finished later = runServer({"--state-dir", "/tmp"});
  EXPECT_EQ(later.status, 2);
  EXPECT_THAT(later.errors, HasSubstr("--state-dir"));
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
    ASSERT_EQ(client.wait(std::chrono::seconds(20)), -SIGKILL);
  }
  pb::GetStatsResponse stats() {
    pb::GetStatsResponse response;
    EXPECT_THAT(stubs_.server->GetStats(Call(), pb::GetStatsRequest(), &response), IsOk());
    return response;
  }

  Stubs stubs_{server().address()};
  std::string session_ = makeLitSession(stubs_);
};

TEST_F(KilledClients, MidUploadLeaveNothing) {
  const std::int64_t before = server().residentBytes();
  for (int i = 0; i < 4; ++i) {
    killInTheMidst("upload", [] { return true; });
  }
  EXPECT_TRUE(eventually([&] { return server().residentBytes() - before < 8 * kMiB * (kSanitized ? 4 : 1); }))
      << "32 MB had arrived; still held are " << (server().residentBytes() - before) / kMiB << " MiB";
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

/// SIGTERM with streams open: health says so first, every stream gets its notice, then the process ends with 0.
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
  EXPECT_EQ(leaving.process().wait(std::chrono::seconds(15)), 0);
}

TEST(Termination, OfAServerWithNothingToDoIsQuick) {
  ServerProcess leaving;
  leaving.process().signal(SIGINT);
  EXPECT_EQ(leaving.process().wait(std::chrono::seconds(15)), 0);
}

}  // namespace
}  // namespace lpv::rpc
