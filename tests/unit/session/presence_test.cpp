// Who is there, as the others see it: the newest of each, for as long as they are there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>

#include "api/services.h"
#include "session/members/presence.h"
#include "unit/session/session_rig.h"

namespace lpv {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

PresenceUpdate named(const std::string& name) {
  PresenceUpdate out;
  out.displayName = name;
  return out;
}

PresenceUpdate selecting(std::vector<std::string> names) {
  PresenceUpdate out;
  out.selection = std::move(names);
  return out;
}

class PresentOnesTest : public testing::Test {
 protected:
  Limits limits_;
  PresenceTable present_{limits_};
  const Clock::time_point start_ = Clock::now();
};

TEST_F(PresentOnesTest, AreThoseWhoSaidSomething) {
  present_.join("a", named("Ann"), start_);
  present_.join("b", {}, start_);
  EXPECT_EQ(present_.members().size(), 1U) << "who joins without a name is not seen";
  const std::uint64_t before = present_.changes();
  ASSERT_TRUE(present_.update("b", selecting({"Lamp"}), start_).ok());
  EXPECT_GT(present_.changes(), before);
  EXPECT_EQ(present_.members().at("b").presence.selection.at(0), "Lamp");
  EXPECT_EQ(present_.members().at("a").presence.displayName, "Ann");
}

TEST_F(PresentOnesTest, KeepANameThatAnUpdateLeavesOutAndNothingElse) {
  PresenceUpdate all = named("Ann");
  all.colour = glm::dvec3(0.5);
  all.camera = Camera();
  all.selection = {"Lamp"};
  present_.join("a", all, start_);
  ASSERT_TRUE(present_.update("a", {}, start_).ok());
  const Presence& now = present_.members().at("a").presence;
  EXPECT_EQ(now.displayName, "Ann");
  EXPECT_EQ(now.colour, glm::dvec3(0.5));
  EXPECT_FALSE(now.camera);
  EXPECT_TRUE(now.selection.empty());
}

TEST_F(PresentOnesTest, AreLimitedByName) {
  present_.join("a", {}, start_);
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(present_.update("a", {}, start_).ok()) << i;
  const Status tooFast = present_.update("a", {}, start_);
  EXPECT_EQ(tooFast.code(), Code::kResourceExhausted);
  EXPECT_EQ(tooFast.field(), "max_presence_updates_per_second");
  EXPECT_THAT(tooFast.message(), HasSubstr("30"));
  EXPECT_TRUE(present_.update("b", {}, start_).ok()) << "each member has a rate of its own";
  int more = 0;
  while (more < 100 && present_.update("a", {}, start_ + milliseconds(510)).ok()) ++more;
  EXPECT_EQ(more, 15);
}

TEST_F(PresentOnesTest, AreGoneAfterSilenceAndNotWhileTheyAreConnected) {
  for (const char* client : {"quiet", "connected", "heard"}) present_.join(client, named(client), start_);
  const Clock::time_point later = start_ + seconds(10);
  present_.markActive("heard", later);
  present_.dropSilent({"connected"}, start_ + limits_.presenceIdle);
  EXPECT_EQ(present_.members().size(), 3U);
  const std::uint64_t before = present_.changes();
  present_.dropSilent({"connected"}, start_ + limits_.presenceIdle + milliseconds(1));
  EXPECT_GT(present_.changes(), before);
  EXPECT_EQ(present_.members().count("quiet"), 0U);
  EXPECT_EQ(present_.members().size(), 2U);
  present_.dropSilent({"connected"}, later + limits_.presenceIdle + milliseconds(1));
  EXPECT_EQ(present_.members().count("heard"), 0U);
  EXPECT_EQ(present_.members().size(), 1U);
  ASSERT_TRUE(present_.update("quiet", named("Back"), later + seconds(100)).ok());
  EXPECT_EQ(present_.members().count("quiet"), 1U) << "the next update brings it back";
}

TEST_F(PresentOnesTest, SayNothingThatIsOutOfRange) {
  EXPECT_TRUE(checkPresence(named(std::string(100, 'x'))).ok());
  EXPECT_EQ(checkPresence(named(std::string(101, 'x'))).field(), "display_name");
  PresenceUpdate bright;
  bright.colour = glm::dvec3(0.0, 0.0, 1.5);
  EXPECT_EQ(checkPresence(bright).field(), "colour");
  EXPECT_TRUE(checkPresence(selecting(std::vector<std::string>(64, "Lamp"))).ok());
  EXPECT_EQ(checkPresence(selecting(std::vector<std::string>(65, "Lamp"))).field(), "selection");
  EXPECT_EQ(checkPresence(selecting({"a/b"})).field(), "selection");
  PresenceUpdate blind;
  blind.camera = Camera();
  blind.camera->target = blind.camera->eye;
  EXPECT_THAT(checkPresence(blind).field(), HasSubstr("camera"));
}

/// A session, its members and one who watches.
class PresenceTest : public testing::Test {
 protected:
  PresenceTest() {
    context_.registry = &registry_;
    context_.pool = &rig_.pool;
    context_.timers = &rig_.timers;
    context_.counters = &rig_.counters;
    session_ = *registry_.create("room", LightingSettings(), {}, "");
  }
  ClientIdentity join(const std::string& name) { return *session_->join(named(name)); }
  /// A watcher that has read its snapshot.
  api::StreamPtr<api::pb::WatchSceneRequest, api::pb::WatchSceneResponse> watch(const ClientIdentity& client) {
    auto stream = api::watchScene(context_);
    api::pb::WatchSceneRequest request;
    request.set_session("sessions/room");
    request.mutable_client()->set_client_id(client.id);
    request.mutable_client()->set_secret(client.secret);
    stream->receive(request);
    api::pb::WatchSceneResponse response;
    EXPECT_TRUE(stream->next(&response));
    EXPECT_TRUE(response.has_snapshot());
    watching_.push_back(stream);
    return stream;
  }
  /// What a watcher is told of members now.
  template <typename Watching>
  std::vector<api::pb::Presence> told(Watching& stream) {
    std::vector<api::pb::Presence> out;
    for (api::pb::WatchSceneResponse response; stream->next(&response); response.Clear()) {
      if (response.has_presence()) out.push_back(response.presence());
    }
    return out;
  }
  ~PresenceTest() override {
    for (const auto& stream : watching_) stream->cancelled();
    rig_.settle();
    rig_.timers.stop();
    rig_.pool.stop();
  }

  test::Rig rig_;
  Registry registry_{rig_.services};
  api::Context context_;
  SessionPtr session_;
  std::vector<api::StreamPtr<api::pb::WatchSceneRequest, api::pb::WatchSceneResponse>> watching_;
};

TEST_F(PresenceTest, AWatcherIsToldOfTheOthersAndNotOfItself) {
  const ClientIdentity ann = join("Ann");
  const ClientIdentity bob = join("Bob");
  const auto watching = watch(bob);
  const auto first = told(watching);
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(first[0].client_id(), ann.id);
  EXPECT_EQ(first[0].display_name(), "Ann");
  EXPECT_TRUE(told(watching).empty()) << "once";
  ASSERT_TRUE(session_->present(bob, named("Robert")).ok());
  EXPECT_TRUE(told(watching).empty());
  const auto anybody = watch({});
  EXPECT_EQ(told(anybody).size(), 2U);
}

TEST_F(PresenceTest, ASlowWatcherGetsTheNewestOfEach) {
  const ClientIdentity ann = join("Ann");
  const ClientIdentity bob = join("Bob");
  const auto watching = watch({});
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(session_->present(ann, selecting({"a" + std::to_string(i)})).ok());
    ASSERT_TRUE(session_->present(bob, selecting({"b" + std::to_string(i)})).ok());
  }
  const auto members = told(watching);
  ASSERT_EQ(members.size(), 2U);
  for (const auto& member : members) {
    EXPECT_EQ(member.selection(0), (member.client_id() == ann.id ? "a19" : "b19"));
  }
}

TEST_F(PresenceTest, WhoLeavesIsGoneForThoseWhoKnewThem) {
  const ClientIdentity ann = join("Ann");
  const auto knew = watch({});
  EXPECT_EQ(told(knew).size(), 1U);
  session_->leave(ann);
  const auto gone = told(knew);
  ASSERT_EQ(gone.size(), 1U);
  EXPECT_TRUE(gone[0].gone());
  EXPECT_EQ(gone[0].client_id(), ann.id);
  EXPECT_TRUE(told(knew).empty());
  const auto late = watch({});
  EXPECT_TRUE(told(late).empty());
}

TEST_F(PresenceTest, WhoIsSilentIsGoneUnlessWatching) {
  const ClientIdentity ann = join("Ann");
  const ClientIdentity bob = join("Bob");
  const auto anns = watch(ann);
  const Clock::time_point later = Clock::now() + session_->limits().presenceIdle + seconds(1);
  session_->dropSilentMembers(later);
  EXPECT_EQ(session_->presenceSnapshot().count(ann.id), 1U);
  EXPECT_EQ(session_->presenceSnapshot().count(bob.id), 0U);
  anns->cancelled();
  session_->dropSilentMembers(later + seconds(60));
  EXPECT_TRUE(session_->presenceSnapshot().empty());
}

TEST_F(PresenceTest, IsForMembersAndInNoRevision) {
  EXPECT_EQ(session_->present({}, {}).field(), "client");
  EXPECT_EQ(session_->present({"c-stranger", "x"}, {}).code(), Code::kPermissionDenied);
  const ClientIdentity ann = join("Ann");
  const Status bad = session_->present(ann, selecting({"/"}));
  EXPECT_EQ(bad.field(), "presence.selection");
  ASSERT_TRUE(session_->present(ann, {}).ok());
  EXPECT_EQ(session_->revision(), 0U);
  EXPECT_EQ(session_->join(named(std::string(101, 'x'))).status().field(), "display_name");
}

}  // namespace
}  // namespace lpv
