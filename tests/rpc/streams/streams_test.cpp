// Result streams: one credit, newest wins, heartbeats, cameras, ends.

#include <gtest/gtest.h>

#include <thread>

#include "rpc/streams/seen.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

using VolumeStream = grpc::ClientReaderWriter<pb::StreamVolumeRequest, pb::StreamVolumeResponse>;
using FrameStream = grpc::ClientReaderWriter<pb::StreamFramesRequest, pb::StreamFramesResponse>;

class Streams : public ::testing::Test {
 protected:
  static void acknowledge(VolumeStream& stream, std::uint64_t resultId) {
    pb::StreamVolumeRequest request;
    request.mutable_update()->mutable_acknowledge()->set_result_id(resultId);
    stream.Write(request);
  }
  static void acknowledge(FrameStream& stream, std::uint64_t resultId) {
    pb::StreamFramesRequest request;
    request.mutable_update()->mutable_acknowledge()->set_result_id(resultId);
    stream.Write(request);
  }
  std::unique_ptr<VolumeStream> openVolume(Call& call, const pb::ClientIdentity& client = {}) {
    auto stream = stubs_.result->StreamVolume(call);
    pb::StreamVolumeRequest request;
    request.mutable_subscription()->set_session(session_);
    *request.mutable_subscription()->mutable_client() = client;
    stream->Write(request);
    return stream;
  }
  std::unique_ptr<FrameStream> openFrames(Call& call, bool sharpen = false) {
    auto stream = stubs_.result->StreamFrames(call);
    pb::StreamFramesRequest request;
    pb::FrameSubscription* subscription = request.mutable_subscription();
    subscription->set_session(session_);
    subscription->set_width(64);
    subscription->set_height(48);
    subscription->set_sharpen(sharpen);
    *subscription->mutable_camera()->mutable_camera() = camera({0, 0, 2}, {0, 0, 0});
    subscription->mutable_camera()->set_sequence(5);
    stream->Write(request);
    return stream;
  }
  static pb::StreamFramesRequest cameraUpdate(const glm::dvec3& eye, std::uint64_t sequence) {
    pb::StreamFramesRequest request;
    *request.mutable_update()->mutable_camera()->mutable_camera() = camera(eye, {0, 0, 0});
    request.mutable_update()->mutable_camera()->set_sequence(sequence);
    return request;
  }
  std::uint64_t brighten() {
    return apply(stubs_, session_, {client::setRadiance("Lamp", glm::dvec3(++brightness_))}).revision();
  }
  grpc::Status updateSubscription(const std::string& subscriber, const pb::SubscriberUpdate& update) {
    pb::UpdateSubscriptionRequest request;
    request.set_session(session_);
    request.set_subscriber(subscriber);
    *request.mutable_update() = update;
    pb::UpdateSubscriptionResponse response;
    return stubs_.result->UpdateSubscription(Call(), request, &response);
  }
  void removeSession() {
    pb::DeleteSessionRequest request;
    request.set_name(session_);
    pb::DeleteSessionResponse response;
    EXPECT_THAT(stubs_.session->DeleteSession(Call(), request, &response), IsOk());
  }

  Stubs stubs_{server().address()};
  std::string session_ = makeLitSession(stubs_);
  double brightness_ = 1.0;
};

// Seen to fail when the credit is not asked for, and when any acknowledgement frees it.
TEST_F(Streams, WithoutAnAcknowledgementNothingFollowsTheFirstResult) {
  Call call;
  const auto stream = openVolume(call);
  Seen<pb::StreamVolumeResponse> seen;
  ASSERT_TRUE(seen.next(*stream));
  EXPECT_EQ(seen.result.revision(), 1U);
  EXPECT_FALSE(seen.subscriber.empty());
  std::uint64_t newest = 0;
  for (int i = 0; i < 5; ++i) newest = brighten();
  seen.waitHeartbeats(*stream, 2);
  EXPECT_EQ(seen.results, 1) << "a result without credit";
  acknowledge(*stream, seen.result.result_id());
  ASSERT_TRUE(seen.next(*stream));
  EXPECT_EQ(seen.result.revision(), newest) << "made from the newest revision, the ones between were never made";
  // Acknowledged and unchanged: nothing is made again.
  acknowledge(*stream, seen.result.result_id());
  seen.waitHeartbeats(*stream, 2);
  EXPECT_EQ(seen.results, 2) << "a result without a change";
  // An acknowledgement of what was never sent, or sent long ago, gives no credit.
  newest = brighten();
  ASSERT_TRUE(seen.next(*stream));
  acknowledge(*stream, seen.result.result_id() + 1000);
  acknowledge(*stream, seen.result.result_id() - 1);
  brighten();
  seen.waitHeartbeats(*stream, 2);
  EXPECT_EQ(seen.result.revision(), newest);
}

TEST_F(Streams, TheUnaryTwinAcknowledges) {
  pb::WatchVolumeRequest request;
  request.mutable_subscription()->set_session(session_);
  request.mutable_subscription()->set_format(pb::VOLUME_FORMAT_FLOAT);
  Call call;
  const auto stream = stubs_.result->WatchVolume(call, request);
  Seen<pb::WatchVolumeResponse> seen;
  ASSERT_TRUE(seen.next(*stream));
  EXPECT_EQ(seen.header.format(), pb::VOLUME_FORMAT_FLOAT);
  brighten();
  const std::uint64_t newest = brighten();
  seen.waitHeartbeats(*stream, 1);
  EXPECT_EQ(seen.results, 1);
  pb::SubscriberUpdate update;
  update.mutable_acknowledge()->set_result_id(seen.result.result_id());
  ASSERT_THAT(updateSubscription(seen.subscriber, update), IsOk());
  ASSERT_TRUE(seen.next(*stream));
  EXPECT_EQ(seen.result.revision(), newest);
  EXPECT_THAT(updateSubscription("s-nobody", update), Refused(StatusCode::NOT_FOUND, "subscriber", "s-nobody"));
  update.set_max_rate(1000.0);
  EXPECT_THAT(updateSubscription(seen.subscriber, update),
              Refused(StatusCode::INVALID_ARGUMENT, "update.max_rate", "240"));
}

TEST_F(Streams, AReaderThatKeepsUpEndsAtTheNewestRevision) {
  const pb::ClientIdentity me = join(stubs_, session_);
  Call call;
  const auto stream = openVolume(call, me);
  constexpr std::uint64_t kEdits = 100;
  std::thread writer([&] {
    Stubs own(server().address());
    for (std::uint64_t i = 1; i <= kEdits; ++i) {
      pb::Edit edit = client::editOf({client::setRadiance("Lamp", glm::dvec3(double(i)))});
      edit.set_sequence(i);
      EXPECT_THAT(tryEdit(own, session_, edit, nullptr, me), IsOk());
    }
  });
  Seen<pb::StreamVolumeResponse> seen;
  while (seen.result.revision() < 1 + kEdits && seen.next(*stream)) {
    EXPECT_EQ(seen.result.client_sequence() + 1, seen.result.revision()) << "the highest edit of this client within";
    acknowledge(*stream, seen.result.result_id());
  }
  writer.join();
  EXPECT_EQ(seen.result.revision(), 1 + kEdits);
  EXPECT_EQ(seen.result.client_sequence(), kEdits);
  EXPECT_LE(seen.results, int(kEdits) + 1);
  const int results = seen.results;
  seen.waitHeartbeats(*stream, 1);
  EXPECT_EQ(seen.results, results);
}

TEST_F(Streams, ACameraCausesAFrameAndNoRevision) {
  Call call;
  const auto stream = openFrames(call);
  Seen<pb::StreamFramesResponse> seen;
  ASSERT_TRUE(seen.next(*stream));
  EXPECT_EQ(seen.header.camera_sequence(), 5U);
  EXPECT_EQ(seen.header.format(), pb::FRAME_FORMAT_JPEG);
  EXPECT_EQ(seen.header.width(), 64);
  acknowledge(*stream, seen.result.result_id());
  seen.waitHeartbeats(*stream, 1);
  EXPECT_EQ(seen.results, 1);
  stream->Write(cameraUpdate({0.5, 0, 2}, 6));
  ASSERT_TRUE(seen.next(*stream));
  EXPECT_EQ(seen.header.camera_sequence(), 6U);
  EXPECT_EQ(seen.result.revision(), 1U);
  EXPECT_EQ(getSession(stubs_, session_).revision(), 1U);
  acknowledge(*stream, seen.result.result_id());
  // Several at once: the newest is shown. An older one than shown is ignored.
  for (std::uint64_t sequence = 7; sequence <= 30; ++sequence) {
    stream->Write(cameraUpdate({0.02 * double(sequence), 0, 2}, sequence));
  }
  stream->Write(cameraUpdate({-1, 0, 2}, 3));
  while (seen.header.camera_sequence() < 30 && seen.next(*stream)) {
    acknowledge(*stream, seen.result.result_id());
  }
  EXPECT_EQ(seen.header.camera_sequence(), 30U);
  // And an edit causes one with the same camera.
  const std::uint64_t newest = brighten();
  while (seen.result.revision() < newest && seen.next(*stream)) {
    EXPECT_EQ(seen.header.camera_sequence(), 30U);
    acknowledge(*stream, seen.result.result_id());
  }
  pb::StreamFramesRequest larger;
  larger.mutable_update()->set_width(80);
  larger.mutable_update()->set_height(40);
  stream->Write(larger);
  while (seen.header.width() != 80 && seen.next(*stream)) acknowledge(*stream, seen.result.result_id());
  EXPECT_EQ(seen.header.height(), 40);
  EXPECT_EQ(seen.result.revision(), newest);
}

// Seen to fail when it is made like the others of a stream.
TEST_F(Streams, AtRestAFrameFollowsThatIsTheOneACallGets) {
  pb::GetFrameRequest request;
  request.set_session(session_);
  request.set_width(64);
  request.set_height(48);
  request.set_format(pb::FRAME_FORMAT_JPEG);
  *request.mutable_camera() = camera({0, 0, 2}, {0, 0, 0});
  Call call;
  const auto stream = openFrames(call, true);
  Seen<pb::StreamFramesResponse> seen;
  ASSERT_TRUE(seen.next(*stream));
  EXPECT_FALSE(seen.header.sharp());
  const pb::ResultInfo rough = seen.result;
  acknowledge(*stream, rough.result_id());
  ASSERT_TRUE(seen.next(*stream));
  EXPECT_TRUE(seen.header.sharp());
  EXPECT_EQ(seen.header.camera_sequence(), 5U);
  EXPECT_EQ(seen.result.revision(), rough.revision());
  EXPECT_NE(seen.result.checksum(), rough.checksum()) << "edges, at least";
  acknowledge(*stream, seen.result.result_id());
  Call answered;
  pb::GetFrameResponse still;
  ASSERT_TRUE(stubs_.result->GetFrame(answered, request)->Read(&still));
  EXPECT_EQ(seen.result.checksum(), still.part().header().result().checksum());
  const std::uint64_t newest = brighten();
  ASSERT_TRUE(seen.next(*stream));
  EXPECT_EQ(seen.result.revision(), newest);
  EXPECT_FALSE(seen.header.sharp());
}

TEST_F(Streams, APickThroughASubscriberSeesWhatItSees) {
  Call call;
  const auto stream = openFrames(call);
  Seen<pb::StreamFramesResponse> seen;
  ASSERT_TRUE(seen.next(*stream));
  pb::PickRequest request;
  request.set_session(session_);
  request.set_subscriber(seen.subscriber);
  request.set_x(32);
  request.set_y(24);
  pb::PickResponse response;
  ASSERT_THAT(stubs_.result->Pick(Call(), request, &response), IsOk());
  EXPECT_EQ(response.object(), "Lamp");
  request.set_x(1);
  ASSERT_THAT(stubs_.result->Pick(Call(), request, &response), IsOk());
  EXPECT_FALSE(response.hit());
}

TEST_F(Streams, AnUpdateThatIsWrongSaysWhy) {
  Call call;
  const auto stream = openFrames(call);
  Seen<pb::StreamFramesResponse> seen;
  ASSERT_TRUE(seen.next(*stream));
  stream->Write(cameraUpdate({0, 0, 0}, 7));  // eye and target are one
  while (seen.next(*stream)) {
  }
  EXPECT_THAT(stream->Finish(), Refused(StatusCode::INVALID_ARGUMENT, "update.camera.target", "camera.eye"));
  Call second;
  const auto wrong = stubs_.result->StreamVolume(second);
  pb::StreamVolumeRequest early;
  early.mutable_update()->mutable_acknowledge()->set_result_id(1);
  wrong->Write(early);
  pb::StreamVolumeResponse response;
  EXPECT_FALSE(wrong->Read(&response));
  EXPECT_THAT(wrong->Finish(), Refused(StatusCode::INVALID_ARGUMENT, "subscription", "first message"));
}

TEST_F(Streams, SubscribersAreCountedAndGoWithTheirStream) {
  {
    Call call;
    const auto stream = openVolume(call);
    Seen<pb::StreamVolumeResponse> seen;
    ASSERT_TRUE(seen.next(*stream));
    Call frames;
    const auto second = openFrames(frames);
    Seen<pb::StreamFramesResponse> seenFrames;
    ASSERT_TRUE(seenFrames.next(*second));
    EXPECT_EQ(getSession(stubs_, session_).subscriber_count(), 2);
    stream->WritesDone();
    EXPECT_FALSE(seen.next(*stream));
    EXPECT_THAT(stream->Finish(), IsOk()) << "a client that has said all ends its stream";
    // Those who did not mean to are told.
    second->WritesDone();
    pb::StreamFramesResponse last;
    while (second->Read(&last)) {
    }
    EXPECT_EQ(last.event().notice().kind(), pb::Notice::KIND_CLIENT_CLOSED);
    EXPECT_THAT(last.event().notice().message(), ::testing::HasSubstr("closed its side"));
    EXPECT_THAT(second->Finish(), IsOk());
    frames->TryCancel();
  }
  EXPECT_TRUE(eventually([&] { return getSession(stubs_, session_).subscriber_count() == 0; }));
}

TEST_F(Streams, ClosedBeforeTheySubscribedAreRefused) {
  Call call;
  const auto stream = stubs_.result->StreamFrames(call);
  stream->WritesDone();
  pb::StreamFramesResponse response;
  EXPECT_FALSE(stream->Read(&response));
  EXPECT_THAT(stream->Finish(), Refused(StatusCode::INVALID_ARGUMENT, "subscription", "before it sent"));
}

// Broken by: an update from whoever knows the subscriber's name.
TEST_F(Streams, AreUpdatedByThoseWhoOpenedThem) {
  const pb::ClientIdentity me = join(stubs_, session_);
  const pb::ClientIdentity other = join(stubs_, session_);
  Call call;
  pb::WatchVolumeRequest request;
  request.mutable_subscription()->set_session(session_);
  *request.mutable_subscription()->mutable_client() = me;
  const auto stream = stubs_.result->WatchVolume(call, request);
  pb::WatchVolumeResponse first;
  ASSERT_TRUE(stream->Read(&first));
  const auto updateAs = [&](const pb::ClientIdentity& who) {
    pb::UpdateSubscriptionRequest update;
    update.set_session(session_);
    update.set_subscriber(first.event().subscribed().subscriber());
    update.mutable_update()->set_max_rate(5.0);
    *update.mutable_client() = who;
    pb::UpdateSubscriptionResponse response;
    return stubs_.result->UpdateSubscription(Call(), update, &response);
  };
  EXPECT_THAT(updateAs({}), Refused(StatusCode::PERMISSION_DENIED, "client", "another identity"));
  EXPECT_THAT(updateAs(other), Refused(StatusCode::PERMISSION_DENIED, "client", "another identity"));
  pb::ClientIdentity forged = me;
  forged.set_secret(other.secret());
  EXPECT_THAT(updateAs(forged), Refused(StatusCode::PERMISSION_DENIED, "client", "not issued"));
  EXPECT_THAT(updateAs(me), IsOk());
  call->TryCancel();
}

TEST_F(Streams, EndWithANoticeWhenTheSessionIsDeleted) {
  Call volumes;
  const auto volumeStream = openVolume(volumes);
  Seen<pb::StreamVolumeResponse> seenVolume;
  ASSERT_TRUE(seenVolume.next(*volumeStream));
  Call frames;
  const auto frameStream = openFrames(frames);
  Seen<pb::StreamFramesResponse> seenFrame;
  ASSERT_TRUE(seenFrame.next(*frameStream));
  Call edits;
  const auto editStream = stubs_.scene->StreamEdits(edits);
  pb::StreamEditsRequest opening;
  opening.set_session(session_);
  *opening.mutable_edit() = client::editOf({client::setRadiance("Lamp", {2, 2, 2})});
  editStream->Write(opening);
  pb::StreamEditsResponse ack;
  ASSERT_TRUE(editStream->Read(&ack));
  grpc::Status waiting;
  std::thread caller([&] {
    Stubs own(server().address());
    pb::ProbeRequest request;
    request.set_session(session_);
    request.set_min_revision(100);
    pb::ProbeResponse response;
    waiting = own.result->Probe(Call(), request, &response);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // the call is waiting by then, most likely
  removeSession();
  while (seenVolume.next(*volumeStream)) {
  }
  EXPECT_EQ(seenVolume.notice.kind(), pb::Notice::KIND_DELETED);
  EXPECT_THAT(volumeStream->Finish(), HasCode(StatusCode::UNAVAILABLE));
  while (seenFrame.next(*frameStream)) {
  }
  EXPECT_EQ(seenFrame.notice.kind(), pb::Notice::KIND_DELETED);
  EXPECT_THAT(frameStream->Finish(), HasCode(StatusCode::UNAVAILABLE));
  pb::StreamEditsResponse last;
  while (editStream->Read(&ack)) last = ack;
  EXPECT_EQ(last.notice().kind(), pb::Notice::KIND_DELETED);
  EXPECT_THAT(editStream->Finish(), HasCode(StatusCode::UNAVAILABLE));
  caller.join();
  EXPECT_THAT(waiting, HasCode(StatusCode::NOT_FOUND)) << "a waiting call ends with its session";
  EXPECT_TRUE(server().running());
}

TEST_F(Streams, AreLimitedPerSession) {
  ServerProcess small({"--max-subscribers-per-session", "1"});
  Stubs stubs(small.address());
  const std::string session = makeLitSession(stubs);
  pb::WatchVolumeRequest request;
  request.mutable_subscription()->set_session(session);
  Call first;
  const auto kept = stubs.result->WatchVolume(first, request);
  pb::WatchVolumeResponse response;
  ASSERT_TRUE(kept->Read(&response));
  Call second;
  const auto refused = stubs.result->WatchVolume(second, request);
  EXPECT_FALSE(refused->Read(&response));
  const grpc::Status status = refused->Finish();
  EXPECT_THAT(status, HasCode(StatusCode::RESOURCE_EXHAUSTED));
  EXPECT_THAT(status.error_message(), ::testing::HasSubstr("max_subscribers_per_session"));
}

TEST_F(Streams, AVolumeIsSentAgainWholeOnRequest) {
  Call call;
  const auto stream = openVolume(call);
  Seen<pb::StreamVolumeResponse> seen;
  ASSERT_TRUE(seen.next(*stream));
  pb::StreamVolumeRequest request;
  request.mutable_update()->mutable_acknowledge()->set_result_id(seen.result.result_id());
  request.mutable_update()->set_request_key_frame(true);
  stream->Write(request);
  seen.waitHeartbeats(*stream, 2);
  EXPECT_EQ(seen.results, 2) << "the client lost its base and nothing else will change";
  EXPECT_EQ(seen.result.revision(), 1U);
  EXPECT_EQ(seen.header.base_result_id(), 0U);
}

}  // namespace
}  // namespace lpv::rpc
