// Streams through HAProxy (Debian's, HTTP/2 on both sides) with timeouts of 4 s: heartbeats keep idle ones alive.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <latch>
#include <thread>

#include "rpc/streams/seen.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

/// Twice the timeouts and one more, of one second each.
constexpr int kIdleHeartbeats = 9;

/// haproxy before a server, on a socket in a folder of its own.
class Haproxy {
 public:
  explicit Haproxy(int port) {
    std::ofstream(directory_ + "/haproxy.cfg") << "defaults\n"
                                                  "    mode http\n"
                                                  "    timeout connect 2s\n"
                                                  "    timeout client 4s\n"
                                                  "    timeout server 4s\n"
                                                  "    option http-no-delay\n"
                                                  "frontend grpc_in\n"
                                                  "    bind unix@"
                                               << socket()
                                               << " proto h2\n"
                                                  "    default_backend lpvd\n"
                                                  "backend lpvd\n"
                                                  "    server lpvd 127.0.0.1:"
                                               << port << " proto h2\n";
    process_ = std::make_unique<ChildProcess>(HAPROXY_PATH,
                                              std::vector<std::string>{"-db", "-f", directory_ + "/haproxy.cfg"});
    EXPECT_TRUE(eventually([this] { return std::filesystem::exists(socket()); })) << errors();
  }
  ~Haproxy() {
    process_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }
  Haproxy(const Haproxy&) = delete;
  Haproxy& operator=(const Haproxy&) = delete;

  std::string address() const { return "unix:" + socket(); }
  std::string errors() const { return process_->output() + process_->errors(); }

 private:
  std::string socket() const { return directory_ + "/socket"; }

  const std::string directory_ = makeDirectory();
  std::unique_ptr<ChildProcess> process_;
};

class BehindHaproxy : public ::testing::Test {
 protected:
  using Edits = grpc::ClientReaderWriter<pb::StreamEditsRequest, pb::StreamEditsResponse>;

  /// The scene's snapshot, then nothing but heartbeats, then the change.
  void watchScene() {
    Call call;
    pb::WatchSceneRequest request;
    request.set_session(session_);
    const auto stream = stubs_.scene->WatchScene(call, request);
    pb::WatchSceneResponse event;
    int heartbeats = 0;
    while (heartbeats < kIdleHeartbeats && stream->Read(&event)) heartbeats += event.has_heartbeat() ? 1 : 0;
    EXPECT_EQ(heartbeats, kIdleHeartbeats) << "the stream of the scene ended";
    idle_.count_down();
    while (!event.has_change() && stream->Read(&event)) {
    }
    EXPECT_EQ(event.change().last_revision(), 2U) << "the stream of the scene ended";
    call->TryCancel();
  }

  /// Only the server speaks: the client has nothing to acknowledge but the first result, by a call.
  void watchVolume() {
    Call call;
    pb::WatchVolumeRequest request;
    request.mutable_subscription()->set_session(session_);
    const auto stream = stubs_.result->WatchVolume(call, request);
    Seen<pb::WatchVolumeResponse> seen;
    EXPECT_TRUE(seen.next(*stream));
    pb::UpdateSubscriptionRequest update;
    update.set_session(session_);
    update.set_subscriber(seen.subscriber);
    update.mutable_update()->mutable_acknowledge()->set_result_id(seen.result.result_id());
    pb::UpdateSubscriptionResponse updated;
    EXPECT_THAT(stubs_.result->UpdateSubscription(Call(), update, &updated), IsOk());
    seen.waitHeartbeats(*stream, kIdleHeartbeats);
    idle_.count_down();
    EXPECT_TRUE(seen.next(*stream));
    EXPECT_EQ(seen.result.revision(), 2U);
    call->TryCancel();
  }

  template <typename Request, typename Response>
  void exchange(grpc::ClientReaderWriter<Request, Response>& stream, grpc::ClientContext* context) {
    Request request;
    request.mutable_subscription()->set_session(session_);
    stream.Write(request);
    Seen<Response> seen;
    EXPECT_TRUE(seen.next(stream));
    request.mutable_update()->mutable_acknowledge()->set_result_id(seen.result.result_id());
    stream.Write(request);
    seen.waitHeartbeats(stream, kIdleHeartbeats);
    idle_.count_down();
    EXPECT_TRUE(seen.next(stream));
    EXPECT_EQ(seen.result.revision(), 2U);
    context->TryCancel();
  }
  void streamVolume() {
    Call call;
    exchange(*stubs_.result->StreamVolume(call), call);
  }
  void streamFrames() {
    Call call;
    exchange(*stubs_.result->StreamFrames(call), call);
  }

  /// An edit over a stream on which nothing but heartbeats came.
  void edit() {
    Call call;
    const auto stream = stubs_.scene->StreamEdits(call);
    pb::StreamEditsRequest request;
    request.set_session(session_);
    stream->Write(request);
    pb::StreamEditsResponse response;
    int heartbeats = 0;
    while (heartbeats < kIdleHeartbeats && stream->Read(&response)) heartbeats += response.has_heartbeat() ? 1 : 0;
    EXPECT_EQ(heartbeats, kIdleHeartbeats) << "the stream of edits ended";
    idle_.wait();
    *request.mutable_edit() = client::editOf({client::setRadiance("Lamp", {2, 2, 2})});
    EXPECT_TRUE(stream->Write(request));
    while (!response.has_ack() && stream->Read(&response)) {
    }
    EXPECT_EQ(response.ack().revision(), 2U) << "the stream of edits ended";
    call->TryCancel();
  }

  Haproxy haproxy_{server().port()};
  Stubs stubs_{haproxy_.address()};
  std::string session_ = makeLitSession(stubs_);
  std::latch idle_{4};
};

// Seen to fail with heartbeats every 10 s.
TEST_F(BehindHaproxy, IdleStreamsLive) {
  std::vector<std::thread> readers;
  readers.emplace_back([this] { watchScene(); });
  readers.emplace_back([this] { watchVolume(); });
  readers.emplace_back([this] { streamVolume(); });
  readers.emplace_back([this] { streamFrames(); });
  edit();
  for (std::thread& reader : readers) reader.join();
  EXPECT_FALSE(HasFailure()) << haproxy_.errors();
}

// That the timeouts above are in force: a call that waits in silence is ended by them.
TEST_F(BehindHaproxy, WhatIsSilentIsCut) {
  pb::ProbeRequest request;
  request.set_session(session_);
  request.set_min_revision(1'000'000);
  request.set_points(packed<double>({0, 0, 0.4, 0, 0, -1}));
  pb::ProbeResponse response;
  const grpc::Status status = stubs_.result->Probe(Call(), request, &response);
  EXPECT_FALSE(status.ok());
  EXPECT_NE(status.error_code(), StatusCode::DEADLINE_EXCEEDED) << status.error_message();
}

}  // namespace
}  // namespace lpv::rpc
