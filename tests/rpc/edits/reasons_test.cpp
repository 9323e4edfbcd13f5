// Why a call was refused, for programs: the same word in a call's status and in an acknowledgement of StreamEdits.

#include <gtest/gtest.h>

#include <functional>

#include "base/reason.h"
#include "lpv/v1/status.pb.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

/// The ErrorInfo among the details; empty where there is none.
pb::ErrorInfo infoOf(const pb::Status& status) {
  pb::ErrorInfo info;
  for (const google::protobuf::Any& any : status.details()) {
    if (any.type_url() != "type.googleapis.com/google.rpc.ErrorInfo") continue;
    EXPECT_TRUE(info.ParseFromString(any.value()));
  }
  return info;
}
pb::ErrorInfo infoOf(const grpc::Status& status) {
  pb::Status details;
  EXPECT_TRUE(details.ParseFromString(status.error_details()));
  return infoOf(details);
}

/// A server whose limits are within reach, and a session of two members at its limit of lights.
struct Narrow {
  ServerProcess process{{"--max-sessions=1", "--max-lights=1", "--max-surfaces=1", "--max-triangles=20",
                         "--max-clients-per-session=2", "--max-blob-bytes=100"}};
  Stubs stubs{process.address()};
  std::string session = makeLitSession(stubs);
  pb::ClientIdentity ann = join(stubs, session);
  pb::ClientIdentity bob = join(stubs, session);

  grpc::Status edit(const std::vector<pb::Operation>& operations) {
    return tryEdit(stubs, session, client::editOf(operations));
  }
};

grpc::Status createSession(Narrow& s, const std::string& id) {
  pb::CreateSessionRequest request;
  request.set_session_id(id);
  pb::CreateSessionResponse response;
  return s.stubs.session->CreateSession(Call(), request, &response);
}

grpc::Status joinAgain(Narrow& s) {
  pb::JoinSessionRequest request;
  request.set_session(s.session);
  pb::JoinSessionResponse response;
  return s.stubs.session->JoinSession(Call(), request, &response);
}

grpc::Status undo(Narrow& s) {
  pb::UndoRequest request;
  request.set_session(s.session);
  *request.mutable_client() = s.ann;
  request.set_sequence(1);
  pb::UndoResponse response;
  return s.stubs.scene->Undo(Call(), request, &response);
}

grpc::Status editOfAnOldRevision(Narrow& s) {
  pb::Edit edit = client::editOf({client::setRadiance("Lamp", {1, 1, 1})});
  edit.set_expected_revision(1000);
  return tryEdit(s.stubs, s.session, edit);
}

grpc::Status editOfAStranger(Narrow& s) {
  pb::ClientIdentity stranger = s.ann;
  stranger.set_secret("another");
  pb::Edit edit = client::editOf({client::setRadiance("Lamp", {1, 1, 1})});
  edit.set_sequence(1);
  return tryEdit(s.stubs, s.session, edit, nullptr, stranger);
}

grpc::Status editOfWhatBobHasLocked(Narrow& s) {
  pb::LockObjectsRequest request;
  request.set_session(s.session);
  *request.mutable_client() = s.bob;
  request.add_objects("Lamp");
  request.mutable_ttl()->set_seconds(60);
  pb::LockObjectsResponse response;
  EXPECT_THAT(s.stubs.scene->LockObjects(Call(), request, &response), IsOk());
  return s.edit({client::setRadiance("Lamp", {1, 1, 1})});
}

grpc::Status probeTooMuch(Narrow& s) {
  pb::ProbeRequest request;
  request.set_session(s.session);
  request.set_points(std::string(std::size_t(16385) * 48, '\0'));
  pb::ProbeResponse response;
  return s.stubs.result->Probe(Call(), request, &response);
}

struct Row {
  Reason reason;
  std::function<grpc::Status(Narrow&)> call;
};

std::vector<Row> rows() {
  return {
      {Reason::kMaxLights, [](Narrow& s) { return s.edit({client::createLight(light("More"))}); }},
      {Reason::kMaxSurfaces,
       [](Narrow& s) {
         return s.edit({client::createSurface(surface("One")), client::createSurface(surface("Two"))});
       }},
      {Reason::kMaxTriangles, [](Narrow& s) { return s.edit({client::createSurface(surface("Sheet", sheet(6)))}); }},
      {Reason::kFixedBounds, [](Narrow& s) { return s.edit({client::fitGrid()}); }},
      {Reason::kMaxBlobBytes,
       [](Narrow& s) { return upload(s.stubs, s.session, pb::BLOB_KIND_MESH, std::string(101, 'a')); }},
      {Reason::kMaxSessions, [](Narrow& s) { return createSession(s, "another"); }},
      {Reason::kMaxClientsPerSession, joinAgain},
      {Reason::kMaxProbePoints, probeTooMuch},
      {Reason::kNothingToUndo, undo},
      {Reason::kRevisionChanged, editOfAnOldRevision},
      {Reason::kUnknownClient, editOfAStranger},
      {Reason::kLocked, editOfWhatBobHasLocked},
  };
}

// Red when toGrpc makes the call's status without the reason.
TEST(Reasons, AreSeenByClients) {
  Narrow narrow;
  for (const Row& row : rows()) {
    SCOPED_TRACE(nameOf(row.reason));
    const grpc::Status status = row.call(narrow);
    EXPECT_FALSE(status.ok());
    const pb::ErrorInfo info = infoOf(status);
    EXPECT_EQ(info.reason(), nameOf(row.reason)) << status.error_message();
    EXPECT_EQ(info.domain(), "lpv.v1");
    EXPECT_EQ(info.metadata().count("limit"), isLimit(row.reason) ? 1U : 0U);
  }
}

TEST(Reasons, AreTheSameWordInAcknowledgements) {
  Narrow narrow;
  Call call;
  const auto stream = narrow.stubs.scene->StreamEdits(call);
  pb::StreamEditsRequest request;
  request.set_session(narrow.session);
  *request.mutable_client() = narrow.ann;
  *request.mutable_edit() = client::editOf({client::createLight(light("More"))});
  request.mutable_edit()->set_sequence(1);
  ASSERT_TRUE(stream->Write(request));
  pb::StreamEditsResponse response;
  do {
    ASSERT_TRUE(stream->Read(&response));
  } while (!response.has_ack());
  const pb::ErrorInfo info = infoOf(response.ack().status());
  EXPECT_EQ(info.reason(), "MAX_LIGHTS");
  EXPECT_EQ(info.metadata().at("limit"), "max_lights");
  call->TryCancel();
}

}  // namespace
}  // namespace lpv::rpc
