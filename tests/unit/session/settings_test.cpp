// Settings as messages ask for them: what is not said belongs to the transport, and that to what is said.
#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

#include "convert/session.h"
#include "unit/session/session_rig.h"

namespace lpv::api {
namespace {

/// Transport, injection and lookup in one word each.
std::string words(const LightingSettings& o) {
  static const char* const kTransports[] = {"propagate", "gather", "direct"};
  static const char* const kInjections[] = {"count", "flux"};
  static const char* const kLookups[] = {"sh2", "cap", "nearest"};
  return std::string(kTransports[int(o.transport)]) + " " + kInjections[int(o.injection)] + " " +
         kLookups[int(o.lookup)];
}

struct Asked {
  const char* name;
  pb::Transport transport;
  pb::Injection injection;
  pb::InjectionMethod method;
  pb::Lookup lookup;
  const char* given;
};

pb::SessionSettings settingsOf(const Asked& asked) {
  pb::SessionSettings out;
  out.set_transport(asked.transport);
  out.set_injection(asked.injection);
  out.set_method(asked.method);
  if (asked.method == pb::INJECTION_METHOD_DENSE) out.set_dense_samples(10);
  out.set_lookup(asked.lookup);
  return out;
}

class NewSettings : public testing::TestWithParam<Asked> {};

// Broken by: COUNT without a say in the transport; a lookup that does not follow it.
TEST_P(NewSettings, AreCompletedByWhatIsSaid) {
  const Expected<SessionSettings> made = fromProto(settingsOf(GetParam()));
  ASSERT_TRUE(made.ok()) << made.status().message();
  EXPECT_EQ(words(made->options), GetParam().given);
}

constexpr auto kAnyTransport = pb::TRANSPORT_UNSPECIFIED;
constexpr auto kAnyInjection = pb::INJECTION_UNSPECIFIED;
constexpr auto kAnyMethod = pb::INJECTION_METHOD_UNSPECIFIED;
constexpr auto kAnyLookup = pb::LOOKUP_UNSPECIFIED;
constexpr auto kDense = pb::INJECTION_METHOD_DENSE;

INSTANTIATE_TEST_SUITE_P(
    All, NewSettings,
    testing::Values(
        Asked{"Nothing", kAnyTransport, kAnyInjection, kAnyMethod, kAnyLookup, "gather flux cap"},
        Asked{"Count", kAnyTransport, pb::INJECTION_COUNT, kAnyMethod, kAnyLookup, "propagate count sh2"},
        Asked{"Flux", kAnyTransport, pb::INJECTION_FLUX, kAnyMethod, kAnyLookup, "gather flux cap"},
        Asked{"Dense", kAnyTransport, kAnyInjection, kDense, kAnyLookup, "propagate count sh2"},
        Asked{"DenseFlux", kAnyTransport, pb::INJECTION_FLUX, kDense, kAnyLookup, "propagate flux sh2"},
        Asked{"Raster", kAnyTransport, kAnyInjection, pb::INJECTION_METHOD_RASTER, kAnyLookup, "gather flux cap"},
        Asked{"Propagate", pb::TRANSPORT_PROPAGATE, kAnyInjection, kAnyMethod, kAnyLookup, "propagate count sh2"},
        Asked{"Gather", pb::TRANSPORT_GATHER, kAnyInjection, kAnyMethod, kAnyLookup, "gather flux cap"},
        Asked{"Direct", pb::TRANSPORT_DIRECT, kAnyInjection, kAnyMethod, kAnyLookup, "direct flux cap"},
        Asked{"PropagateFlux", pb::TRANSPORT_PROPAGATE, pb::INJECTION_FLUX, kAnyMethod, pb::LOOKUP_CAP,
              "propagate flux cap"},
        Asked{"GatherNearest", pb::TRANSPORT_GATHER, kAnyInjection, kAnyMethod, pb::LOOKUP_NEAREST,
              "gather flux nearest"}),
    [](const auto& row) { return row.param.name; });

struct Change {
  const char* name;
  Asked before;
  Asked wanted;
  std::vector<std::string> paths;
  const char* after;
};

class ChangedSettings : public testing::TestWithParam<Change> {};

// Broken by: an injection that stays when the transport changes; one that follows where it does not change.
TEST_P(ChangedSettings, KeepWhatTheMaskDoesNotName) {
  const Expected<SessionSettings> before = fromProto(settingsOf(GetParam().before));
  ASSERT_TRUE(before.ok());
  google::protobuf::FieldMask mask;
  for (const std::string& path : GetParam().paths) mask.add_paths("settings." + path);
  const Expected<SessionSettings> after = withMask(*before, settingsOf(GetParam().wanted), mask);
  ASSERT_TRUE(after.ok()) << after.status().message();
  EXPECT_EQ(words(after->options), GetParam().after);
}

constexpr Asked kDefault{"", kAnyTransport, kAnyInjection, kAnyMethod, kAnyLookup, ""};
constexpr Asked kPaper{"", pb::TRANSPORT_PROPAGATE, kAnyInjection, kAnyMethod, kAnyLookup, ""};
constexpr Asked kPaperFlux{"", pb::TRANSPORT_PROPAGATE, pb::INJECTION_FLUX, kAnyMethod, pb::LOOKUP_CAP, ""};
constexpr Asked kGather{"", pb::TRANSPORT_GATHER, pb::INJECTION_COUNT, kAnyMethod, pb::LOOKUP_SH2, ""};

INSTANTIATE_TEST_SUITE_P(
    All, ChangedSettings,
    testing::Values(Change{"TransportTakesBothAlong", kDefault, kPaperFlux, {"transport"}, "propagate count sh2"},
                    Change{"AndBack", kPaper, kGather, {"transport"}, "gather flux cap"},
                    Change{
                        "ANamedInjectionStays", kDefault, kPaperFlux, {"injection", "transport"}, "propagate flux sh2"},
                    Change{"ANamedLookupStays", kDefault, kPaperFlux, {"transport", "lookup"}, "propagate count cap"},
                    Change{"TheSameTransportTakesNothing", kPaperFlux, kPaper, {"transport"}, "propagate flux cap"},
                    Change{"AnotherFieldTakesNothing", kPaperFlux, kDefault, {"iterations"}, "propagate flux cap"},
                    Change{"NoTransportIsGather", kPaperFlux, kDefault, {"transport"}, "gather flux cap"},
                    Change{"NoInjectionIsTheTransports", kPaperFlux, kDefault, {"injection"}, "propagate count cap"},
                    Change{"NoLookupIsTheTransports", kPaperFlux, kDefault, {"lookup"}, "propagate flux sh2"},
                    Change{"LookupAlone", kDefault, kGather, {"lookup"}, "gather flux sh2"},
                    Change{"CountWithoutTransport",
                           kDefault,
                           Asked{"", kAnyTransport, pb::INJECTION_COUNT, kAnyMethod, kAnyLookup, ""},
                           {"transport", "injection"},
                           "propagate count sh2"}),
    [](const auto& row) { return row.param.name; });

// Broken by: values taken above the highest.
TEST(SettingsFromProto, RefuseUnknownValuesByField) {
  const auto fieldOf = [](const auto& set) {
    pb::SessionSettings settings;
    set(settings);
    return fromProto(settings).status().field();
  };
  EXPECT_EQ(fieldOf([](auto& s) { s.set_transport(pb::Transport(9)); }), "settings.transport");
  EXPECT_EQ(fieldOf([](auto& s) { s.set_injection(pb::Injection(9)); }), "settings.injection");
  EXPECT_EQ(fieldOf([](auto& s) { s.set_lookup(pb::Lookup(-1)); }), "settings.lookup");
  EXPECT_EQ(fieldOf([](auto& s) { s.set_quality(pb::Quality(3)); }), "settings.quality");
}

// What an answer says is what a request may ask for again. Broken by: an answer without k.
TEST(SettingsFromProto, SurviveTheWayBack) {
  for (const LightingSettings& options : {LightingSettings(), LightingSettings::paper()}) {
    LightingSettings wanted = options;
    wanted.grid.longest = 24;
    wanted.quality = Quality::kAccurate;
    wanted.k = 3.5;
    pb::SessionSettings message;
    toProto(wanted, &message);
    const Expected<SessionSettings> back = fromProto(message);
    ASSERT_TRUE(back.ok());
    EXPECT_EQ(back->options, wanted);
  }
}

// Two who change different fields at once. Broken by: settings read before the lock is taken.
TEST(ChangeSettings, NobodysFieldIsLost) {
  constexpr int kChanges = 2000;
  test::Rig rig;
  const std::shared_ptr<Session> session = rig.session();
  const auto count = [&](const std::function<void(SessionSettings&)>& one) {
    for (int i = 0; i < kChanges; ++i) {
      const Status changed = session->changeSettings([&](SessionSettings now) {
        one(now);
        return Expected<SessionSettings>(now);
      });
      ASSERT_TRUE(changed.ok()) << changed.message();
    }
  };
  const std::chrono::seconds before = session->summary().ttl;
  std::thread other(count, [](SessionSettings& now) { ++now.policy.ttl; });
  count([](SessionSettings& now) { now.options.k = now.options.k < 2.0 ? now.options.k + 1.0 : 1.0; });
  other.join();
  EXPECT_EQ(session->summary().ttl, before + std::chrono::seconds(kChanges));
}

}  // namespace
}  // namespace lpv::api
