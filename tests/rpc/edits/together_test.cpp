// Two people in one session: what one takes back, what the other sees of it and of them.

#include <gtest/gtest.h>
#include <signal.h>

#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>

#include "lpv/editor.h"
#include "lpv/watch.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// What a SceneWatcher has seen: the lights, and who is there.
class Seen {
 public:
  Seen(const client::Client& client, const std::string& session, const pb::ClientIdentity& member = {})
      : watcher_(
            client, session, 0, [this](const pb::WatchSceneResponse& event) { take(event); }, {}, member) {}

  /// Waits until `true` of what was seen; the condition runs under the lock.
  template <typename Condition>
  bool until(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), condition);
  }
  bool sees(const std::string& member) {
    const std::lock_guard lock(mutex_);
    return members.contains(member);
  }
  std::map<std::string, pb::Light> lights;
  std::map<std::string, pb::Presence> members;
  std::set<std::string> gone;
  std::uint64_t revision = 0;

 private:
  void take(const pb::WatchSceneResponse& event) {
    {
      const std::lock_guard lock(mutex_);
      for (const pb::Light& light : event.snapshot().lights()) lights[light.name()] = light;
      for (const pb::Light& light : event.change().lights()) lights[light.name()] = light;
      for (const std::string& name : event.change().deleted_lights()) lights.erase(name);
      if (event.has_snapshot()) revision = event.snapshot().revision();
      if (event.has_change()) revision = event.change().last_revision();
      const pb::Presence& member = event.presence();
      if (member.gone()) {
        members.erase(member.client_id());
        gone.insert(member.client_id());
      } else if (event.has_presence()) {
        members[member.client_id()] = member;
      }
    }
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  client::SceneWatcher watcher_;  // last: its thread uses the above
};

class Together : public ::testing::Test {
 protected:
  client::Editor member(const std::string& name) { return *client::Editor::join(client_, session_, name); }
  double radiance() { return findLight(stubs_, session_, "Lamp").radiance().x(); }
  double place() { return findLight(stubs_, session_, "Lamp").transform().translation().x(); }
  static void apply(client::Editor& editor, const pb::Operation& operation, const std::string& group = {}) {
    pb::Edit edit = client::editOf({operation});
    edit.set_undo_group(group);
    const auto ack = editor.apply(edit);
    ASSERT_TRUE(ack.ok()) << ack.status().message();
  }

  Stubs stubs_{server().address()};
  client::Client client_ = clientOf(server().address());
  std::string session_ = makeLitSession(stubs_);
};

TEST_F(Together, UndoIsAnEditThatTheOthersSee) {
  client::Editor ann = member("");
  Seen bob(client_, session_);
  apply(ann, client::setRadiance("Lamp", {5, 5, 5}));
  ASSERT_TRUE(bob.until([&] { return bob.revision == 2; }));
  const auto undone = ann.undo();
  ASSERT_TRUE(undone.ok()) << undone.status().message();
  EXPECT_EQ(undone->ack().revision(), 3U);
  EXPECT_EQ(undone->ack().sequence(), 2U);
  EXPECT_THAT(undone->ack().names(), ElementsAre("Lamp"));
  EXPECT_THAT(undone->ack().skipped_fields(), IsEmpty());
  ASSERT_TRUE(bob.until([&] { return bob.revision == 3; }));
  EXPECT_EQ(bob.lights["Lamp"].radiance().x(), 1.0);
  ASSERT_TRUE(ann.redo().ok());
  ASSERT_TRUE(bob.until([&] { return bob.revision == 4; }));
  EXPECT_EQ(bob.lights["Lamp"].radiance().x(), 5.0);
}

TEST_F(Together, WhatTheOtherHasWrittenSinceStaysAndIsNamed) {
  client::Editor ann = member("");
  client::Editor bob = member("");
  pb::Light both;
  both.set_name("Lamp");
  *both.mutable_radiance() = vec3(5, 5, 5);
  *both.mutable_transform()->mutable_translation() = vec3(0.5, 0, 0);
  apply(ann, client::updateLight(both, {"radiance", "transform.translation"}));
  apply(bob, client::setRadiance("Lamp", {7, 7, 7}));
  const auto undone = ann.undo();
  ASSERT_TRUE(undone.ok());
  EXPECT_THAT(undone->ack().skipped_fields(), ElementsAre("Lamp.radiance"));
  EXPECT_EQ(radiance(), 7.0);
  EXPECT_EQ(place(), 0.0);
  EXPECT_EQ(ann.undo().status().code(), Code::kFailedPrecondition);
}

TEST_F(Together, ADragOverAStreamIsOneStep) {
  client::Editor ann = member("");
  {
    client::EditStream stream(ann);
    for (int i = 1; i <= 40; ++i) {
      pb::Edit edit = client::editOf({moveTo("Lamp", {i * 0.01, 0, 0})});
      edit.set_undo_group("drag 1");
      ASSERT_TRUE(stream.send(edit).ok());
    }
    ASSERT_TRUE(stream.drain(std::chrono::seconds(20)).ok());
  }
  EXPECT_EQ(place(), 0.4);
  ASSERT_TRUE(ann.undo().ok());
  EXPECT_EQ(place(), 0.0);
  ASSERT_TRUE(ann.redo().ok());
  EXPECT_EQ(place(), 0.4);
}

TEST_F(Together, ARepeatedUndoIsOneStep) {
  const pb::ClientIdentity me = join(stubs_, session_);
  for (int i = 1; i <= 2; ++i) {
    pb::Edit edit = client::editOf({client::setRadiance("Lamp", {i + 1.0, 0, 0})});
    edit.set_sequence(std::uint64_t(i));
    ASSERT_THAT(tryEdit(stubs_, session_, edit, nullptr, me), IsOk());
  }
  apply(*std::make_unique<client::Editor>(member("")), client::setRadiance("Lamp", {9, 0, 0}));
  pb::UndoRequest request;
  request.set_session(session_);
  *request.mutable_client() = me;
  request.set_sequence(3);
  pb::UndoResponse first;
  pb::UndoResponse again;
  ASSERT_THAT(stubs_.scene->Undo(Call(), request, &first), IsOk());
  ASSERT_THAT(stubs_.scene->Undo(Call(), request, &again), IsOk());
  EXPECT_EQ(first.SerializeAsString(), again.SerializeAsString());
  EXPECT_THAT(again.ack().skipped_fields(), ElementsAre("Lamp.radiance"));
}

TEST_F(Together, UndoIsForMembers) {
  pb::UndoRequest request;
  request.set_session(session_);
  pb::UndoResponse response;
  EXPECT_THAT(stubs_.scene->Undo(Call(), request, &response),
              Refused(StatusCode::INVALID_ARGUMENT, "client", "JoinSession"));
  request.mutable_client()->set_client_id("c-stranger");
  EXPECT_THAT(stubs_.scene->Undo(Call(), request, &response), HasCode(StatusCode::PERMISSION_DENIED));
  *request.mutable_client() = join(stubs_, session_);
  request.set_sequence(1);
  EXPECT_THAT(stubs_.scene->Undo(Call(), request, &response),
              Refused(StatusCode::FAILED_PRECONDITION, "client", "nothing to undo"));
  pb::Edit edit = client::editOf({client::setEnabled("Lamp", false)});
  edit.set_undo_group(std::string(101, 'g'));
  EXPECT_THAT(tryEdit(stubs_, session_, edit), Refused(StatusCode::INVALID_ARGUMENT, "edit.undo_group", "101"));
}

TEST_F(Together, EachSeesTheOtherUntilItLeaves) {
  client::Editor ann = member("Ann");
  client::Editor bobs = member("Bob");
  Seen bob(client_, session_, bobs.identity());
  const std::string id = ann.identity().client_id();
  ASSERT_TRUE(bob.until([&] { return bob.members.contains(id); }));
  EXPECT_EQ(bob.members[id].display_name(), "Ann");
  pb::Presence looking;
  *looking.mutable_camera() = camera({0, 0, 3}, {0, 0, 0});
  *looking.mutable_colour() = vec3(1, 0.5, 0);
  looking.add_selection("Lamp");
  ASSERT_TRUE(ann.present(looking).ok());
  ASSERT_TRUE(bob.until([&] { return bob.members[id].selection_size() == 1; }));
  EXPECT_EQ(bob.members[id].display_name(), "Ann") << "what is not said stays";
  EXPECT_EQ(bob.members[id].camera().eye().z(), 3.0);
  EXPECT_EQ(bob.members[id].colour().y(), 0.5);
  EXPECT_FALSE(bob.sees(bobs.identity().client_id())) << "itself";
  EXPECT_EQ(getSession(stubs_, session_).revision(), 1U) << "no edit";
  ASSERT_TRUE(ann.leave().ok());
  ASSERT_TRUE(bob.until([&] { return bob.gone.contains(id); }));
  EXPECT_EQ(ann.present(looking).code(), Code::kPermissionDenied);
}

TEST_F(Together, ALockKeepsTheOthersAwayUntilItIsReleased) {
  client::Editor ann = member("");
  client::Editor bob = member("");
  Seen watching(client_, session_);
  const std::string id = ann.identity().client_id();
  ASSERT_TRUE(ann.lock({"Lamp"}, std::chrono::seconds(60)).ok());
  ASSERT_TRUE(watching.until([&] { return watching.members[id].locked_size() == 1; }));
  const Status refused = bob.apply(client::editOf({client::setRadiance("Lamp", {5, 5, 5})})).status();
  EXPECT_EQ(refused.code(), Code::kAborted);
  EXPECT_EQ(refused.field(), "edit.operations[0]");
  EXPECT_THAT(refused.message(), HasSubstr(id));
  EXPECT_EQ(bob.lock({"Lamp"}, std::chrono::seconds(1)).code(), Code::kAborted);
  apply(ann, client::setRadiance("Lamp", {3, 3, 3}));
  ASSERT_TRUE(ann.lock({}, std::chrono::seconds(0)).ok());
  ASSERT_TRUE(watching.until([&] { return watching.members[id].locked_size() == 0; }));
  apply(bob, client::setRadiance("Lamp", {5, 5, 5}));
}

TEST_F(Together, SilentMembersAreGoneAndPresenceIsLimitedByName) {
  ServerProcess own({"--presence-idle", "1", "--max-presence-updates-per-second", "2"});
  Stubs stubs(own.address());
  const std::string session = makeSession(stubs);
  const client::Client client = clientOf(own.address());
  client::Editor ann = *client::Editor::join(client, session, "Ann");
  client::Editor connected = *client::Editor::join(client, session, "Connected");
  const client::EditStream stream(connected);
  Seen bob(client, session);
  ASSERT_TRUE(bob.until([&] { return bob.gone.contains(ann.identity().client_id()); }));
  EXPECT_TRUE(bob.until([&] { return bob.members.contains(connected.identity().client_id()); }));
  EXPECT_TRUE(ann.present({}).ok());
  EXPECT_TRUE(bob.until([&] { return bob.members.contains(ann.identity().client_id()); })) << "back";
  Status status;
  for (int i = 0; i < 50 && status.ok(); ++i) status = ann.present({});
  EXPECT_EQ(status.code(), Code::kResourceExhausted);
  EXPECT_EQ(status.field(), "max_presence_updates_per_second");
  pb::GetServerInfoResponse info;
  ASSERT_THAT(stubs.server->GetServerInfo(Call(), pb::GetServerInfoRequest(), &info), IsOk());
  EXPECT_EQ(info.limits().presence_idle().seconds(), 1);
  EXPECT_EQ(info.limits().max_presence_updates_per_second(), 2.0);
  EXPECT_EQ(info.limits().max_undo_steps(), 100);
}

// Steps are kept in memory: after a kill what was undone stays undone, and can be neither undone nor redone.
TEST_F(Together, AKilledServerKeepsWhatWasUndoneAndForgetsTheSteps) {
  const std::string directory = makeDirectory();
  auto own = std::make_unique<ServerProcess>(std::vector<std::string>{"--state-dir", directory});
  const std::string session = makeLitSession(*std::make_unique<Stubs>(own->address()));
  client::Editor before = *client::Editor::join(clientOf(own->address()), session, "");
  apply(before, client::setRadiance("Lamp", {3, 0, 0}));
  apply(before, client::setRadiance("Lamp", {5, 0, 0}));
  const auto undone = before.undo();
  ASSERT_TRUE(undone.ok());
  EXPECT_EQ(undone->ack().durability(), pb::DURABILITY_DISK);
  own->process().signal(SIGKILL);
  ASSERT_EQ(own->process().wait(), -SIGKILL);
  own = std::make_unique<ServerProcess>(std::vector<std::string>{"--state-dir", directory});
  Stubs stubs(own->address());
  EXPECT_EQ(findLight(stubs, session, "Lamp").radiance().x(), 3.0);
  client::Editor after =
      client::Editor::resume(clientOf(own->address()), session, before.identity(), before.sequence());
  const Status nothing = after.undo().status();
  EXPECT_EQ(nothing.code(), Code::kFailedPrecondition);
  EXPECT_THAT(nothing.message(), HasSubstr("in memory"));
  EXPECT_EQ(after.redo().status().code(), Code::kFailedPrecondition);
  pb::UndoRequest request;
  request.set_session(session);
  *request.mutable_client() = before.identity();
  request.set_sequence(before.sequence());
  pb::UndoResponse again;
  ASSERT_THAT(stubs.scene->Undo(Call(), request, &again), IsOk()) << "its outcome is kept";
  EXPECT_EQ(again.ack().revision(), undone->ack().revision());
  apply(after, client::setRadiance("Lamp", {8, 0, 0}));
  ASSERT_TRUE(after.undo().ok());
  EXPECT_EQ(findLight(stubs, session, "Lamp").radiance().x(), 3.0);
  own.reset();
  std::filesystem::remove_all(directory);
}

}  // namespace
}  // namespace lpv::rpc
