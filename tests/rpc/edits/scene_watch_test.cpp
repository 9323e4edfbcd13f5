// WatchScene: a snapshot, then every change without gaps, whatever the reader's pace.

#include <gtest/gtest.h>

#include <map>
#include <thread>

#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

/// A reader that keeps its own copy of the scene and checks that nothing is missing in between.
class Reader {
 public:
  Reader(Stubs& stubs, const std::string& session, std::uint64_t since = 0) : revision_(since) {
    pb::WatchSceneRequest request;
    request.set_session(session);
    request.set_since_revision(since);
    stream_ = stubs.scene->WatchScene(call_, request);
  }

  /// Takes one event; false at the end of the stream.
  bool step() {
    if (!stream_->Read(&event_)) return false;
    if (event_.has_snapshot()) take(event_.snapshot());
    if (event_.has_change()) take(event_.change());
    return true;
  }
  void readUntil(std::uint64_t revision) {
    while (revision_ < revision && step()) {
    }
    EXPECT_EQ(revision_, revision);
  }
  grpc::Status finish() { return stream_->Finish(); }
  void cancel() { call_->TryCancel(); }

  const pb::WatchSceneResponse& event() const { return event_; }
  const std::map<std::string, pb::Light>& lights() const { return lights_; }
  std::uint64_t revision() const { return revision_; }
  int snapshots = 0;
  int changes = 0;
  int coalesced = 0;    ///< changes that tell several revisions as one
  int parts = 0;        ///< messages with more to follow
  std::map<std::string, std::uint64_t> sequences;

 private:
  template <typename Event>
  void takeObjects(const Event& event) {
    EXPECT_LE(event_.ByteSizeLong(), std::size_t(kMiB));
    for (const pb::Light& light : event.lights()) lights_[light.name()] = light;
    if (event.more()) ++parts;
    inParts_ = event.more();
  }
  void take(const pb::SceneSnapshot& snapshot) {
    if (!inParts_) {
      ++snapshots;
      lights_.clear();
    }
    takeObjects(snapshot);
    revision_ = snapshot.revision();
  }
  void take(const pb::SceneChange& change) {
    if (!inParts_) {
      ++changes;
      EXPECT_EQ(change.first_revision(), revision_ + 1) << "a gap";
      if (change.first_revision() != change.last_revision()) ++coalesced;
    }
    for (const std::string& name : change.deleted_lights()) lights_.erase(name);
    takeObjects(change);
    for (const auto& [client, sequence] : change.client_sequences()) sequences[client] = sequence;
    revision_ = change.last_revision();
  }

  Call call_;
  std::unique_ptr<grpc::ClientReader<pb::WatchSceneResponse>> stream_;
  pb::WatchSceneResponse event_;
  std::map<std::string, pb::Light> lights_;
  std::uint64_t revision_ = 0;
  bool inParts_ = false;
};

void expectSameLights(Stubs& stubs, const std::string& session, const std::map<std::string, pb::Light>& lights) {
  pb::ListLightsRequest request;
  request.set_session(session);
  request.set_page_size(1000);
  pb::ListLightsResponse response;
  ASSERT_THAT(stubs.scene->ListLights(Call(), request, &response), IsOk());
  ASSERT_EQ(std::size_t(response.lights_size()), lights.size());
  for (pb::Light& light : *response.mutable_lights()) {
    ASSERT_TRUE(lights.contains(light.name())) << light.name();
    light.mutable_status()->clear_area();
    EXPECT_EQ(lights.at(light.name()).SerializeAsString(), light.SerializeAsString()) << light.name();
  }
}

class SceneWatch : public ::testing::Test {
 protected:
  Stubs stubs_{server().address()};
  std::string session_ = makeSession(stubs_);
};

TEST_F(SceneWatch, AnEmptySessionIsASnapshotToo) {
  Reader reader(stubs_, session_);
  ASSERT_TRUE(reader.step());
  ASSERT_TRUE(reader.event().has_snapshot());
  EXPECT_EQ(reader.event().snapshot().revision(), 0U);
  EXPECT_EQ(reader.event().snapshot().grid().dims().x(), 8);
  EXPECT_EQ(reader.event().snapshot().settings().transport(), pb::TRANSPORT_GATHER);
  ASSERT_TRUE(reader.step());
  EXPECT_TRUE(reader.event().has_heartbeat()) << "and then nothing but heartbeats";
}

// Seen to fail when one revision's objects are left out, and when deletions are not told.
TEST_F(SceneWatch, MissesNothingInAStormOfEdits) {
  constexpr int kEach = 150;
  apply(stubs_, session_, {client::createLight(light("A")), client::createLight(light("B"))});
  Reader early(stubs_, session_);
  early.readUntil(1);
  const auto write = [&](const std::string& name) {
    Stubs own(server().address());
    for (int i = 0; i < kEach; ++i) {
      const std::string mine = name + std::to_string(i);
      std::vector<pb::Operation> operations = {client::setRadiance(name, {double(i), 0, 0})};
      if (i % 5 == 0) operations.push_back(client::createLight(light(mine)));
      if (i % 10 == 9) operations.push_back(client::deleteLight(name + std::to_string(i - 9)));
      apply(own, session_, operations);
    }
  };
  std::thread a(write, "A");
  std::thread b(write, "B");
  Stubs later(server().address());
  Reader late(later, session_);  // joins in the middle
  constexpr std::uint64_t kLast = 1 + 2 * kEach;
  std::thread lateReading([&] { late.readUntil(kLast); });
  early.readUntil(kLast);
  a.join();
  b.join();
  lateReading.join();
  EXPECT_EQ(early.snapshots, 1);
  EXPECT_EQ(late.snapshots, 1);
  expectSameLights(stubs_, session_, early.lights());
  expectSameLights(stubs_, session_, late.lights());
}

TEST_F(SceneWatch, AReaderThatComesBackGetsWhatItMissed) {
  apply(stubs_, session_, {client::createLight(light("Gone")), client::createLight(light("Again"))});
  apply(stubs_, session_, {client::createLight(light("Kept"))});
  apply(stubs_, session_, {client::deleteLight("Gone"), client::deleteLight("Again")});
  apply(stubs_, session_, {client::createLight(light("Again"))});
  apply(stubs_, session_, {client::createLight(light("Brief"))});
  apply(stubs_, session_, {client::deleteLight("Brief")});
  Reader reader(stubs_, session_, 2);
  ASSERT_TRUE(reader.step());
  ASSERT_TRUE(reader.event().has_change());
  const pb::SceneChange& change = reader.event().change();
  EXPECT_EQ(change.first_revision(), 3U);
  EXPECT_EQ(change.last_revision(), 6U);
  EXPECT_FALSE(change.more());
  ASSERT_EQ(change.lights_size(), 1) << "what did not change is not told";
  EXPECT_EQ(change.lights(0).name(), "Again");
  EXPECT_THAT(change.deleted_lights(), ::testing::UnorderedElementsAre("Gone", "Brief"));
  EXPECT_FALSE(change.has_grid());
  EXPECT_FALSE(change.has_settings());
}

TEST_F(SceneWatch, OfTheNewestRevisionWaitsAndOfAnUnknownOneStartsOver) {
  apply(stubs_, session_, {client::createLight(light("Lamp"))});
  Reader current(stubs_, session_, 1);
  ASSERT_TRUE(current.step());
  EXPECT_TRUE(current.event().has_heartbeat());
  EXPECT_EQ(current.event().heartbeat().revision(), 1U);
  apply(stubs_, session_, {client::setRadiance("Lamp", {2, 2, 2})});
  current.readUntil(2);
  EXPECT_EQ(current.snapshots, 0);
  Reader beyond(stubs_, session_, 1000);
  ASSERT_TRUE(beyond.step());
  ASSERT_TRUE(beyond.event().has_snapshot()) << "a revision this session never had";
  EXPECT_EQ(beyond.event().snapshot().revision(), 2U);
}

TEST_F(SceneWatch, TellsOneChangeAtATimeToAReaderThatKeepsUp) {
  Reader reader(stubs_, session_);
  ASSERT_TRUE(reader.step());
  const pb::ClientIdentity me = join(stubs_, session_);
  for (std::uint64_t i = 1; i <= 10; ++i) {
    pb::Edit edit =
        client::editOf({i == 1 ? client::createLight(light("Lamp")) : client::setRadiance("Lamp", {double(i), 0, 0})});
    edit.set_sequence(i * 3);
    ASSERT_THAT(tryEdit(stubs_, session_, edit, nullptr, me), IsOk());
    reader.readUntil(i);
    EXPECT_EQ(reader.sequences[me.client_id()], i * 3) << "the echo of one's own edit";
    if (i > 1) {
      EXPECT_DOUBLE_EQ(reader.lights().at("Lamp").radiance().x(), double(i));
    }
  }
  EXPECT_EQ(reader.coalesced, 0);
  EXPECT_EQ(reader.changes, 10);
}

TEST_F(SceneWatch, ASlowReaderGetsChangesTogether) {
  constexpr int kLights = 150;
  constexpr std::uint64_t kEdits = 80;
  std::vector<pb::Operation> create;
  for (int i = 0; i < kLights; ++i) create.push_back(client::createLight(light("L" + std::to_string(i))));
  apply(stubs_, session_, create);
  grpc::ChannelArguments narrow;  // HTTP/2 lets the server send 64 KiB ahead, and no more after a while
  narrow.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  narrow.SetInt(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, 65536);
  Stubs slow(server().address(), narrow);
  Reader reader(slow, session_);
  reader.readUntil(1);
  // The reader sleeps; a change is about 30 KB.
  const std::int64_t before = server().residentBytes();
  for (std::uint64_t edit = 0; edit < kEdits; ++edit) {
    std::vector<pb::Operation> all;
    for (int i = 0; i < kLights; ++i) {
      all.push_back(client::setRadiance("L" + std::to_string(i), {double(edit), double(i), 1}));
    }
    apply(stubs_, session_, all);
  }
  EXPECT_LT(server().residentBytes() - before, 8 * kMiB * (kSanitized ? 4 : 1)) << "changes are not queued";
  reader.readUntil(1 + kEdits);
  EXPECT_GE(reader.coalesced, 1);
  EXPECT_LT(reader.changes, int(kEdits));
  expectSameLights(stubs_, session_, reader.lights());
}

TEST_F(SceneWatch, LargeScenesComeInParts) {
  for (int batch = 0; batch < 2; ++batch) {
    std::vector<pb::Operation> create;
    for (int i = 0; i < 500; ++i)
      create.push_back(client::createLight(light(std::string(190, 'n') + std::to_string(batch * 500 + i))));
    apply(stubs_, session_, create);
  }
  std::vector<pb::Operation> walls;
  for (int i = 0; i < 500; ++i) walls.push_back(client::createSurface(surface("wall" + std::to_string(i))));
  apply(stubs_, session_, walls);
  Reader reader(stubs_, session_);
  ASSERT_TRUE(reader.step());
  while (reader.event().snapshot().more()) ASSERT_TRUE(reader.step());
  EXPECT_EQ(reader.snapshots, 1);
  EXPECT_GE(reader.parts, 1);
  EXPECT_EQ(reader.lights().size(), 1000U);
  // Deleting everything is a change in parts as well, for whoever comes back.
  Reader back(stubs_, session_, 3);
  std::vector<pb::Operation> clear;
  for (const auto& [name, lamp] : reader.lights()) clear.push_back(client::deleteLight(name));
  apply(stubs_, session_, clear);
  int deleted = 0;
  do {
    ASSERT_TRUE(reader.step());
    deleted += reader.event().change().deleted_lights_size();
  } while (!reader.event().has_change() || reader.event().change().more());
  EXPECT_EQ(deleted, 1000);
  EXPECT_TRUE(reader.lights().empty());
}

TEST_F(SceneWatch, EndsWithANoticeWhenTheSessionIsDeleted) {
  Reader reader(stubs_, session_);
  ASSERT_TRUE(reader.step());
  pb::DeleteSessionRequest request;
  request.set_name(session_);
  pb::DeleteSessionResponse response;
  ASSERT_THAT(stubs_.session->DeleteSession(Call(), request, &response), IsOk());
  while (reader.step() && reader.event().has_heartbeat()) {
  }
  ASSERT_TRUE(reader.event().has_notice());
  EXPECT_EQ(reader.event().notice().kind(), pb::Notice::KIND_DELETED);
  EXPECT_FALSE(reader.step());
  EXPECT_THAT(reader.finish(), HasCode(StatusCode::UNAVAILABLE));
}

TEST_F(SceneWatch, SettingsAndGridAreToldWhenTheyChange) {
  Reader reader(stubs_, session_);
  ASSERT_TRUE(reader.step());
  pb::UpdateSessionRequest request;
  request.mutable_session()->set_name(session_);
  *request.mutable_session()->mutable_settings() = settings(6);
  request.mutable_session()->mutable_settings()->set_iterations(2);
  request.mutable_update_mask()->add_paths("settings.grid");
  request.mutable_update_mask()->add_paths("settings.iterations");
  pb::UpdateSessionResponse response;
  ASSERT_THAT(stubs_.session->UpdateSession(Call(), request, &response), IsOk());
  reader.readUntil(1);
  EXPECT_EQ(reader.event().change().grid().dims().x(), 6);
  EXPECT_EQ(reader.event().change().settings().iterations(), 2);
}

}  // namespace
}  // namespace lpv::rpc
