// Sessions that are too dear for the device are refused, by what the engine predicts.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/session/session_rig.h"

namespace lpv {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Ticks may take a second; lights cost 0.3 s each, and cells what a test says.
class Admission : public ::testing::Test {
 protected:
  Admission() : rig_(limits()) { rig_.engine.secondsPerLight = 0.3; }

  static Limits limits() {
    Limits out = test::Rig::quick();
    out.maxTickSeconds = 1.0;
    return out;
  }

  Status add(Session& session, const std::string& light) {
    return session.apply(client_, test::editOf({test::createLight(light)}, ++sequence_)).status;
  }

  test::Rig rig_;
  ClientIdentity client_;
  std::uint64_t sequence_ = 0;
};

// Broken by: not asking the engine in Registry::create.
TEST_F(Admission, OfANewSession) {
  rig_.engine.secondsPerCell = 1e-5;
  Registry registry(rig_.services);
  LightingSettings options;
  options.grid.longest = 32;  // .33 s
  EXPECT_TRUE(registry.create("small", options, {}, {}).ok());
  options.grid.longest = 128;
  const Expected<SessionPtr> large = registry.create("large", options, {}, {});
  ASSERT_FALSE(large.ok());
  EXPECT_EQ(large.status().code(), Code::kResourceExhausted);
  EXPECT_THAT(large.status().message(),
              AllOf(HasSubstr("max_tick_seconds:"), HasSubstr("21.0 s"), HasSubstr("allowed are 1 s"),
                    HasSubstr("propagate"), HasSubstr("coarser grid")));
  EXPECT_EQ(registry.find("large").status().code(), Code::kNotFound);
}

// Broken by: not checking edits, or checking before they are applied.
TEST_F(Admission, OfAnEdit) {
  const std::shared_ptr<Session> session = rig_.session();
  for (const char* light : {"A", "B", "C"}) ASSERT_TRUE(add(*session, light).ok());
  const std::uint64_t revision = session->revision();
  EXPECT_THAT(add(*session, "D").message(), HasSubstr("max_tick_seconds"));
  EXPECT_EQ(session->revision(), revision) << "nothing of it was done";
  EXPECT_EQ(session->summary().lights, 3U);
}

// Broken by: not checking settings; taking them over before they are refused.
TEST_F(Admission, OfNewSettings) {
  const std::shared_ptr<Session> session = rig_.session();
  ASSERT_TRUE(add(*session, "A").ok());
  rig_.engine.secondsPerCell = 1e-5;
  LightingSettings options = session->summary().options;
  const LightingSettings before = options;
  options.grid.longest = 128;
  const auto wanted = [&](const SessionSettings& now) {
    return Expected<SessionSettings>(SessionSettings{options, now.policy});
  };
  EXPECT_EQ(session->changeSettings(wanted).field(), "max_tick_seconds");
  EXPECT_EQ(session->summary().options, before);
  options.grid.longest = 16;
  EXPECT_TRUE(session->changeSettings(wanted).ok());
}

// A device that turns out slower than it seemed must not lock a session up. Broken by: refusing whatever is above.
TEST_F(Admission, WhatMakesNothingDearerIsAccepted) {
  const std::shared_ptr<Session> session = rig_.session();
  for (const char* light : {"A", "B", "C"}) ASSERT_TRUE(add(*session, light).ok());
  rig_.engine.secondsPerLight = 3.0;
  const auto apply = [&](Operation op) {
    return session->apply(client_, test::editOf({std::move(op)}, ++sequence_)).status;
  };
  EXPECT_TRUE(apply(test::setRadiance("A", 5.0)).ok());
  EXPECT_TRUE(apply(DeleteLight{"B"}).ok());
  EXPECT_EQ(add(*session, "D").field(), "edit.max_tick_seconds");
  // Nor one that comes back from where it is kept.
  const auto kept = std::make_shared<Session>(2, 8, session->state(), rig_.services);
  const Edit dimmed = test::editOf({test::setRadiance("A", 1.0)});
  EXPECT_TRUE(kept->apply({}, dimmed).status.ok());
}

// Broken by: not checking what is imported.
TEST_F(Admission, OfACopy) {
  const std::shared_ptr<Session> session = rig_.session();
  for (const char* light : {"A", "B", "C"}) ASSERT_TRUE(add(*session, light).ok());
  Registry registry(rig_.services);
  EXPECT_TRUE(registry.create("cheap", session->state()).ok());
  rig_.engine.secondsPerLight = 3.0;
  EXPECT_EQ(registry.create("dear", session->state()).status().field(), "max_tick_seconds");
}

// Broken by: sessions that keep the limits they were made with.
TEST_F(Admission, LimitsChangeWhileSessionsLive) {
  Registry registry(rig_.services);
  const SessionPtr session = *registry.create("room", {}, {}, {});
  for (const char* light : {"A", "B", "C"}) ASSERT_TRUE(add(*session, light).ok());
  Limits wider = registry.limits();
  wider.maxTickSeconds = 2.0;
  wider.maxLights = 4;
  registry.setLimits(wider);
  EXPECT_TRUE(add(*session, "D").ok());
  EXPECT_EQ(add(*session, "E").field(), "edit.max_lights");
  const SessionPtr later = *registry.create("later", {}, {}, {});
  for (const char* light : {"A", "B", "C", "D"}) EXPECT_TRUE(add(*later, light).ok());
}

}  // namespace
}  // namespace lpv
