// Settings of a session: what they mean where nothing is said, what goes together, what this version refuses by name.

#include <gtest/gtest.h>

#include <functional>

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

struct Later {
  const char* name;
  const char* field;
  const char* text;
  std::function<void(pb::SessionSettings*)> set;
};

class LaterSettings : public SessionSettings, public ::testing::WithParamInterface<Later> {};

TEST_P(LaterSettings, AreRefusedByName) {
  const Later& later = GetParam();
  pb::SessionSettings wanted = settings();
  later.set(&wanted);
  const std::string field = std::string("settings.") + later.field;
  EXPECT_THAT(create(wanted), Refused(StatusCode::UNIMPLEMENTED, field, later.text));
  const std::string name = makeSession(stubs_);
  const std::string path = std::string(later.field).substr(0, std::string(later.field).find('.'));
  EXPECT_THAT(update(name, wanted, {path}), Refused(StatusCode::UNIMPLEMENTED, field, later.text));
  EXPECT_EQ(getSession(stubs_, name).revision(), 0U);
}

INSTANTIATE_TEST_SUITE_P(All, LaterSettings,
                         ::testing::Values(Later{"Visibility", "visibility", "ON",
                                                 [](auto* s) { s->set_visibility(pb::VISIBILITY_ON); }},
                                           Later{"Bounces", "bounces", "bounces", [](auto* s) { s->set_bounces(1); }},
                                           Later{"Haze", "haze", "haze", [](auto* s) { s->set_haze(0.1); }}),
                         [](const auto& row) { return row.param.name; });

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

}  // namespace
}  // namespace lpv::rpc
