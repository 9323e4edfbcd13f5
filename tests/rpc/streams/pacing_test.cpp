// How fast results come, how many at once, and how long the server waits for a client that says nothing.

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <thread>

#include "rpc/streams/seen.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"
#include "rpc/support/tcp_proxy.h"

namespace lpv::rpc {
namespace {

using Clock = std::chrono::steady_clock;

/// Brightens the light as fast as the server takes it, until destroyed.
class Brightener {
 public:
  Brightener(std::string address, std::string session)
      : address_(std::move(address)), session_(std::move(session)), thread_([this] { run(); }) {}
  ~Brightener() {
    stopping_ = true;
    thread_.join();
  }

 private:
  void run() {
    Stubs own(address_);
    for (int i = 1; !stopping_; ++i) apply(own, session_, {client::setRadiance("Lamp", glm::dvec3(double(i)))});
  }
  std::string address_;
  std::string session_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

class Pacing : public ::testing::Test {
 protected:
  void acknowledge(Stubs& stubs, const std::string& session, const std::string& subscriber, std::uint64_t resultId) {
    pb::UpdateSubscriptionRequest request;
    request.set_session(session);
    request.set_subscriber(subscriber);
    request.mutable_update()->mutable_acknowledge()->set_result_id(resultId);
    pb::UpdateSubscriptionResponse response;
    EXPECT_THAT(stubs.result->UpdateSubscription(Call(), request, &response), IsOk());
  }
  std::uint64_t brighten() {
    return apply(stubs_, session_, {client::setRadiance("Lamp", glm::dvec3(++brightness_))}).revision();
  }

  /// Two results come before an acknowledgement, once the first was acknowledged late; three do not.
  template <typename Response, typename Reader>
  void expectTwoInFlight(Reader& reader) {
    Seen<Response> seen;
    ASSERT_TRUE(seen.next(reader));
    brighten();
    // The first heartbeat may follow the result at once; from that to the second is longer than the interval of 1/30 s.
    seen.waitHeartbeats(reader, 2);
    EXPECT_EQ(seen.results, 1) << "a second credit before a round trip was measured";
    acknowledge(stubs_, session_, seen.subscriber, seen.result.result_id());
    ASSERT_TRUE(seen.next(reader));
    std::uint64_t newest = brighten();
    ASSERT_TRUE(seen.next(reader)) << "the second credit";
    EXPECT_EQ(seen.result.revision(), newest);
    newest = brighten();
    seen.waitHeartbeats(reader, 2);
    EXPECT_EQ(seen.results, 3) << "a third in flight";
    acknowledge(stubs_, session_, seen.subscriber, seen.result.result_id());
    ASSERT_TRUE(seen.next(reader));
    EXPECT_EQ(seen.result.revision(), newest);
  }

  /// Reads and acknowledges `count` results under constant change; the seconds that took, from before the subscription.
  double secondsFor(int count, const std::string& address, double maxRate) {
    Stubs stubs(address);
    const std::string session = makeLitSession(stubs);
    const Brightener brightener(address, session);
    pb::WatchVolumeRequest request;
    request.mutable_subscription()->set_session(session);
    request.mutable_subscription()->set_max_rate(maxRate);
    const Clock::time_point start = Clock::now();
    Call call;
    const auto reader = stubs.result->WatchVolume(call, request);
    Seen<pb::WatchVolumeResponse> seen;
    while (seen.results < count && seen.next(*reader)) {
      acknowledge(stubs, session, seen.subscriber, seen.result.result_id());
    }
    EXPECT_EQ(seen.results, count);
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  Stubs stubs_{server().address()};
  std::string session_ = makeLitSession(stubs_);
  double brightness_ = 1.0;
};

// Seen to fail when credits is not passed on, when a third result may follow, and when the round trip is not asked.
TEST_F(Pacing, AVolumeWatcherWithTwoCreditsHasTwoResultsInFlight) {
  pb::WatchVolumeRequest request;
  request.mutable_subscription()->set_session(session_);
  request.mutable_subscription()->set_credits(2);
  Call call;
  const auto reader = stubs_.result->WatchVolume(call, request);
  expectTwoInFlight<pb::WatchVolumeResponse>(*reader);
}

TEST_F(Pacing, AFrameWatcherWithTwoCreditsHasTwoResultsInFlight) {
  pb::WatchFramesRequest request;
  request.mutable_subscription()->set_session(session_);
  request.mutable_subscription()->set_credits(2);
  request.mutable_subscription()->set_width(64);
  request.mutable_subscription()->set_height(48);
  Call call;
  const auto reader = stubs_.result->WatchFrames(call, request);
  expectTwoInFlight<pb::WatchFramesResponse>(*reader);
}

// A lower bound on time, from counting: no machine is too slow for it. Seen to fail when the rate is not kept.
TEST_F(Pacing, MaxRateBoundsTheResultsOfASubscriber) {
  constexpr int kResults = 8;
  constexpr double kRate = 5.0;
  EXPECT_GE(secondsFor(kResults, server().address(), kRate), (kResults - 1) / kRate);
}

// On average: one tick more may come at once (session/delivery/pacer.h). Seen to fail when every tick may.
TEST_F(Pacing, MaxTickRateBoundsTheResultsOfASession) {
  constexpr int kResults = 8;
  ServerProcess slow({"--max-tick-rate", "5", "--max-edits-per-second", "100000"});
  EXPECT_GE(secondsFor(kResults, slow.address(), 0.0), (kResults - 2) / 5.0);
}

/// Reads frames of a light that always changes over a line of its own, and acknowledges each.
class AdaptedReader {
 public:
  AdaptedReader(const std::string& session, double rate)
      : proxy_(server().port()), session_(session), stubs_(proxy_.address()), brightener_(server().address(), session) {
    pb::WatchFramesRequest request;
    request.mutable_subscription()->set_session(session);
    request.mutable_subscription()->set_adapt_rate(rate);
    reader_ = stubs_.result->WatchFrames(call_, request);
  }
  ~AdaptedReader() { call_->TryCancel(); }

  TcpProxy& line() { return proxy_; }
  const pb::FrameHeader& header() const { return seen_.header; }
  bool next() {
    if (!seen_.next(*reader_)) return false;
    pb::UpdateSubscriptionRequest request;
    request.set_session(session_);
    request.set_subscriber(seen_.subscriber);
    request.mutable_update()->mutable_acknowledge()->set_result_id(seen_.result.result_id());
    pb::UpdateSubscriptionResponse response;
    return acknowledging_.result->UpdateSubscription(Call(), request, &response).ok();
  }
  /// Reads until `true`; false after many frames.
  bool until(const std::function<bool(const pb::FrameHeader&)>& condition) {
    for (int i = 0; i < 600; ++i) {
      if (!next()) return false;
      if (condition(header())) return true;
    }
    return false;
  }

 private:
  TcpProxy proxy_;
  const std::string session_;
  Stubs stubs_;
  Stubs acknowledging_{server().address()};
  const Brightener brightener_;
  Call call_;
  std::unique_ptr<grpc::ClientReader<pb::WatchFramesResponse>> reader_;
  Seen<pb::WatchFramesResponse> seen_;
};

// A line that carries a third of what is asked for: frames become fewer bytes, and say of what size and quality they
// are; with a wide line again they come back. Broken by: not telling the adapter of acknowledgements; not asking it for
// the size, or for the quality.
TEST_F(Pacing, FramesAreAdaptedToTheLine) {
  constexpr double kRate = 4.0;
  AdaptedReader reader(session_, kRate);
  ASSERT_TRUE(reader.next());
  const pb::FrameHeader first = reader.header();
  EXPECT_EQ(first.width(), 640);
  EXPECT_EQ(first.height(), 360);
  EXPECT_EQ(first.quality(), 85);
  reader.line().setAnswerRate(0.3 * kRate * double(first.size()));
  EXPECT_TRUE(reader.until([&](const pb::FrameHeader& h) { return 2 * h.size() < first.size(); }));
  EXPECT_LT(reader.header().quality(), 85);
  reader.line().setAnswerRate(0.05 * kRate * double(first.size()));
  EXPECT_TRUE(reader.until([&](const pb::FrameHeader& h) { return h.width() < 640 && h.height() < 360; }));
  EXPECT_NEAR(double(reader.header().width()) / reader.header().height(), 640.0 / 360.0, 0.05);
  reader.line().setAnswerRate(0.0);
  EXPECT_TRUE(reader.until([&](const pb::FrameHeader& h) { return h.width() == 640 && h.quality() == 85; }));
}

TEST_F(Pacing, OnlyJpegIsAdapted) {
  pb::WatchFramesRequest request;
  request.mutable_subscription()->set_session(session_);
  request.mutable_subscription()->set_adapt_rate(5.0);
  request.mutable_subscription()->set_format(pb::FRAME_FORMAT_PNG);
  Call call;
  const auto reader = stubs_.result->WatchFrames(call, request);
  pb::WatchFramesResponse response;
  EXPECT_FALSE(reader->Read(&response));
  EXPECT_THAT(reader->Finish(), Refused(StatusCode::INVALID_ARGUMENT, "subscription.adapt_rate", "JPEG"));
}

/// Opened and left without a word: the server ends each after its first_message limit of 10 s.
TEST(SilentClients, AreNotWaitedFor) {
  Stubs stubs(server().address());
  Call uploadCall;
  Call editCall;
  Call volumeCall;
  Call frameCall;
  Call probeCall;
  pb::UploadBlobResponse uploaded;
  const auto upload = stubs.blob->UploadBlob(uploadCall, &uploaded);
  const auto edits = stubs.scene->StreamEdits(editCall);
  const auto volumes = stubs.result->StreamVolume(volumeCall);
  const auto frames = stubs.result->StreamFrames(frameCall);
  const auto probes = stubs.result->StreamProbe(probeCall);
  const auto expectEnd = [](const grpc::Status& status, const char* name) {
    EXPECT_THAT(status, HasCode(StatusCode::DEADLINE_EXCEEDED)) << name;
    EXPECT_THAT(status.error_message(), ::testing::HasSubstr("first_message")) << name;
  };
  expectEnd(upload->Finish(), "upload");
  expectEnd(edits->Finish(), "edits");
  expectEnd(volumes->Finish(), "volumes");
  expectEnd(frames->Finish(), "frames");
  expectEnd(probes->Finish(), "probes");
  EXPECT_TRUE(server().running());
}

}  // namespace
}  // namespace lpv::rpc
