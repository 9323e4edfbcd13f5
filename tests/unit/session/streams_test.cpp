// Streams as a door drives them: uploads put together from parts, and clients that fall silent.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "api/services.h"
#include "convert/blob_content.h"
#include "reference/meshes.h"
#include "unit/session/session_rig.h"
#include "unit/session/small_engine.h"

namespace lpv::api {
namespace {

using testing::HasSubstr;

Limits impatient() {
  Limits limits = test::Rig::quick();
  limits.maxBlobBytes = 1000;
  limits.uploadIdle = std::chrono::seconds(1);
  limits.firstMessage = std::chrono::seconds(1);
  return limits;
}

class StreamsTest : public testing::Test {
 protected:
  ~StreamsTest() override {
    rig_.settle();
    rig_.timers.stop();
    rig_.pool.stop();
  }

  pb::UploadBlobRequest opening(std::int64_t size, const std::string& data = {}) {
    pb::UploadBlobRequest request;
    request.mutable_header()->set_session("sessions/room");
    request.mutable_header()->set_kind(pb::BLOB_KIND_MESH);
    request.mutable_header()->set_size(size);
    request.set_data(data);
    return request;
  }
  static pb::UploadBlobRequest more(const std::string& data) {
    pb::UploadBlobRequest request;
    request.set_data(data);
    return request;
  }
  /// How the stream ended; ok where it has not.
  template <typename Stream>
  static Status endOf(Stream& stream) {
    return stream->ended().value_or(Status());
  }
  /// The status of an upload of these messages, all sent.
  Status uploaded(const std::vector<pb::UploadBlobRequest>& messages, pb::UploadBlobResponse* response = nullptr) {
    const auto upload = uploadBlob(context_);
    for (const pb::UploadBlobRequest& message : messages) upload->receive(message);
    upload->halfClosed();
    EXPECT_TRUE(test::eventually([&] { return upload->ended().has_value(); }));
    pb::UploadBlobResponse ignored;
    upload->next(response ? response : &ignored);
    return endOf(upload);
  }

  test::SmallEngine engine_;  ///< of those who have ticks made; goes last: sessions tell it that they go
  test::Rig rig_{impatient()};
  Registry registry_{rig_.services};
  Context context_{&registry_, &rig_.pool, &rig_.timers, &rig_.counters, rig_.services.limits, {}, "", {}};
  SessionPtr session_ = *registry_.create("room", LightingSettings(), {}, "");
  std::string mesh_ = meshBytes(*reference::quad());
};

TEST_F(StreamsTest, AnUploadIsPutTogetherFromPartsOfAnySize) {
  for (const std::size_t part : {std::size_t(1), std::size_t(7), mesh_.size()}) {
    std::vector<pb::UploadBlobRequest> messages{opening(std::int64_t(mesh_.size()))};
    for (std::size_t at = 0; at < mesh_.size(); at += part) messages.push_back(more(mesh_.substr(at, part)));
    pb::UploadBlobResponse response;
    const Status status = uploaded(messages, &response);
    EXPECT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(response.hash(), sha256(mesh_));
    EXPECT_EQ(response.existed(), part != 1);
  }
  ASSERT_NE(session_->findBlob(sha256(mesh_)), nullptr);
  EXPECT_EQ(*session_->findBlob(sha256(mesh_))->bytes, mesh_);
  EXPECT_EQ(session_->summary().blobs, 1U);
}

// Seen to fail when the bytes are not counted at the end, and when they are not counted on the way.
TEST_F(StreamsTest, AnUploadOfAnotherSizeThanAnnouncedIsRefused) {
  const auto size = std::int64_t(mesh_.size());
  const std::string withMore = mesh_ + std::string("\x0a\x00", 2);  // still a mesh: an empty field follows
  EXPECT_EQ(uploaded({opening(size + 1, mesh_)}).field(), "data") << "less";
  EXPECT_THAT(uploaded({opening(size, withMore)}).message(), HasSubstr("more bytes"));
  EXPECT_THAT(uploaded({opening(size, mesh_), more("x")}).message(), HasSubstr("more bytes"));
  EXPECT_EQ(uploaded({opening(size)}).field(), "data") << "nothing";
  EXPECT_EQ(uploaded({opening(0)}).field(), "header.size");
  const Status large = uploaded({opening(1001)});
  EXPECT_EQ(large.code(), Code::kResourceExhausted);
  EXPECT_THAT(large.message(), HasSubstr("max_blob_bytes"));
  EXPECT_EQ(session_->summary().blobs, 0U);
}

TEST_F(StreamsTest, AnUploadHasItsHeaderFirstAndOnce) {
  EXPECT_EQ(uploaded({}).field(), "header");
  EXPECT_EQ(uploaded({more(mesh_)}).field(), "header");
  EXPECT_EQ(uploaded({opening(10, "0123"), opening(10, "456789")}).field(), "header");
  EXPECT_EQ(session_->summary().blobs, 0U);
}

TEST_F(StreamsTest, AnUploadThatFallsSilentEnds) {
  const auto upload = uploadBlob(context_);
  upload->receive(opening(500, "0123456789"));
  EXPECT_TRUE(test::eventually([&] { return upload->ended().has_value(); }));
  EXPECT_EQ(endOf(upload).code(), Code::kDeadlineExceeded);
  EXPECT_EQ(endOf(upload).field(), "data");
  EXPECT_THAT(endOf(upload).message(), HasSubstr("upload_idle"));
  EXPECT_THAT(endOf(upload).message(), HasSubstr("1 s"));
  upload->receive(more("late"));
  upload->halfClosed();
  rig_.settle();
  EXPECT_EQ(endOf(upload).code(), Code::kDeadlineExceeded);
  EXPECT_EQ(session_->summary().blobs, 0U);
}

// The limit is one second of silence, not of upload. Seen to fail when a part does not put the end off.
TEST_F(StreamsTest, AnUploadThatGoesOnIsNotIdle) {
  const auto upload = uploadBlob(context_);
  upload->receive(opening(500));
  auto last = Clock::now();
  Clock::duration longest{};
  for (int part = 0; part < 15; ++part) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    longest = std::max(longest, Clock::now() - last);
    upload->receive(more("0123456789"));
    last = Clock::now();
  }
  // A machine that paused this test for as long as the limit has made it silent after all.
  EXPECT_TRUE(!upload->ended() || longest > std::chrono::milliseconds(900)) << endOf(upload).message();
  upload->cancelled();
}

TEST_F(StreamsTest, WithAnotherFirstMessageAreRefused) {
  const auto volumes = streamVolume(context_);
  pb::StreamVolumeRequest early;
  early.mutable_update()->mutable_acknowledge()->set_result_id(1);
  volumes->receive(early);
  EXPECT_EQ(endOf(volumes).field(), "subscription");
  const auto edits = streamEdits(context_);
  edits->receive(pb::StreamEditsRequest());
  EXPECT_EQ(endOf(edits).field(), "session");
  const auto probes = streamProbe(context_);
  probes->halfClosed();
  EXPECT_TRUE(test::eventually([&] { return probes->ended().has_value(); }));
  EXPECT_EQ(endOf(probes).code(), Code::kInvalidArgument);
}

/// Reads changes while edits arrive as fast as they can. A watcher that takes for sent what was changed after its
/// message was made fails here in some runs only: that moment is short.
TEST_F(StreamsTest, EachSceneChangeFollowsTheOneBefore) {
  constexpr std::uint64_t kEdits = 1000;
  constexpr int kLights = 100;  // messages that take as long to make as edits to apply
  std::vector<Operation> create;
  std::vector<Operation> brighten;
  for (int i = 0; i < kLights; ++i) {
    create.push_back(test::createLight("L" + std::to_string(i)));
    brighten.push_back(test::setRadiance("L" + std::to_string(i), 2.0));
  }
  ASSERT_TRUE(session_->apply({}, test::editOf(create)).status.ok());
  const auto watch = watchScene(context_);
  pb::WatchSceneRequest request;
  request.set_session("sessions/room");
  watch->receive(request);
  pb::WatchSceneResponse message;
  ASSERT_TRUE(watch->next(&message));
  ASSERT_EQ(message.snapshot().revision(), 1U);
  std::thread writer([&] {
    for (std::uint64_t i = 0; i < kEdits; ++i) {
      EXPECT_TRUE(session_->apply({}, test::editOf(brighten)).status.ok());
    }
  });
  std::uint64_t told = 1;
  int gaps = 0;
  const auto patience = Clock::now() + std::chrono::seconds(60);
  while (told < 1 + kEdits && Clock::now() < patience) {
    message.Clear();
    if (!watch->next(&message) || !message.has_change()) continue;
    if (message.change().first_revision() != told + 1) ++gaps;
    told = message.change().last_revision();
  }
  writer.join();
  EXPECT_EQ(told, 1 + kEdits);
  EXPECT_EQ(gaps, 0);
  watch->cancelled();
}

/// Edits after one that was not taken would be there before it when it comes again.
// Seen to fail where the stream goes on.
TEST_F(StreamsTest, AnEditThatCannotBeTakenEndsTheStream) {
  const auto edits = streamEdits(context_);
  pb::StreamEditsRequest request;
  request.set_session("sessions/room");
  edits->receive(request);
  ASSERT_TRUE(registry_.quiesce().ok());
  pb::Light* lamp = request.mutable_edit()->add_operations()->mutable_create_light();
  lamp->set_name("Lamp");
  *lamp->mutable_inline_mesh() = meshToProto(*reference::quad());
  edits->receive(request);
  edits->receive(request);
  rig_.settle();
  pb::StreamEditsResponse response;
  ASSERT_TRUE(edits->next(&response));
  EXPECT_EQ(response.ack().status().code(), int(Code::kUnavailable));
  while (edits->next(&response)) EXPECT_FALSE(response.has_ack());
  EXPECT_EQ(endOf(edits).code(), Code::kUnavailable);
  EXPECT_THAT(endOf(edits).message(), HasSubstr("repeat"));
}

/// Somebody whose token was revoked, or who went, has nothing more applied than what is being applied.
// Seen to fail where what waits is left in the queue.
TEST_F(StreamsTest, EditsThatWaitAreDroppedWithTheirStream) {
  const auto edits = streamEdits(context_);
  pb::StreamEditsRequest request;
  request.set_session("sessions/room");
  edits->receive(request);
  std::promise<void> release;
  rig_.pool.post([&release] { release.get_future().wait(); });
  pb::Light* lamp = request.mutable_edit()->add_operations()->mutable_create_light();
  lamp->set_name("Lamp");
  *lamp->mutable_inline_mesh() = meshToProto(*reference::quad());
  for (int i = 0; i < 5; ++i) edits->receive(request);
  edits->cancelled();
  release.set_value();
  rig_.settle();
  EXPECT_LE(session_->revision(), 1U) << "the first was with a worker already";
}

class ResultStreams : public StreamsTest {
 protected:
  ResultStreams() { rig_.services.engine = &engine_; }

  /// Acknowledges all results there may be, and gives reasons for more.
  void acknowledgeAhead(const SessionPtr& session, const std::string& subscriber) {
    for (std::uint64_t result = 1; result <= 50; ++result) {
      ASSERT_TRUE(session->apply({}, test::editOf({test::createLight("Lamp")})).status.ok());
      pb::UpdateSubscriptionRequest update;
      update.set_session("sessions/hall");
      update.set_subscriber(subscriber);
      update.mutable_update()->mutable_acknowledge()->set_result_id(result);
      pb::UpdateSubscriptionResponse response;
      ASSERT_TRUE(updateSubscription(context_, update, &response).ok());
      rig_.settle();
    }
  }
};

/// A reader that takes nothing and acknowledges everything would have results pile up here.
// Seen to fail where an acknowledgement needs a result that is under way, and nothing else.
TEST_F(ResultStreams, WhatWasNotTakenCannotBeAcknowledged) {
  Registry registry(rig_.services);
  context_.registry = &registry;
  LightingSettings options;
  options.grid.longest = 8;
  const SessionPtr session = *registry.create("hall", options, {}, "");
  const auto stream = watchVolume(context_);
  pb::WatchVolumeRequest request;
  request.mutable_subscription()->set_session("sessions/hall");
  stream->receive(request);
  pb::WatchVolumeResponse response;
  ASSERT_TRUE(test::eventually([&] { return stream->next(&response); }));
  const std::string subscriber = response.event().subscribed().subscriber();
  ASSERT_FALSE(subscriber.empty());
  acknowledgeAhead(session, subscriber);
  EXPECT_EQ(rig_.counters.resultsSent, 1);
  // Once it is taken the next comes.
  ASSERT_TRUE(stream->next(&response));
  EXPECT_TRUE(response.event().has_part());
  acknowledgeAhead(session, subscriber);
  EXPECT_EQ(rig_.counters.resultsSent, 2);
  stream->cancelled();
  rig_.settle();
}

/// A volume that is made ahead is encoded ahead.
// Seen to fail when prepare() does nothing.
TEST_F(ResultStreams, WhatIsMadeAheadOfACreditIsEncodedOnce) {
  Registry registry(rig_.services);
  context_.registry = &registry;
  LightingSettings options;
  options.grid.longest = 8;
  const SessionPtr session = *registry.create("hall", options, {}, "");
  ASSERT_TRUE(session->apply({}, test::editOf({test::createLight("Lamp")})).status.ok());
  const auto stream = watchVolume(context_);
  pb::WatchVolumeRequest request;
  request.mutable_subscription()->set_session("sessions/hall");
  stream->receive(request);
  pb::WatchVolumeResponse response;
  ASSERT_TRUE(test::eventually([&] { return stream->next(&response); }));
  const std::shared_ptr<Subscriber> subscriber =
      session->delivery().findSubscriber(response.event().subscribed().subscriber());
  ASSERT_NE(subscriber, nullptr);
  ASSERT_TRUE(test::eventually([&] { return stream->next(&response) && response.event().has_part(); }));
  rig_.settle();
  for (int i = 0; i < 100; ++i) subscriber->roundTrip.measured(0.05);
  ASSERT_TRUE(session->apply({}, test::editOf({test::setRadiance("Lamp", 2.0)})).status.ok());
  EXPECT_TRUE(test::eventually([&] { return rig_.counters.volumesEncoded == 2; }));
  rig_.settle();
  EXPECT_EQ(rig_.counters.resultsSent, 1);
  session->delivery().acknowledge(subscriber, subscriber->taken);
  rig_.settle();
  EXPECT_EQ(rig_.counters.resultsSent, 2);
  EXPECT_EQ(rig_.counters.volumesEncoded, 2);
  ASSERT_TRUE(stream->next(&response));
  EXPECT_EQ(response.event().part().header().base_result_id(), 1U);
  stream->cancelled();
  rig_.settle();
}

}  // namespace
}  // namespace lpv::api
