// Large answers: together they hold no more than their limit, whoever does not fit is told when to ask again, and
// others are answered meanwhile.

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <thread>

#include "rpc/streams/watched.h"
#include "rpc/support/details.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr double kServerLimit = 512.0 * kMiB;
constexpr int kFrameEdge = 4096;
constexpr double kPixelBytes = 12.0 * kFrameEdge * kFrameEdge;  ///< of such a frame as EXR

/// A lamp and a wall that it lights; nothing in the way of light, so that pictures are soon shaded.
std::string makePlainSession(Stubs& stubs, int cells = 8) {
  pb::SessionSettings plain = settings(cells);
  plain.set_visibility(pb::VISIBILITY_OFF);
  plain.set_bounces(0);
  const std::string session = makeSession(stubs, plain);
  apply(stubs, session, {client::createLight(light("Lamp")), client::createSurface(surface("Wall"))});
  return session;
}

pb::GetFrameRequest frameOf(const std::string& session, int edge, pb::FrameFormat format) {
  pb::GetFrameRequest request;
  request.set_session(session);
  request.set_width(edge);
  request.set_height(edge);
  request.set_format(format);
  request.set_samples(1);  // what is asked here is about bytes
  *request.mutable_camera() = camera({0.3, 0.2, 0.9}, {0, 0, 0});
  return request;
}

/// Takes the whole answer.
grpc::Status takeFrame(const std::string& address, const pb::GetFrameRequest& request) {
  Stubs stubs(address);
  Call call(std::chrono::seconds(300));
  call->set_wait_for_ready(true);
  const auto stream = stubs.result->GetFrame(call, request);
  pb::GetFrameResponse part;
  std::int64_t announced = 0, bytes = 0;
  while (stream->Read(&part)) {
    announced += part.part().header().size();
    bytes += std::int64_t(part.part().payload().size());
  }
  EXPECT_EQ(bytes, announced);
  return stream->Finish();
}

/// The answers to many calls that are made at once.
struct Burst {
  Burst(const std::string& address, const pb::GetFrameRequest& request, int calls) {
    for (int i = 0; i < calls; ++i) {
      threads.emplace_back([this, address, request] {
        const grpc::Status status = takeFrame(address, request);
        const std::lock_guard lock(mutex);
        ++ended;
        if (status.ok()) {
          ++made;
        } else {
          refused.push_back(status);
        }
      });
    }
  }
  ~Burst() { join(); }
  void join() {
    for (std::thread& thread : threads) {
      if (thread.joinable()) thread.join();
    }
  }

  std::mutex mutex;
  std::atomic<int> ended{0};
  int made = 0;
  std::vector<grpc::Status> refused;
  std::vector<std::thread> threads;
};

class Answers : public ::testing::Test {
 protected:
  double refusals(const Watched& watched) const {
    auto all = watched.scrape();
    return all["lpv_calls_refused_total{reason=\"max_answer_bytes\"}"] +
           all["lpv_calls_refused_total{reason=\"max_answer_bytes_per_session\"}"];
  }
  /// Everything is given back.
  void expectNothingHeld(const Watched& watched) {
    EXPECT_TRUE(eventually([&] { return watched.metric("lpv_answer_bytes") == 0.0; }))
        << watched.metric("lpv_answer_bytes");
  }
};

TEST_F(Answers, ManyLargeFramesAtOnceAreRefusedBeyondTheLimitAndOthersAreAnswered) {
  constexpr int kCalls = 12;
  Watched watched;
  const std::string address = watched.server().address();
  Stubs stubs(address);
  const std::string large = makePlainSession(stubs);
  const std::string small = makePlainSession(stubs);
  Burst burst(address, frameOf(large, kFrameEdge, pb::FRAME_FORMAT_EXR), kCalls);
  int answered = 0;
  while (burst.ended < kCalls) {
    EXPECT_LE(watched.metric("lpv_answer_bytes"), kServerLimit);
    EXPECT_EQ(probe(stubs, small, {{{0, 0, 0.4}, {0, 0, -1}}}).size(), 1U);
    EXPECT_THAT(takeFrame(address, frameOf(small, 64, pb::FRAME_FORMAT_PNG)), IsOk());
    ++answered;
  }
  burst.join();
  EXPECT_GT(answered, 0);
  EXPECT_GE(burst.made, 1);
  ASSERT_GE(burst.refused.size(), 1U);
  EXPECT_EQ(burst.made + int(burst.refused.size()), kCalls);
  for (const grpc::Status& status : burst.refused) {
    EXPECT_THAT(status, HasCode(StatusCode::RESOURCE_EXHAUSTED));
    EXPECT_THAT(reasonOf(status), AnyOf("MAX_ANSWER_BYTES", "MAX_ANSWER_BYTES_PER_SESSION"));
    EXPECT_GT(pauseOf(status), 0.0) << status.error_message();
    EXPECT_THAT(status.error_message(), AllOf(HasSubstr("max_answer_bytes"), HasSubstr("hold"),
                                              HasSubstr("allowed are"), HasSubstr("then ask again")));
  }
  EXPECT_EQ(refusals(watched), double(burst.refused.size()));
  const double peak = watched.metric("lpv_answer_bytes_peak");
  EXPECT_LE(peak, kServerLimit);
  EXPECT_GT(peak, kPixelBytes) << "pixels count";
  expectNothingHeld(watched);
  EXPECT_THAT(takeFrame(address, frameOf(large, kFrameEdge, pb::FRAME_FORMAT_EXR)), IsOk())
      << "who asks again is answered";
}

/// A volume of 64^3 cells: 12.6 MB, more than gRPC takes for a client that does not read.
pb::GetVolumeRequest largeVolumeOf(const std::string& session) {
  pb::GetVolumeRequest request;
  request.set_session(session);
  request.set_format(pb::VOLUME_FORMAT_FLOAT);
  request.set_compression(pb::PAYLOAD_COMPRESSION_NONE);
  return request;
}

/// What a reader that stops holds is given to others.
TEST_F(Answers, AReaderThatStopsLosesItsRoom) {
  Watched watched({"--upload-idle", "1"});
  Stubs stubs(watched.server().address());
  const std::string session = makePlainSession(stubs, 64);
  Call call;
  const auto volume = stubs.result->GetVolume(call, largeVolumeOf(session));
  EXPECT_TRUE(eventually([&] { return watched.metric("lpv_answer_bytes_peak") > 0.0; }));
  expectNothingHeld(watched);
  pb::GetVolumeResponse part;
  while (volume->Read(&part)) {
  }
  const grpc::Status ended = volume->Finish();
  EXPECT_THAT(ended, HasCode(StatusCode::DEADLINE_EXCEEDED));
  EXPECT_EQ(reasonOf(ended), "UPLOAD_IDLE");
}

/// A client that goes gives back what it held.
TEST_F(Answers, AClientThatGoesHoldsNothing) {
  Watched watched;
  Stubs stubs(watched.server().address());
  const std::string session = makePlainSession(stubs, 64);
  Call call;
  const auto volume = stubs.result->GetVolume(call, largeVolumeOf(session));
  pb::GetVolumeResponse part;
  ASSERT_TRUE(volume->Read(&part));
  EXPECT_GT(watched.metric("lpv_answer_bytes"), 0.0);
  call->TryCancel();
  expectNothingHeld(watched);
}

/// Volumes and session files are answers too. Volumes of 64^3 cells have 6.3 MB as halves.
TEST_F(Answers, OfEveryKindAreCounted) {
  Watched watched({"--max-answer-bytes", "14000000"});
  Stubs stubs(watched.server().address());
  const std::string session = makePlainSession(stubs, 64);
  client::Client client = clientOf(watched.server().address());
  pb::GetVolumeRequest volume;
  volume.set_session(session);
  EXPECT_TRUE(client.volume(volume).ok());
  EXPECT_GT(watched.metric("lpv_answer_bytes_peak"), 12e6);
  expectNothingHeld(watched);
  volume.set_format(pb::VOLUME_FORMAT_FLOAT);
  const auto refused = client.volume(volume);
  EXPECT_EQ(refused.status().reason(), Reason::kMaxAnswerBytes);
  EXPECT_EQ(refused.status().retryAfter().count(), 0) << "it can never be made";

  const std::string texels(2000 * 2000 * 3, '\x7f');
  pb::Texture texture;
  texture.set_format(pb::TEXTURE_FORMAT_RGB8_SRGB);
  texture.set_width(2000);
  texture.set_height(2000);
  texture.set_texels(texels);
  ASSERT_THAT(upload(stubs, session, pb::BLOB_KIND_TEXTURE, texture.SerializeAsString()), IsOk());
  pb::ExportSessionRequest request;
  request.set_name(session);
  Call call;
  const auto file = stubs.session->ExportSession(call, request);
  pb::ExportSessionResponse part;
  ASSERT_TRUE(file->Read(&part));
  EXPECT_GT(watched.metric("lpv_answer_bytes"), 3e6);
  while (file->Read(&part)) {
  }
  EXPECT_THAT(file->Finish(), IsOk());
  expectNothingHeld(watched);
}

TEST_F(Answers, LimitsAreConfiguredAsTheOthers) {
  const Finished printed = runServer({"--max-answer-bytes", "9000000", "--print-config"});
  EXPECT_THAT(printed.output, HasSubstr("max-answer-bytes=9000000"));
  EXPECT_THAT(printed.output, HasSubstr("max-answer-bytes-per-session=134217728"));
  pb::GetServerInfoResponse info;
  Stubs stubs(server().address());
  ASSERT_THAT(stubs.server->GetServerInfo(Call(), {}, &info), IsOk());
  EXPECT_EQ(info.limits().max_answer_bytes(), 512 * kMiB);
  EXPECT_EQ(info.limits().max_answer_bytes_per_session(), 128 * kMiB);
}

/// A call that waits for a revision that may never come takes no room.
TEST_F(Answers, WaitingTakesNoRoom) {
  Watched watched;
  Stubs stubs(watched.server().address());
  const std::string session = makePlainSession(stubs);
  pb::GetFrameRequest request = frameOf(session, kFrameEdge, pb::FRAME_FORMAT_EXR);
  request.set_min_revision(1'000'000);
  Call call;
  const auto frame = stubs.result->GetFrame(call, request);
  for (int i = 0; i < 10; ++i) {  // meanwhile it has come to the server
    EXPECT_THAT(takeFrame(watched.server().address(), frameOf(session, 256, pb::FRAME_FORMAT_PNG)), IsOk());
  }
  EXPECT_LT(watched.metric("lpv_answer_bytes_peak"), 1e6);
  call->TryCancel();
}

}  // namespace
}  // namespace lpv::rpc
