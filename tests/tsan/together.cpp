#include "tsan/together.h"

#include <gmock/gmock.h>

#include <map>
#include <optional>
#include <vector>

#include "convert/blob_content.h"
#include "reference/meshes.h"

namespace lpv::test {

pb::Operation moving(double x) {
  pb::Operation out;
  pb::UpdateLight* update = out.mutable_update_light();
  update->mutable_light()->set_name("Lamp");
  update->mutable_light()->mutable_transform()->mutable_translation()->set_x(x);
  update->mutable_update_mask()->add_paths("transform.translation");
  return out;
}

void Together::makeRoom(const std::string& id, std::int64_t ttl) {
  pb::CreateSessionRequest request;
  request.set_session_id(id);
  request.mutable_settings()->mutable_grid()->set_longest(8);
  request.mutable_settings()->mutable_ttl()->set_seconds(ttl);
  pb::CreateSessionResponse made;
  const Status status = house().ask(api::createSession, request, &made);
  ASSERT_TRUE(status.ok()) << status.message();
  pb::ApplyEditRequest furniture;
  furniture.set_session("sessions/" + id);
  pb::Light* lamp = furniture.mutable_edit()->add_operations()->mutable_create_light();
  lamp->set_name("Lamp");
  *lamp->mutable_inline_mesh() = api::meshToProto(*reference::quad());
  pb::Surface* wall = furniture.mutable_edit()->add_operations()->mutable_create_surface();
  wall->set_name("Wall");
  *wall->mutable_inline_mesh() = api::meshToProto(*reference::pyramid());
  pb::ApplyEditResponse applied;
  ASSERT_TRUE(house().ask(api::applyEdit, furniture, &applied).ok());
}

pb::ClientIdentity Together::join(const std::string& room) {
  pb::JoinSessionRequest request;
  request.set_session(room);
  request.set_display_name("Somebody");
  pb::JoinSessionResponse response;
  EXPECT_TRUE(house().ask(api::joinSession, request, &response).ok());
  return response.client();
}

void Together::leave(const pb::ClientIdentity& client) {
  pb::LeaveSessionRequest request;
  request.set_session("sessions/room");
  *request.mutable_client() = client;
  pb::LeaveSessionResponse response;
  EXPECT_TRUE(house().ask(api::leaveSession, request, &response).ok());
}

std::uint64_t Together::revision(const std::string& name) {
  pb::GetSessionRequest request;
  request.set_name(name);
  pb::GetSessionResponse response;
  EXPECT_TRUE(house().ask(api::getSession, request, &response).ok());
  return response.session().revision();
}

void Together::edit(const pb::ClientIdentity& client, int round, std::atomic<std::uint64_t>& accepted) {
  pb::ApplyEditRequest request;
  request.set_session("sessions/room");
  *request.mutable_client() = client;
  request.mutable_edit()->set_sequence(std::uint64_t(round) + 1);
  *request.mutable_edit()->add_operations() = moving(round);
  pb::ApplyEditResponse response;
  const Status status = house().ask(api::applyEdit, request, &response);
  if (status.ok()) ++accepted;
  EXPECT_TRUE(status.ok()) << status.message();
  if (client.client_id().empty()) return;  // nobody's sequences are not remembered
  pb::ApplyEditResponse repeated;
  EXPECT_TRUE(house().ask(api::applyEdit, request, &repeated).ok());
  EXPECT_EQ(repeated.ack().revision(), response.ack().revision());
}

void Together::takeBack(const pb::ClientIdentity& client, std::atomic<std::uint64_t>& accepted) {
  pb::UndoRequest undo;
  undo.set_session("sessions/room");
  *undo.mutable_client() = client;
  pb::UndoResponse undone;
  if (house().ask(api::undo, undo, &undone).ok()) ++accepted;
  pb::RedoRequest redo;
  redo.set_session("sessions/room");
  *redo.mutable_client() = client;
  pb::RedoResponse redone;
  if (house().ask(api::redo, redo, &redone).ok()) ++accepted;
}

void Together::beSeen(const pb::ClientIdentity& client) {
  pb::UpdatePresenceRequest request;
  request.set_session("sessions/room");
  *request.mutable_client() = client;
  request.mutable_presence()->add_selection("Lamp");
  pb::UpdatePresenceResponse seen;
  EXPECT_TRUE(house().ask(api::updatePresence, request, &seen).ok());
  for (const int seconds : {1, 0}) {
    pb::LockObjectsRequest lock;
    lock.set_session("sessions/room");
    *lock.mutable_client() = client;
    lock.add_objects("Wall");
    lock.mutable_ttl()->set_seconds(seconds);
    pb::LockObjectsResponse locked;
    (void)house().ask(api::lockObjects, lock, &locked);  // another may have it
  }
}

void Together::streamEdits(int edits, std::atomic<std::uint64_t>& accepted) {
  pb::StreamEditsRequest first;
  first.set_session("sessions/room");
  *first.mutable_client() = join();
  const auto guest = Guest<pb::StreamEditsRequest, pb::StreamEditsResponse>::open(
      api::streamEdits(house().context()), first,
      [&](const pb::StreamEditsResponse& response) -> std::optional<pb::StreamEditsRequest> {
        if (response.has_ack() && response.ack().status().code() == 0) ++accepted;
        return std::nullopt;
      });
  for (int i = 0; i < edits; ++i) {
    pb::StreamEditsRequest request;
    request.mutable_edit()->set_sequence(std::uint64_t(i) + 1);
    *request.mutable_edit()->add_operations() = moving(i);
    guest->say(request);
  }
  guest->finish();
  const Status end = guest->end();
  EXPECT_TRUE(end.ok()) << end.message();
  guest->leave();
  leave(first.client());
}

void Together::watchVolumes(bool leavesEarly) {
  pb::StreamVolumeRequest first;
  first.mutable_subscription()->set_session("sessions/room");
  first.mutable_subscription()->set_format(pb::VOLUME_FORMAT_COMPACT);
  first.mutable_subscription()->set_credits(2);
  const auto guest = Guest<pb::StreamVolumeRequest, pb::StreamVolumeResponse>::open(
      api::streamVolume(house().context()), first,
      [](const pb::StreamVolumeResponse& response) -> std::optional<pb::StreamVolumeRequest> {
        if (!response.event().has_part()) return std::nullopt;
        pb::StreamVolumeRequest reply;
        reply.mutable_update()->mutable_acknowledge()->set_result_id(response.event().part().result_id());
        return reply;
      });
  if (!leavesEarly) {
    EXPECT_GE(guest->await(4), 4);
  }
  guest->leave();
}

void Together::watchFrames() {
  pb::StreamFramesRequest first;
  first.mutable_subscription()->set_session("sessions/room");
  first.mutable_subscription()->set_width(16);
  first.mutable_subscription()->set_height(16);
  std::uint64_t sequence = 0;
  const auto guest = Guest<pb::StreamFramesRequest, pb::StreamFramesResponse>::open(
      api::streamFrames(house().context()), first,
      [&sequence](const pb::StreamFramesResponse& response) -> std::optional<pb::StreamFramesRequest> {
        if (!response.event().has_part()) return std::nullopt;
        pb::StreamFramesRequest reply;
        reply.mutable_update()->mutable_acknowledge()->set_result_id(response.event().part().result_id());
        reply.mutable_update()->mutable_camera()->mutable_camera()->mutable_eye()->set_z(double(++sequence));
        reply.mutable_update()->mutable_camera()->mutable_camera()->mutable_target();
        reply.mutable_update()->mutable_camera()->set_sequence(sequence);
        return reply;
      });
  EXPECT_GE(guest->await(3), 3);
  guest->leave();
}

void Together::watchScene(const pb::ClientIdentity& client) {
  pb::WatchSceneRequest request;
  request.set_session("sessions/room");
  *request.mutable_client() = client;
  std::uint64_t told = 0;
  const auto guest = Guest<pb::WatchSceneRequest, pb::WatchSceneResponse>::open(
      api::watchScene(house().context()), request,
      [&told](const pb::WatchSceneResponse& response) -> std::optional<pb::WatchSceneRequest> {
        if (response.has_snapshot()) told = response.snapshot().revision();
        if (response.has_change()) {
          EXPECT_EQ(response.change().first_revision(), told + 1);
          told = response.change().last_revision();
        }
        return std::nullopt;
      });
  EXPECT_GE(guest->await(2), 2);
  guest->leave();
}

void Together::askForLight() {
  const auto get = [&](auto open, auto request, auto response) {
    using Request = decltype(request);
    using Response = decltype(response);
    request.set_session("sessions/room");
    const auto guest = Guest<Request, Response>::open(open(house().context()), request,
                                                      [](const Response&) { return std::optional<Request>(); });
    const Status end = guest->end();
    EXPECT_TRUE(end.ok()) << end.message();
    guest->leave();
  };
  get(api::getVolume, pb::GetVolumeRequest(), pb::GetVolumeResponse());
  pb::GetFrameRequest frame;
  frame.set_width(16);
  frame.set_height(16);
  get(api::getFrame, frame, pb::GetFrameResponse());
  pb::ProbeRequest probe;
  const double point[] = {0.0, 0.0, 0.5, 0.0, 0.0, 1.0};
  probe.set_points(std::string(reinterpret_cast<const char*>(point), sizeof point));
  get(api::probe, probe, pb::ProbeResponse());
}

void Together::upload(int round) {
  Mesh mesh = *reference::quad();
  mesh.positions[0].x = float(round);
  pb::UploadBlobRequest request;
  request.set_data(api::meshBytes(mesh));
  request.mutable_header()->set_session("sessions/room");
  request.mutable_header()->set_kind(pb::BLOB_KIND_MESH);
  request.mutable_header()->set_size(std::int64_t(request.data().size()));
  const auto guest = Guest<pb::UploadBlobRequest, pb::UploadBlobResponse>::open(
      api::uploadBlob(house().context()), request,
      [](const pb::UploadBlobResponse&) { return std::optional<pb::UploadBlobRequest>(); });
  guest->finish();
  const Status end = guest->end();
  EXPECT_TRUE(end.ok()) << end.message();
  guest->leave();
}

void Together::shareAndRevoke() {
  pb::CreateTokenRequest request;
  request.set_session("sessions/room");
  request.set_role(pb::ROLE_VIEWER);
  pb::CreateTokenResponse made;
  ASSERT_TRUE(house().ask(api::createToken, request, &made).ok());
  const Expected<Grant> grant = house().context().access->verify(made.token());
  ASSERT_TRUE(grant.ok());
  std::promise<void> ended;
  const std::shared_ptr<void> ward =
      house().context().access->watch(*grant, [&ended](const Status&) { ended.set_value(); });
  pb::ListTokensRequest list;
  list.set_session("sessions/room");
  pb::ListTokensResponse listed;
  EXPECT_TRUE(house().ask(api::listTokens, list, &listed).ok());
  EXPECT_FALSE(listed.tokens().empty());
  pb::RevokeTokenRequest revoke;
  revoke.set_session("sessions/room");
  revoke.set_token_id(made.token_id());
  pb::RevokeTokenResponse revoked;
  EXPECT_TRUE(house().ask(api::revokeToken, revoke, &revoked).ok());
  ended.get_future().wait();
}

void Together::askForNumbers() {
  pb::GetStatsResponse stats;
  EXPECT_TRUE(house().ask(api::getStats, pb::GetStatsRequest(), &stats).ok());
  pb::ListSessionsResponse sessions;
  EXPECT_TRUE(house().ask(api::listSessions, pb::ListSessionsRequest(), &sessions).ok());
  EXPECT_THAT(house().metrics(), testing::HasSubstr("lpv_sessions"));
  pb::ListLightsRequest lights;
  lights.set_session("sessions/room");
  pb::ListLightsResponse listed;
  EXPECT_TRUE(house().ask(api::listLights, lights, &listed).ok());
  house().registry().sweep();
}

/// A session is made, watched and deleted while its stream is open.
void Together::comeAndGo(int round) {
  const std::string id = "brief-" + std::to_string(round);
  makeRoom(id);
  pb::WatchVolumeRequest request;
  request.mutable_subscription()->set_session("sessions/" + id);
  const auto guest = Guest<pb::WatchVolumeRequest, pb::WatchVolumeResponse>::open(
      api::watchVolume(house().context()), request,
      [](const pb::WatchVolumeResponse&) { return std::optional<pb::WatchVolumeRequest>(); });
  pb::DeleteSessionRequest remove;
  remove.set_name("sessions/" + id);
  pb::DeleteSessionResponse removed;
  EXPECT_TRUE(house().ask(api::deleteSession, remove, &removed).ok());
  EXPECT_EQ(guest->end().code(), Code::kUnavailable);
  guest->leave();
}

/// Out to a file, and in again as another session.
void Together::copyTheRoom(int round) {
  pb::ExportSessionRequest out;
  out.set_name("sessions/room");
  pb::ImportSessionRequest in;
  in.set_session_id("copy-" + std::to_string(round));
  const auto source = Guest<pb::ExportSessionRequest, pb::ExportSessionResponse>::open(
      api::exportSession(house().context()), out, [&in](const pb::ExportSessionResponse& part) {
        in.mutable_data()->append(part.data());
        return std::optional<pb::ExportSessionRequest>();
      });
  EXPECT_TRUE(source->end().ok());
  source->leave();
  const auto target = Guest<pb::ImportSessionRequest, pb::ImportSessionResponse>::open(
      api::importSession(house().context()), in,
      [](const pb::ImportSessionResponse&) { return std::optional<pb::ImportSessionRequest>(); });
  target->finish();
  const Status end = target->end();
  EXPECT_TRUE(end.ok()) << end.message();
  target->leave();
  pb::DeleteSessionRequest remove;
  remove.set_name("sessions/" + in.session_id());
  pb::DeleteSessionResponse removed;
  EXPECT_TRUE(house().ask(api::deleteSession, remove, &removed).ok());
}

}  // namespace lpv::test
