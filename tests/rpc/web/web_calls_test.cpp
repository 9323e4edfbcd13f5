// Calls over a browser's socket: the same as over gRPC, message for message.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <google/protobuf/util/message_differencer.h>
#include <csignal>

#include "rpc/web/browsers.h"

namespace lpv::rpc {
namespace {

using google::protobuf::util::MessageDifferencer;
using testing::HasSubstr;

pb::StreamFramesRequest watchFrames(const std::string& session) {
  pb::StreamFramesRequest out;
  pb::FrameSubscription& frames = *out.mutable_subscription();
  frames.set_session(session);
  frames.set_width(64);
  frames.set_height(64);
  *frames.mutable_camera()->mutable_camera() = camera({0, 0, 3}, {0, 0, 0});
  return out;
}

class WebCalls : public testing::Test {
 protected:
  Stubs stubs_{browsers().server().address()};
  PageClient page_{browsers().port()};
};

TEST_F(WebCalls, AnswersAndRefusalsAreThoseOfGrpc) {
  EXPECT_EQ(page_.welcome().version(), [&] {
    pb::GetServerInfoResponse info;
    Call call;
    EXPECT_THAT(stubs_.server->GetServerInfo(call, {}, &info), IsOk());
    return info.version();
  }());
  pb::CreateSessionRequest create;
  *create.mutable_settings() = settings();
  pb::CreateSessionResponse made;
  EXPECT_EQ(page_.call("SessionService/CreateSession", create, &made).code(), 0);
  pb::GetSessionRequest get;
  get.set_name(made.session().name());
  pb::GetSessionResponse byWeb, byGrpc;
  EXPECT_EQ(page_.call("SessionService/GetSession", get, &byWeb).code(), 0);
  Call good;
  EXPECT_THAT(stubs_.session->GetSession(good, get, &byGrpc), IsOk());
  EXPECT_TRUE(MessageDifferencer::Equals(byWeb, byGrpc)) << byWeb.DebugString() << byGrpc.DebugString();

  get.set_name("sessions/nobody-made-it");
  pb::ApplyEditRequest wrong;
  wrong.set_session(made.session().name());
  wrong.mutable_edit()->add_operations()->mutable_create_light()->set_name("no mesh");
  const pb::Status missing = page_.call("SessionService/GetSession", get, &byWeb);
  pb::ApplyEditResponse applied;
  const pb::Status invalid = page_.call("SceneService/ApplyEdit", wrong, &applied);
  Call first, second;
  const grpc::Status missingByGrpc = stubs_.session->GetSession(first, get, &byGrpc);
  const grpc::Status invalidByGrpc = stubs_.scene->ApplyEdit(second, wrong, &applied);
  for (const auto& [web, over] : {std::pair(missing, missingByGrpc), {invalid, invalidByGrpc}}) {
    pb::Status details;
    ASSERT_TRUE(details.ParseFromString(over.error_details()));
    EXPECT_NE(web.code(), 0);
    EXPECT_TRUE(MessageDifferencer::Equals(web, details)) << web.DebugString() << details.DebugString();
  }
}

TEST_F(WebCalls, UnknownMethodsAndBytesThatAreNoMessageEndTheirCallAlone) {
  const std::uint32_t unknown = page_.begin("SceneService/Explode");
  EXPECT_EQ(page_.endOf(unknown).code(), int(StatusCode::UNIMPLEMENTED));
  EXPECT_THAT(page_.endOf(unknown).message(), HasSubstr("lpv.v1.SceneService/Explode"));
  const std::uint32_t call = page_.begin("SessionService/GetSession");
  web::v1::ToServer nonsense;
  nonsense.set_call(call);
  nonsense.set_message("\xff\xff\xff");
  page_.say(nonsense);
  EXPECT_EQ(page_.endOf(call).code(), int(StatusCode::INVALID_ARGUMENT));
  EXPECT_THAT(page_.endOf(call).message(), HasSubstr("lpv.v1.GetSessionRequest"));
  pb::GetServerInfoResponse info;
  EXPECT_EQ(page_.call("ServerService/GetServerInfo", pb::GetServerInfoRequest(), &info).code(), 0);
}

// A stream of frames that are acknowledged, edits on another stream, and their picture, on one socket.
TEST_F(WebCalls, StreamsRunBesideEachOther) {
  const std::string session = makeLitSession(stubs_);
  apply(stubs_, session, {client::createSurface(surface("Wall"))});
  const std::uint32_t frames = page_.begin("ResultService/StreamFrames");
  page_.message(frames, watchFrames(session));
  const std::uint32_t edits = page_.begin("SceneService/StreamEdits");
  pb::StreamEditsRequest edit;
  edit.set_session(session);
  page_.message(edits, edit);

  std::uint64_t wanted = 0;
  std::uint64_t shown = 0;
  for (int moved = 0; moved < 3;) {
    pb::StreamFramesResponse response;
    ASSERT_TRUE(page_.next(frames, &response)) << page_.endOf(frames).message();
    const pb::FrameEvent& event = response.event();
    if (!event.has_part()) continue;
    ASSERT_TRUE(event.part().has_header()) << "such a picture has one part";
    shown = event.part().header().result().revision();
    pb::StreamFramesRequest told;
    told.mutable_update()->mutable_acknowledge()->set_result_id(event.part().result_id());
    page_.message(frames, told);
    if (shown < wanted) continue;
    ++moved;
    pb::StreamEditsRequest move;
    *move.mutable_edit()->add_operations() = moveTo("Lamp", {0.1 * moved, 0, 0});
    page_.message(edits, move);
    pb::StreamEditsResponse answer;
    do {
      ASSERT_TRUE(page_.next(edits, &answer));
    } while (!answer.has_ack());
    EXPECT_EQ(answer.ack().status().code(), 0) << answer.DebugString();
    wanted = answer.ack().revision();
  }
  EXPECT_GT(wanted, 2U);
  EXPECT_GE(page_.taken(frames), 3U);
  page_.cancel(frames);
  EXPECT_EQ(page_.endOf(frames).code(), int(StatusCode::CANCELLED));
  page_.end(edits);
  EXPECT_EQ(page_.endOf(edits).code(), 0) << page_.endOf(edits).message();
}

TEST_F(WebCalls, AnUploadIsTakenPartByPart) {
  const std::string session = makeSession(stubs_);
  const std::string bytes = sheet(220).SerializeAsString();
  const std::uint32_t call = page_.begin("BlobService/UploadBlob");
  constexpr std::size_t kPart = 100'000;
  std::uint32_t sent = 0;
  for (std::size_t from = 0; from < bytes.size(); from += kPart) {
    while (sent - page_.taken(call) >= 8) ASSERT_TRUE(page_.pump());
    pb::UploadBlobRequest part;
    if (from == 0) {
      part.mutable_header()->set_session(session);
      part.mutable_header()->set_kind(pb::BLOB_KIND_MESH);
      part.mutable_header()->set_size(std::int64_t(bytes.size()));
    }
    part.set_data(bytes.substr(from, kPart));
    page_.message(call, part);
    ++sent;
  }
  page_.end(call);
  pb::UploadBlobResponse response;
  ASSERT_TRUE(page_.next(call, &response)) << page_.endOf(call).message();
  EXPECT_EQ(response.hash(), sha256(bytes));
  EXPECT_EQ(page_.endOf(call).code(), 0);
  EXPECT_EQ(page_.taken(call), sent);
}

TEST_F(WebCalls, TimeoutsEndCalls) {
  const std::uint32_t call = page_.begin("ResultService/StreamFrames", 300);
  page_.message(call, watchFrames(makeLitSession(stubs_)));
  EXPECT_EQ(page_.endOf(call).code(), int(StatusCode::DEADLINE_EXCEEDED));
  EXPECT_THAT(page_.endOf(call).message(), HasSubstr("timeout_ms"));
}

// What a page leaves open when its socket goes is given up. Broken by: a socket that goes without telling its calls.
TEST_F(WebCalls, ALostSocketEndsItsStreams) {
  const std::string session = makeLitSession(stubs_);
  {
    PageClient leaving(browsers().port());
    const std::uint32_t frames = leaving.begin("ResultService/StreamFrames");
    leaving.message(frames, watchFrames(session));
    pb::StreamFramesResponse response;
    ASSERT_TRUE(leaving.next(frames, &response));
    EXPECT_EQ(browsers().watched().metric("lpv_subscribers"), 1.0);
  }
  EXPECT_TRUE(eventually([] { return browsers().watched().metric("lpv_subscribers") == 0.0; }));
  EXPECT_TRUE(eventually([] { return browsers().watched().metric("lpv_web_sockets") == 1.0; })) << "page_'s own";
}

TEST(WebTokens, AreShownInTheFirstMessage) {
  const std::string admin = "an admin's token, for a test of browsers";
  const std::string folder = makeDirectory();
  std::ofstream(folder + "/admin") << admin << "\n";
  Browsers closed({"--admin-token-file", folder + "/admin", "--first-message", "1"});
  pb::GetServerInfoResponse info;
  PageClient stranger(closed.port());
  EXPECT_EQ(stranger.call("ServerService/GetServerInfo", pb::GetServerInfoRequest(), &info).code(),
            int(StatusCode::UNAUTHENTICATED));
  PageClient known(closed.port(), admin);
  EXPECT_EQ(known.call("ServerService/GetServerInfo", pb::GetServerInfoRequest(), &info).code(), 0);
  // Whoever shows none that is good does not stay.
  while (stranger.pump()) {
  }
  EXPECT_EQ(stranger.closed()->closeCode(), 4401) << stranger.closed()->closeReason();
  EXPECT_EQ(closed.refused("token"), 1.0);
  EXPECT_EQ(known.call("ServerService/GetServerInfo", pb::GetServerInfoRequest(), &info).code(), 0)
      << "who has shown one stays";
  // A token that is shown later is of calls that begin then.
  PageClient later(closed.port());
  web::v1::ToServer hello;
  hello.mutable_hello()->set_token(admin);
  later.say(hello);
  EXPECT_EQ(later.call("ServerService/GetServerInfo", pb::GetServerInfoRequest(), &info).code(), 0);
  EXPECT_THAT(closed.server().log(), testing::Not(HasSubstr(admin)));
  std::filesystem::remove_all(folder);
}

TEST(WebDrain, StreamsHaveTheirNoticeAndSocketsAreClosed) {
  Browsers leaving;
  std::string session;
  {
    // An idle channel looks every 5 s whether its server has ended, and would keep it for so long.
    Stubs stubs(leaving.server().address());
    session = makeLitSession(stubs);
  }
  PageClient page(leaving.port());
  const std::uint32_t frames = page.begin("ResultService/StreamFrames");
  page.message(frames, watchFrames(session));
  pb::StreamFramesResponse response;
  ASSERT_TRUE(page.next(frames, &response));
  leaving.server().process().signal(SIGTERM);
  bool told = false;
  while (page.next(frames, &response)) told = told || response.event().has_notice();
  EXPECT_TRUE(told);
  EXPECT_EQ(page.endOf(frames).code(), int(StatusCode::UNAVAILABLE));
  while (page.pump()) {
  }
  EXPECT_EQ(page.closed()->closeCode(), 1001);
  EXPECT_EQ(leaving.server().process().wait(), 0) << leaving.server().log();
}

}  // namespace
}  // namespace lpv::rpc
