// The client library's streams against a real server: edits, watchers, credit, latency, reopening.

#include <gmock/gmock.h>
#include <signal.h>

#include <atomic>
#include <mutex>

#include "lpv/blobs.h"
#include "lpv/convert.h"
#include "lpv/editor.h"
#include "lpv/edits.h"
#include "lpv/watch.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"
#include "scene/lookup.h"

namespace lpv::client {
namespace {

using namespace std::chrono_literals;
using rpc::eventually;

Mesh square() {
  Mesh mesh;
  mesh.positions = {{-0.25F, 0, -0.25F}, {0.25F, 0, -0.25F}, {0.25F, 0, 0.25F}, {-0.25F, 0, 0.25F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

v1::Light lampOf(const BlobHash& mesh) {
  v1::Light light;
  light.set_name("Lamp");
  light.set_mesh(mesh);
  return light;
}

v1::Edit moveTo(double y) { return editOf({moveLight("Lamp", {.translation = glm::dvec3(0, y, 0)})}); }

/// A session of 8^3 cells with one lamp, edited by one member.
struct Room {
  explicit Room(rpc::ServerProcess& server) : client(rpc::clientOf(server.address())) {
    v1::CreateSessionRequest request;
    *request.mutable_settings() = rpc::settings();
    session = client.createSession(request)->session().name();
    editor = std::make_unique<Editor>(*Editor::join(client, session, "test"));
    const Expected<BlobHash> mesh = upload(client, session, square());
    EXPECT_TRUE(mesh.ok()) << mesh.status().message();
    const auto ack = editor->apply(editOf({createLight(lampOf(*mesh))}));
    EXPECT_TRUE(ack.ok()) << ack.status().message();
  }
  v1::VolumeSubscription volumes() const {
    v1::VolumeSubscription subscription;
    subscription.set_session(session);
    *subscription.mutable_client() = editor->identity();
    return subscription;
  }
  v1::FrameSubscription frames() const {
    v1::FrameSubscription subscription;
    subscription.set_session(session);
    *subscription.mutable_client() = editor->identity();
    subscription.set_width(64);
    subscription.set_height(48);
    return subscription;
  }
  Client client;
  std::string session;
  std::unique_ptr<Editor> editor;
};

TEST(Library, UploadsEachContentOnce) {
  Room room(rpc::server());
  std::uint64_t sent = 0;
  const auto progress = [&](std::uint64_t done, std::uint64_t) { sent = done; };
  EXPECT_TRUE(upload(room.client, room.session, square(), progress).ok());
  EXPECT_EQ(sent, 0U);
  Mesh big = square();
  big.positions.resize(200000);
  const Blob blob = blobOf(big);
  EXPECT_EQ(*upload(room.client, room.session, big, progress), blob.hash);
  EXPECT_EQ(sent, blob.bytes.size());
  EXPECT_GT(sent, 2U << 20U);
  ASSERT_TRUE(room.editor->apply(editOf({createLight(lampOf(blob.hash))})).ok());
  const Expected<std::string> back = room.client.readBlob(room.session, blob.hash);
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_TRUE(*back == blob.bytes);
}

TEST(Library, RefusedEditsAreErrorsAndTheStreamGoesOn) {
  Room room(rpc::server());
  std::vector<int> codes;
  EditStream stream(*room.editor, [&](const v1::EditAck& ack) { codes.push_back(ack.status().code()); });
  ASSERT_TRUE(stream.send(moveTo(0.1)).ok());
  ASSERT_TRUE(stream.send(editOf({deleteLight("Nobody")})).ok());
  ASSERT_TRUE(stream.send(moveTo(0.2)).ok());
  ASSERT_TRUE(stream.drain(20s).ok());
  stream.stop();
  EXPECT_THAT(codes, testing::ElementsAre(0, int(Code::kNotFound), 0));
  EXPECT_EQ(stream.send(moveTo(0)).status().code(), Code::kCancelled);
  const auto refused = room.editor->apply(editOf({deleteLight("Nobody")}));
  EXPECT_EQ(refused.status().code(), Code::kNotFound);
  EXPECT_THAT(refused.status().field(), testing::HasSubstr("delete_light"));
}

TEST(Library, WatchersSeeEditsAndMeasureThem) {
  Room room(rpc::server());
  const auto latency = std::make_shared<LatencyLog>();
  std::atomic<std::uint64_t> volumeRevision = 0;
  std::atomic<std::uint64_t> frameRevision = 0;
  VolumeWatcher volumes(room.client, room.volumes(), [&](const VolumeResult& result) {
    EXPECT_GE(result.header.result().revision(), volumeRevision);
    volumeRevision = result.header.result().revision();
  });
  WatchHooks hooks;
  hooks.latency = latency;
  FrameWatcher frames(
      room.client, room.frames(),
      [&](const FrameResult& result) {
        EXPECT_EQ(result.header.width(), 64);
        frameRevision = result.header.result().revision();
      },
      hooks);
  ASSERT_TRUE(eventually([&] { return volumeRevision == 1 && frameRevision == 1; }));
  EditStream edits(*room.editor, {}, {}, latency);
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(edits.send(moveTo(0.02 * i)).ok());
    std::this_thread::sleep_for(10ms);
  }
  ASSERT_TRUE(edits.drain(20s).ok());
  EXPECT_TRUE(eventually([&] { return volumeRevision == 21 && frameRevision == 21; }));
  EXPECT_TRUE(eventually([&] { return latency->summary().count == 20; }));
  EXPECT_GT(latency->summary().p50, 0.0);
  EXPECT_LE(latency->summary().p50, latency->summary().max);
  EXPECT_EQ(volumes.stats().faults + frames.stats().faults + frames.stats().discarded, 0U);
  EXPECT_GT(volumes.stats().bytes, 0U);
}

TEST(Library, AMovedCameraCausesAFrame) {
  Room room(rpc::server());
  std::atomic<std::uint64_t> shown = 0;
  FrameWatcher frames(room.client, room.frames(),
                      [&](const FrameResult& result) { shown = result.header.camera_sequence(); });
  Camera camera;
  std::uint64_t sequence = 0;
  for (int i = 1; i <= 3; ++i) {
    camera.eye = {0, 0.5 * i, 3};
    sequence = frames.setCamera(toProto(camera));
  }
  EXPECT_TRUE(eventually([&] { return shown == sequence; })) << shown;
}

TEST(Library, ADownloadedVolumeAnswersAsTheServerDoes) {
  Room room(rpc::server());
  v1::GetVolumeRequest request;
  request.set_session(room.session);
  request.set_format(v1::VOLUME_FORMAT_FLOAT);
  const auto volume = room.client.volume(request);
  ASSERT_TRUE(volume.ok()) << volume.status().message();
  const SurfacePoint point{{0.1, -0.4, 0.2}, {0, 1, 0}};
  const auto probe = room.client.probe(room.session, {point}, {.volumeOnly = true});
  ASSERT_TRUE(probe.ok()) << probe.status().message();
  const Irradiance here = irradianceAt(volume->volume, Lookup::kCap, point.position, point.normal);
  EXPECT_TRUE(here.valid);
  EXPECT_NEAR(here.rgb.x, probe->irradiance[0].rgb.x, 1e-5 * here.rgb.x);
  EXPECT_GT(here.rgb.x, 0.0);
}

TEST(Library, SceneWatcherTellsEveryChange) {
  Room room(rpc::server());
  std::mutex mutex;
  std::vector<std::uint64_t> revisions;
  SceneWatcher watcher(room.client, room.session, 0, [&](const v1::WatchSceneResponse& event) {
    const std::lock_guard lock(mutex);
    if (event.has_snapshot()) revisions.push_back(event.snapshot().revision());
    if (event.has_change()) revisions.push_back(event.change().last_revision());
  });
  const auto last = [&] {
    const std::lock_guard lock(mutex);
    return revisions.empty() ? 0 : revisions.back();
  };
  ASSERT_TRUE(eventually([&] { return last() == 1; }));
  ASSERT_TRUE(room.editor->apply(moveTo(0.3)).ok());
  EXPECT_TRUE(eventually([&] { return last() == 2; }));
}

TEST(Library, ASilentServerIsLeftAndFoundAgain) {
  rpc::ServerProcess server;
  Room room(server);
  std::atomic<std::uint64_t> revision = 0;
  std::atomic<int> reopening = 0;
  std::atomic<bool> ended = false;
  WatchHooks hooks;
  hooks.reopening = [&](const Status&) { ++reopening; };
  hooks.ended = [&](const Status&) { ended = true; };
  VolumeWatcher volumes(
      room.client, room.volumes(), [&](const VolumeResult& result) { revision = result.header.result().revision(); },
      hooks);
  ASSERT_TRUE(eventually([&] { return revision == 1; }));
  EditStream edits(*room.editor);
  server.process().signal(SIGSTOP);
  ASSERT_TRUE(edits.send(moveTo(0.3)).ok());
  EXPECT_TRUE(eventually([&] { return reopening >= 1; }));  // nothing for 3 s
  server.process().signal(SIGCONT);
  EXPECT_TRUE(edits.drain(20s).ok());
  EXPECT_TRUE(eventually([&] { return revision == 2; }));  // applied once, however often it was sent
  // The edit may have been applied before the signal stopped the server: then the stream is reopened after its result.
  EXPECT_TRUE(eventually([&] { return volumes.stats().reopened >= 1U; }));
  EXPECT_FALSE(ended);
}

TEST(Library, WatchersEndWhereReopeningCannotHelp) {
  Room room(rpc::server());
  std::atomic<int> ends = 0;
  WatchHooks hooks;
  hooks.ended = [&](const Status& status) {
    EXPECT_NE(status.code(), Code::kOk);
    ++ends;
  };
  v1::VolumeSubscription nowhere;
  nowhere.set_session("nosuch");
  VolumeWatcher lost(room.client, nowhere, {}, hooks);
  EXPECT_TRUE(eventually([&] { return ends == 1; }));
  VolumeWatcher volumes(room.client, room.volumes(), {}, hooks);
  ASSERT_TRUE(eventually([&] { return volumes.stats().results == 1; }));
  ASSERT_TRUE(room.client.deleteSession(room.session).ok());
  EXPECT_TRUE(eventually([&] { return ends == 2; }));
}

TEST(Library, CancelEndsCallsAndStreams) {
  Room room(rpc::server());
  Client other = rpc::clientOf(rpc::server().address());
  std::atomic<bool> ended = false;
  WatchHooks hooks;
  hooks.ended = [&](const Status&) { ended = true; };
  VolumeWatcher volumes(other, room.volumes(), {}, hooks);
  ASSERT_TRUE(eventually([&] { return volumes.stats().results == 1; }));
  other.cancel();
  EXPECT_TRUE(eventually([&] { return ended.load(); }));
  EXPECT_EQ(other.stats().status().code(), Code::kCancelled);
  EXPECT_TRUE(room.client.stats().ok());
}

TEST(Library, StopFromACallback) {
  Room room(rpc::server());
  std::unique_ptr<VolumeWatcher> watcher;
  std::atomic<bool> stopped = false;
  std::mutex made;
  {
    const std::lock_guard lock(made);
    watcher = std::make_unique<VolumeWatcher>(room.client, room.volumes(), [&](const VolumeResult&) {
      const std::lock_guard wait(made);
      watcher->stop();
      stopped = true;
    });
  }
  EXPECT_TRUE(eventually([&] { return stopped.load(); }));
  watcher.reset();
}

}  // namespace
}  // namespace lpv::client
