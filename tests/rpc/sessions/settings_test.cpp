// Settings of a session: what they mean where nothing is said, what goes together, what this version refuses by name.

#include <gtest/gtest.h>

#include <functional>
#include <glm/gtc/quaternion.hpp>

#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using ::testing::HasSubstr;

class SessionSettings : public ::testing::Test {
 protected:
  grpc::Status create(const pb::SessionSettings& settings) {
    pb::CreateSessionRequest request;
    *request.mutable_settings() = settings;
    pb::CreateSessionResponse response;
    const grpc::Status status = stubs_.session->CreateSession(Call(), request, &response);
    made_ = response.session();
    return status;
  }
  grpc::Status update(const std::string& name, const pb::SessionSettings& settings,
                      const std::vector<std::string>& fields) {
    pb::UpdateSessionRequest request;
    request.mutable_session()->set_name(name);
    *request.mutable_session()->mutable_settings() = settings;
    for (const std::string& field : fields) request.mutable_update_mask()->add_paths("settings." + field);
    pb::UpdateSessionResponse response;
    const grpc::Status status = stubs_.session->UpdateSession(Call(), request, &response);
    made_ = response.session();
    return status;
  }

  Stubs stubs_{server().address()};
  pb::Session made_;
};

// Broken by: a mask without gloss; its default for what was asked.
TEST_F(SessionSettings, GlossIsOffUntilItIsAskedFor) {
  ASSERT_THAT(create(settings()), IsOk());
  const std::string name = made_.name();
  EXPECT_EQ(getSession(stubs_, name).settings().gloss(), pb::GLOSS_OFF);
  pb::SessionSettings wanted;
  wanted.set_gloss(pb::GLOSS_ON);
  ASSERT_THAT(update(name, wanted, {"gloss"}), IsOk());
  EXPECT_EQ(getSession(stubs_, name).settings().gloss(), pb::GLOSS_ON);
  wanted.set_transport(pb::TRANSPORT_PROPAGATE);
  EXPECT_THAT(update(name, wanted, {"transport"}),
              Refused(StatusCode::INVALID_ARGUMENT, "settings.gloss", "PROPAGATE has no reflections"));
}

// Broken by: a mask without one of the three; haze that an answer leaves out; PROPAGATE with haze.
TEST_F(SessionSettings, HazeIsThereWhenItIsAskedFor) {
  pb::SessionSettings wanted = settings();
  wanted.set_haze(0.25);
  wanted.set_haze_absorption(0.5);
  wanted.set_haze_anisotropy(-0.3);
  ASSERT_THAT(create(wanted), IsOk());
  const std::string name = made_.name();
  EXPECT_EQ(getSession(stubs_, name).settings().haze(), 0.25);
  EXPECT_EQ(getSession(stubs_, name).settings().haze_absorption(), 0.5);
  wanted.set_haze(0.125);
  wanted.set_haze_absorption(0.0);
  wanted.set_haze_anisotropy(0.75);
  ASSERT_THAT(update(name, wanted, {"haze", "haze_absorption", "haze_anisotropy"}), IsOk());
  EXPECT_EQ(getSession(stubs_, name).settings().haze(), 0.125);
  EXPECT_EQ(getSession(stubs_, name).settings().haze_absorption(), 0.0);
  EXPECT_EQ(getSession(stubs_, name).settings().haze_anisotropy(), 0.75);
  wanted.set_visibility(pb::VISIBILITY_OFF);
  EXPECT_THAT(update(name, wanted, {"visibility"}),
              Refused(StatusCode::INVALID_ARGUMENT, "settings.haze", "visibility OFF"));
  wanted.set_haze(101.0);
  EXPECT_THAT(update(name, wanted, {"haze"}), Refused(StatusCode::INVALID_ARGUMENT, "settings.haze", "100"));
}

struct Transported {
  const char* name;
  std::function<void(pb::SessionSettings*)> set;
  pb::Transport transport;
  pb::Injection injection;
  pb::Lookup lookup;
  const char* feature;  ///< that its ticks report
};

class Transports : public SessionSettings, public ::testing::WithParamInterface<Transported> {};

// Settings are echoed as they are in use, and they are what ticks then do. Broken by: an answer without k; COUNT
// without a say in the transport.
TEST_P(Transports, AreChosenAtCreationAndDone) {
  pb::SessionSettings wanted = settings();
  GetParam().set(&wanted);
  ASSERT_THAT(create(wanted), IsOk());
  const std::string name = made_.name();
  const pb::SessionSettings made = getSession(stubs_, name).settings();
  EXPECT_EQ(made.transport(), GetParam().transport);
  EXPECT_EQ(made.injection(), GetParam().injection);
  EXPECT_EQ(made.lookup(), GetParam().lookup);
  EXPECT_EQ(made.k(), wanted.k());
  apply(stubs_, name, {client::createLight(light("Lamp"))});
  pb::ProbeRequest probe;
  probe.set_session(name);
  probe.set_points(packed<double>({0, 0, 0.9, 0, 0, -1}));
  pb::ProbeResponse answer;
  ASSERT_THAT(stubs_.result->Probe(Call(), probe, &answer), IsOk());
  EXPECT_THAT(answer.result().features(), ::testing::Contains(HasSubstr(GetParam().feature)));
}

INSTANTIATE_TEST_SUITE_P(
    All, Transports,
    ::testing::Values(Transported{"Default", [](auto*) {}, pb::TRANSPORT_GATHER, pb::INJECTION_FLUX, pb::LOOKUP_CAP,
                                  "gather"},
                      Transported{"Gather", [](auto* s) { s->set_transport(pb::TRANSPORT_GATHER); },
                                  pb::TRANSPORT_GATHER, pb::INJECTION_FLUX, pb::LOOKUP_CAP, "gather"},
                      Transported{"Accurate", [](auto* s) { s->set_quality(pb::QUALITY_ACCURATE); },
                                  pb::TRANSPORT_GATHER, pb::INJECTION_FLUX, pb::LOOKUP_CAP, "gather"},
                      Transported{"K", [](auto* s) { s->set_k(3.5); }, pb::TRANSPORT_GATHER, pb::INJECTION_FLUX,
                                  pb::LOOKUP_CAP, "gather"},
                      Transported{"Direct", [](auto* s) { s->set_transport(pb::TRANSPORT_DIRECT); },
                                  pb::TRANSPORT_DIRECT, pb::INJECTION_FLUX, pb::LOOKUP_CAP, "direct"},
                      Transported{"Auto", [](auto* s) { s->set_transport(pb::TRANSPORT_AUTO); }, pb::TRANSPORT_AUTO,
                                  pb::INJECTION_FLUX, pb::LOOKUP_CAP, "gather"},
                      Transported{"Propagate", [](auto* s) { s->set_transport(pb::TRANSPORT_PROPAGATE); },
                                  pb::TRANSPORT_PROPAGATE, pb::INJECTION_COUNT, pb::LOOKUP_SH2, "propagate"},
                      Transported{"Count", [](auto* s) { s->set_injection(pb::INJECTION_COUNT); },
                                  pb::TRANSPORT_PROPAGATE, pb::INJECTION_COUNT, pb::LOOKUP_SH2, "propagate"},
                      Transported{"PropagatedFlux",
                                  [](auto* s) {
                                    s->set_transport(pb::TRANSPORT_PROPAGATE);
                                    s->set_injection(pb::INJECTION_FLUX);
                                  },
                                  pb::TRANSPORT_PROPAGATE, pb::INJECTION_FLUX, pb::LOOKUP_SH2, "propagate"}),
    [](const auto& row) { return row.param.name; });

// Broken by: an injection, or a lookup, that stays.
TEST_F(SessionSettings, AChangedTransportTakesInjectionAndLookupAlong) {
  const std::string name = makeLitSession(stubs_);
  pb::SessionSettings wanted;
  wanted.set_transport(pb::TRANSPORT_PROPAGATE);
  wanted.set_lookup(pb::LOOKUP_NEAREST);
  ASSERT_THAT(update(name, wanted, {"transport"}), IsOk());
  EXPECT_EQ(made_.settings().injection(), pb::INJECTION_COUNT);
  EXPECT_EQ(made_.settings().lookup(), pb::LOOKUP_SH2);
  EXPECT_EQ(made_.revision(), 2U);
  wanted.set_transport(pb::TRANSPORT_GATHER);
  ASSERT_THAT(update(name, wanted, {"transport", "lookup"}), IsOk());
  EXPECT_EQ(made_.settings().injection(), pb::INJECTION_FLUX);
  EXPECT_EQ(made_.settings().lookup(), pb::LOOKUP_NEAREST) << "named";
  wanted.set_injection(pb::INJECTION_COUNT);
  EXPECT_THAT(update(name, wanted, {"injection"}), Refused(StatusCode::INVALID_ARGUMENT, "settings.injection",
                                                           "use injection FLUX, or transport PROPAGATE"));
  wanted.set_method(pb::INJECTION_METHOD_DENSE);
  wanted.set_dense_samples(10);
  EXPECT_THAT(update(name, wanted, {"method", "dense_samples"}),
              Refused(StatusCode::INVALID_ARGUMENT, "settings.method", "transport PROPAGATE"));
  EXPECT_EQ(getSession(stubs_, name).revision(), 3U);
}

// Broken by: k and the grid as they were asked for; an expectation of what was asked for.
TEST_F(SessionSettings, AnErrorGoalPicksWhatReachesIt) {
  pb::SessionSettings wanted = settings();
  wanted.mutable_grid()->set_automatic(true);
  wanted.set_max_error(0.003);
  ASSERT_THAT(create(wanted), IsOk());
  EXPECT_EQ(made_.grid().dims().x(), 48);
  EXPECT_TRUE(made_.settings().grid().automatic());
  EXPECT_DOUBLE_EQ(made_.expected_error(), 0.003);
  const std::string name = made_.name();
  wanted.set_max_error(0.01);
  ASSERT_THAT(update(name, wanted, {"max_error"}), IsOk());
  EXPECT_EQ(made_.grid().dims().x(), 16);
  EXPECT_LE(made_.expected_error(), 0.01);
  EXPECT_EQ(made_.revision(), 1U);
  wanted.set_max_error(0.0005);
  EXPECT_THAT(update(name, wanted, {"max_error"}),
              Refused(StatusCode::INVALID_ARGUMENT, "settings.max_error", "(0.2 %)"));
  EXPECT_EQ(getSession(stubs_, name).revision(), 1U);
}

/// A quad of 1 m by scale, rotation in degrees about x, and place.
template <typename Object>
Object placed(Object object, double scale, double degrees, const glm::dvec3& at) {
  *object.mutable_inline_mesh() = quad(0.5F);
  auto& transform = *object.mutable_transform();
  *transform.mutable_scale() = vec3(scale, scale, scale);
  const glm::dquat q = glm::angleAxis(glm::radians(degrees), glm::dvec3(1, 0, 0));
  transform.mutable_rotation()->set_w(q.w);
  transform.mutable_rotation()->set_x(q.x);
  *transform.mutable_translation() = vec3(at.x, at.y, at.z);
  return object;
}

pb::Operation lampAt(const std::string& name, double scale, const glm::dvec3& at, double degrees = 90.0) {
  return client::createLight(placed(light(name), scale, degrees, at));
}

pb::Operation wallAt(const std::string& name, double scale, const glm::dvec3& at, double degrees = -90.0) {
  return client::createSurface(placed(surface(name), scale, degrees, at));
}

/// At points of the middle.
void probe(Stubs& stubs, const std::string& session) {
  pb::ProbeRequest request;
  request.set_session(session);
  request.set_points(packed<double>({0, 0, 0.9, 0, 0, -1}));
  pb::ProbeResponse answer;
  ASSERT_THAT(stubs.result->Probe(Call(), request, &answer), IsOk());
}

// Broken by: no check; an error of another revision; a check of what was not asked for.
TEST_F(SessionSettings, ASessionMeasuresItsOwnError) {
  const std::string name = makeLitSession(stubs_, 32);
  EXPECT_FALSE(getSession(stubs_, name).has_measured_error()) << "nobody has looked";
  probe(stubs_, name);
  ASSERT_TRUE(eventually([&] { return getSession(stubs_, name).has_measured_error(); }));
  const pb::Session now = getSession(stubs_, name);
  EXPECT_EQ(now.measured_revision(), 1U);
  EXPECT_GT(now.measured_error(), 0.0);
  EXPECT_LE(now.measured_error(), 3.0 * now.expected_error());
  EXPECT_LE(now.measured_error_low(), now.measured_error());
  EXPECT_GE(now.measured_error_high(), now.measured_error());
  EXPECT_GT(now.measured_error_high(), now.measured_error_low());
  pb::GetStatsResponse stats;
  ASSERT_THAT(stubs_.server->GetStats(Call(), {}, &stats), IsOk());
  EXPECT_GE(stats.worst_measured_error(), now.measured_error());
}

struct Announced {
  const char* name;
  int cells;
  double atLeast;  ///< error that is there to be announced
  std::vector<pb::Operation> scene;
};

class Announcements : public SessionSettings, public ::testing::WithParamInterface<Announced> {};

// What a session says of its scene's error, and what its own volume then has against the closed form. Asked is a factor
// of 2 where there is half a percent. Broken by: the table; no near field; a cap for all lights.
TEST_P(Announcements, AreWithinAFactorOfTwoOfTheError) {
  pb::SessionSettings wanted;
  wanted.set_quality(pb::QUALITY_ACCURATE);
  wanted.set_bounces(0);
  wanted.set_visibility(pb::VISIBILITY_OFF);
  wanted.mutable_grid()->set_longest(GetParam().cells);
  ASSERT_THAT(create(wanted), IsOk());
  apply(stubs_, made_.name(), GetParam().scene);
  const pb::Session before = getSession(stubs_, made_.name());
  probe(stubs_, made_.name());
  ASSERT_TRUE(eventually([&] { return getSession(stubs_, made_.name()).has_measured_error(); }));
  const pb::Session now = getSession(stubs_, made_.name());
  EXPECT_EQ(now.expected_error(), before.expected_error()) << "what was measured chooses nothing";
  EXPECT_GE(now.measured_error(), GetParam().atLeast);
  const double measured = std::max(now.measured_error(), 0.005);
  EXPECT_LE(std::max(now.expected_error(), 0.005), 2.0 * measured) << now.choice();
  EXPECT_GE(std::max(now.expected_error(), 0.005), 0.5 * measured) << now.choice();
}

INSTANTIATE_TEST_SUITE_P(
    All, Announcements,
    ::testing::Values(
        Announced{"LampOverEightMetres", 16, 0.008, {lampAt("lamp", 1, {0, 2, 0}), wallAt("floor", 8, {})}},
        Announced{"LampOverTwoHundredMetres", 24, 0.005, {lampAt("lamp", 16, {0, 30, 0}), wallAt("floor", 200, {})}},
        Announced{"SmallLampOverTwoHundredMetres", 32, 0.0, {lampAt("lamp", 0.2, {0, 6, 0}), wallAt("floor", 200, {})}},
        Announced{"LampThroughAWall", 48, 0.015, {lampAt("lamp", 1, {0, 3, 0}), wallAt("wall", 4, {0, 1, 0}, 0)}},
        Announced{"RoomWithFourLights",
                  16,
                  0.0,
                  {lampAt("a", 1, {-1.5, 3.5, 0}), lampAt("b", 1, {1.5, 3.5, 0}), lampAt("c", 1, {0, 2, -1.9}, 0),
                   lampAt("d", 1, {0, 2, 1.9}, 180), wallAt("floor", 4, {}), wallAt("back", 4, {0, 2, -2}, 0)}}),
    [](const auto& row) { return row.param.name; });

// With bounces frames and probes do not look at the grid, and the session says so.
// Broken by: the volume's error.
TEST_F(SessionSettings, BouncesAreNotAsWrongAsTheGrid) {
  pb::SessionSettings wanted;
  wanted.mutable_grid()->set_longest(16);
  ASSERT_THAT(create(wanted), IsOk());
  apply(stubs_, made_.name(), {lampAt("lamp", 1, {0, 2, 0}), wallAt("floor", 8, {})});
  probe(stubs_, made_.name());
  ASSERT_TRUE(eventually([&] { return getSession(stubs_, made_.name()).has_measured_error(); }));
  const pb::Session now = getSession(stubs_, made_.name());
  EXPECT_LE(now.expected_error(), 0.001);
  EXPECT_LE(now.measured_error(), 0.001);
  EXPECT_THAT(now.choice(), AllOf(HasSubstr("look at the lights"), HasSubstr("Volumes: 16 cells")));
}

// Broken by: 32 cells whatever the scene; a choice that says nothing.
TEST_F(SessionSettings, AnAutomaticGridIsTheScenes) {
  pb::SessionSettings wanted;
  wanted.mutable_grid()->set_automatic(true);
  wanted.set_max_error(0.01);
  ASSERT_THAT(create(wanted), IsOk());
  const std::string name = made_.name();
  apply(stubs_, name, {wallAt("floor", 8, {})});
  apply(stubs_, name, {lampAt("lamp", 1, {0, 2, 0})});
  EXPECT_EQ(getSession(stubs_, name).grid().dims().x(), 24);
  EXPECT_THAT(getSession(stubs_, name).choice(),
              HasSubstr("24 cells along the longest edge: 16 are predicted to miss 1 %"));
  EXPECT_LE(getSession(stubs_, name).expected_error(), 0.01);
  apply(stubs_, name, {moveTo("lamp", {0, 1.9, 0.1})});
  EXPECT_EQ(getSession(stubs_, name).grid().dims().x(), 24) << "never under a moving light";
  wanted.set_transport(pb::TRANSPORT_PROPAGATE);
  wanted.set_max_error(0.0);
  ASSERT_THAT(update(name, wanted, {"transport", "max_error"}), IsOk());
  apply(stubs_, name, {moveTo("lamp", {90, 2, 0})});
  EXPECT_THAT(getSession(stubs_, name).choice(),
              HasSubstr("light lamp lies outside the grid: PROPAGATE gives it no light"));
}

}  // namespace
}  // namespace lpv::rpc
