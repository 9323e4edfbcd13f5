// What the server counts, and what it concludes about its device from that.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "convert/scene.h"
#include "lpv/v1/status.pb.h"
#include "ops/health.h"
#include "session/counters.h"
#include "unit/session/session_rig.h"

namespace lpv {
namespace {

using std::chrono::seconds;
using test::createLight;
using test::editOf;
using test::setRadiance;
using testing::HasSubstr;

TEST(DurationHistogram, PutsDurationsIntoTheBucketThatEndsNext) {
  DurationHistogram histogram;
  histogram.observe(0.0);
  histogram.observe(DurationHistogram::kBounds[3]);  // a bucket includes its end
  histogram.observe(DurationHistogram::kBounds[3] * 1.01);
  histogram.observe(1e6);
  EXPECT_EQ(histogram.count(0), 1);
  EXPECT_EQ(histogram.count(3), 1);
  EXPECT_EQ(histogram.count(4), 1);
  EXPECT_EQ(histogram.count(DurationHistogram::kBuckets - 1), 1);
  EXPECT_NEAR(histogram.sum(), 1e6 + 2.01 * DurationHistogram::kBounds[3], 1e-6);
}

TEST(Reason, IsTheLimitsNameOrTheCode) {
  const auto reason = [](const Status& status) { return kReasons[reasonOf(status)]; };
  EXPECT_EQ(reason(invalid("light.radiance", "light.radiance is -1")), "invalid_argument");
  EXPECT_EQ(reason(exhausted(Reason::kMaxLights, "max_lights", "max_lights: the session would hold 2, allowed are 1")
                       .within("edit")),
            "max_lights");
  EXPECT_EQ(reason({Code::kUnavailable, Reason::kDraining, "this server ends"}), "draining");
  EXPECT_EQ(reason({Code::kUnavailable, "--state-dir /var: no space left"}), "unavailable");
  EXPECT_EQ(reason({Code::kUnauthenticated, "who?"}), "unauthenticated");
  EXPECT_EQ(reason({Code::kUnavailable, "draining: words alone are no reason"}), "unavailable");
}

/// Red when a name or number in base/reason.h is another than in ErrorReason.
TEST(Reason, HasTheWiresNameAndNumber) {
  for (const ReasonName& row : kReasonNames) {
    EXPECT_EQ(v1::ErrorReason_Name(v1::ErrorReason(int(row.reason))), row.name);
    EXPECT_EQ(reasonNamed(row.name), row.reason);
  }
}

/// Red when toProto leaves the ErrorInfo out, or fromProto reads the first detail only.
TEST(Reason, CrossesTheWireBesideTheField) {
  v1::Status message;
  api::toProto(exhausted(Reason::kMaxLights, "edit", "max_lights: 2, allowed are 1"), &message);
  ASSERT_EQ(message.details_size(), 2);
  EXPECT_EQ(message.details(1).type_url(), "type.googleapis.com/google.rpc.ErrorInfo");
  const Status back = api::fromProto(message);
  EXPECT_EQ(back.reason(), Reason::kMaxLights);
  EXPECT_EQ(back.field(), "edit");
  v1::Status plain;
  api::toProto(invalid("light.radiance", "light.radiance is -1"), &plain);
  EXPECT_EQ(plain.details_size(), 1) << "the code says all";
}

/// Every limit that a refusal can name has a reason of its own.
TEST(Reason, KnowsTheLimits) {
  Limits limits;
  limits.maxClientsPerSession = 0;
  limits.maxSubscribersPerSession = 0;
  limits.maxLights = 0;
  test::Rig rig(limits);
  const auto session = rig.session();
  const auto inbox = std::make_shared<test::Inbox>();
  Subscription subscription;
  subscription.volume = VolumeStage::kTransported;
  for (const Status& status : {session->join().status(), session->delivery().subscribe(subscription, inbox).status(),
                               session->apply({}, editOf({createLight("Lamp")})).status}) {
    EXPECT_THAT(kReasons[reasonOf(status)], testing::StartsWith("max_")) << status.message();
  }
}

class CountersTest : public testing::Test {
 protected:
  CountersTest() {
    EXPECT_TRUE(session_->apply({}, editOf({createLight("Lamp")})).status.ok());
    Subscription subscription;
    subscription.volume = VolumeStage::kTransported;
    subscriber_ = *session_->delivery().subscribe(subscription, inbox_);
    rig_.settle();
  }
  ~CountersTest() override { rig_.settle(); }

  void edit() {
    EXPECT_TRUE(session_->apply({}, editOf({setRadiance("Lamp", ++brightness_)})).status.ok());
    rig_.settle();
  }
  /// A tick that somebody else wants.
  void tickForACall() {
    WaitingCall call;
    call.volume = VolumeStage::kTransported;
    call.minRevision = session_->revision();
    call.done = [](const Expected<Result>&) {};
    session_->delivery().ask(std::move(call));
    rig_.settle();
  }

  test::Rig rig_;
  Counters& counters_ = rig_.counters;
  std::shared_ptr<Session> session_ = rig_.session();
  std::shared_ptr<test::Inbox> inbox_ = std::make_shared<test::Inbox>();
  std::shared_ptr<Subscriber> subscriber_;
  double brightness_ = 1.0;
};

TEST_F(CountersTest, AReaderPassedByIsCountedOncePerTick) {
  edit();
  EXPECT_EQ(counters_.resultsCoalesced, 0) << "nothing was made that it could have had";
  tickForACall();
  EXPECT_EQ(counters_.resultsCoalesced, 1);
  edit();
  tickForACall();
  EXPECT_EQ(counters_.resultsCoalesced, 2);
  session_->delivery().acknowledge(subscriber_, inbox_->last().meta.resultId);
  rig_.settle();
  ASSERT_EQ(inbox_->count(), 2U);
  EXPECT_EQ(counters_.resultsCoalesced, 2) << "it has the newest";
}

TEST_F(CountersTest, AnAcknowledgementHasItsLag) {
  const auto acknowledgements = [this] {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < DurationHistogram::kBuckets; ++i) sum += counters_.acknowledgeLag.count(i);
    return sum;
  };
  EXPECT_EQ(acknowledgements(), 0);
  session_->delivery().acknowledge(subscriber_, inbox_->last().meta.resultId);
  EXPECT_EQ(acknowledgements(), 1);
  session_->delivery().acknowledge(subscriber_, inbox_->last().meta.resultId);
  EXPECT_EQ(acknowledgements(), 1) << "the same again is none";
}

TEST_F(CountersTest, EditsAreRejectedForAReason) {
  EXPECT_EQ(counters_.editsAccepted, 1);
  EXPECT_FALSE(session_->apply({}, editOf({setRadiance("Nobody", 1.0)})).status.ok());
  EXPECT_EQ(counters_.editsAccepted, 1);
  EXPECT_EQ(counters_.editsRejected.total(), 1);
  EXPECT_EQ(counters_.editsRejected.count(std::size_t(Code::kNotFound)), 1);
}

TEST_F(CountersTest, TicksThatFailAreToldAndCounted) {
  std::string told;
  SessionServices services = rig_.services;
  services.onEvent = [&told](SessionEvent incident, const std::string& session, const std::string& why) {
    EXPECT_EQ(incident, SessionEvent::kTickFailed);
    told = session + ": " + why;
  };
  const auto other = std::make_shared<Session>("hall", 2, 7, LightingSettings(),
                                               SessionPolicy{std::chrono::seconds(60), ""}, services);
  rig_.engine.failWith({Code::kInternal, "GL says no"});
  WaitingCall call;
  call.volume = VolumeStage::kTransported;
  call.done = [](const Expected<Result>&) {};
  other->delivery().ask(std::move(call));
  rig_.settle();
  EXPECT_EQ(told, "hall: GL says no");
  EXPECT_EQ(counters_.tickWatch.failures().count(std::size_t(Code::kInternal)), 1);
  EXPECT_EQ(counters_.tickWatch.failedInARow(), 1);
}

/// Frozen, a session keeps its streams and takes nothing; closed, it tells them, once.
TEST_F(CountersTest, AFrozenSessionTakesNothingAndSaysNothing) {
  session_->quiesce(Closing::kDraining);
  const Status refused = session_->apply({}, editOf({setRadiance("Lamp", 9.0)})).status;
  EXPECT_EQ(refused.code(), Code::kUnavailable);
  EXPECT_EQ(kReasons[reasonOf(refused)], "draining");
  EXPECT_EQ(inbox_->closed(), std::nullopt);
  session_->close(Closing::kDeleted);
  EXPECT_EQ(inbox_->closed(), Closing::kDraining) << "why it ended is why it was frozen";
}

TEST(TickWatch, KnowsHowLongNothingEnded) {
  TickWatch watch;
  const TickWatch::Clock::time_point start{};
  EXPECT_EQ(watch.stalledFor(start + seconds(1000)), seconds(0)) << "nothing was asked for";
  watch.begun(start + seconds(1000));
  EXPECT_EQ(watch.stalledFor(start + seconds(1007)), seconds(7));
  watch.begun(start + seconds(1008));
  EXPECT_EQ(watch.stalledFor(start + seconds(1010)), seconds(10)) << "another one asked for is no progress";
  watch.ended(start + seconds(1010), Status());
  EXPECT_EQ(watch.stalledFor(start + seconds(1012)), seconds(2));
  watch.ended(start + seconds(1013), Status());
  EXPECT_EQ(watch.stalledFor(start + seconds(9000)), seconds(0));
}

TEST(Health, IsReadyWhileItServesAndItsDeviceWorks) {
  test::Rig rig;
  ops::Health health(rig.counters);
  TickWatch& watch = rig.counters.tickWatch;
  const auto tick = [&watch](const Status& status) {
    watch.begun(TickWatch::Clock::now());
    watch.ended(TickWatch::Clock::now(), status);
  };
  EXPECT_EQ(health.ready().message(), "starting");
  EXPECT_TRUE(health.live().ok());
  health.serve(rig.journal, *rig.services.damaged);
  EXPECT_TRUE(health.ready().ok());

  for (int i = 0; i < ops::Health::kFailedTicks - 1; ++i) tick({Code::kInternal, "GL says no"});
  EXPECT_TRUE(health.ready().ok()) << "one session may be at fault";
  tick({Code::kInternal, "GL says no"});
  EXPECT_THAT(health.ready().message(), testing::AllOf(HasSubstr("device"), HasSubstr("GL says no")));
  tick(Status());
  EXPECT_TRUE(health.ready().ok()) << "a tick that succeeds forgives";

  tick({Code::kCancelled, "the lighting engine stops"});
  EXPECT_EQ(watch.failedInARow(), 0);
  tick({Code::kUnavailable, "the graphics device was reset"});
  tick({Code::kUnavailable, "the graphics device was reset"});
  EXPECT_THAT(health.ready().message(), HasSubstr("reset")) << "at once: there is no other context";
  tick(Status());

  const auto now = TickWatch::Clock::now();
  watch.begun(now - ops::Health::kStalled - seconds(5));
  EXPECT_THAT(health.ready().message(), HasSubstr("no tick has ended"));
  EXPECT_TRUE(health.live().ok()) << "it may still end";
  watch.ended(now, Status());
  watch.begun(now - ops::Health::kStuck - seconds(5));
  EXPECT_THAT(health.live().message(), HasSubstr("no tick has ended"));
  watch.ended(now, Status());

  rig.counters.lastSweep = now - ops::Health::kStuck - seconds(5);
  EXPECT_THAT(health.live().message(), HasSubstr("sweep"));
  rig.counters.lastSweep = TickWatch::Clock::now();
  EXPECT_TRUE(health.live().ok());

  health.stopServing();
  EXPECT_EQ(health.ready().message(), "draining");
}

}  // namespace
}  // namespace lpv
