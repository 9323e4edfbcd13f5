#include "grpc/services.h"

#include "api/services.h"
#include "grpc/reactors.h"
#include "lpv/v1/blob.grpc.pb.h"
#include "lpv/v1/result.grpc.pb.h"
#include "lpv/v1/scene.grpc.pb.h"
#include "lpv/v1/server.grpc.pb.h"
#include "lpv/v1/session.grpc.pb.h"

namespace lpv::door {

namespace pb = lpv::v1;
using Call = grpc::CallbackServerContext;

namespace {

class ServerDoor final : public pb::ServerService::CallbackService {
 public:
  explicit ServerDoor(api::Context& context) : context_(context) {}

  grpc::ServerUnaryReactor* GetServerInfo(Call* call, const pb::GetServerInfoRequest* request,
                                          pb::GetServerInfoResponse* response) override {
    return answer(context_, call, request, response, api::getServerInfo);
  }
  grpc::ServerUnaryReactor* GetStats(Call* call, const pb::GetStatsRequest* request,
                                     pb::GetStatsResponse* response) override {
    return answer(context_, call, request, response, api::getStats);
  }

 private:
  api::Context& context_;
};

class SessionDoor final : public pb::SessionService::CallbackService {
 public:
  explicit SessionDoor(api::Context& context) : context_(context) {}

  grpc::ServerUnaryReactor* CreateSession(Call* call, const pb::CreateSessionRequest* request,
                                          pb::CreateSessionResponse* response) override {
    return answer(context_, call, request, response, api::createSession);
  }
  grpc::ServerUnaryReactor* GetSession(Call* call, const pb::GetSessionRequest* request,
                                       pb::GetSessionResponse* response) override {
    return answer(context_, call, request, response, api::getSession);
  }
  grpc::ServerUnaryReactor* ListSessions(Call* call, const pb::ListSessionsRequest* request,
                                         pb::ListSessionsResponse* response) override {
    return answer(context_, call, request, response, api::listSessions);
  }
  grpc::ServerUnaryReactor* UpdateSession(Call* call, const pb::UpdateSessionRequest* request,
                                          pb::UpdateSessionResponse* response) override {
    return answer(context_, call, request, response, api::updateSession);
  }
  grpc::ServerUnaryReactor* DeleteSession(Call* call, const pb::DeleteSessionRequest* request,
                                          pb::DeleteSessionResponse* response) override {
    return answer(context_, call, request, response, api::deleteSession);
  }
  grpc::ServerUnaryReactor* FitSession(Call* call, const pb::FitSessionRequest* request,
                                       pb::FitSessionResponse* response) override {
    return answer(context_, call, request, response, api::fitSession);
  }
  grpc::ServerUnaryReactor* JoinSession(Call* call, const pb::JoinSessionRequest* request,
                                        pb::JoinSessionResponse* response) override {
    return answer(context_, call, request, response, api::joinSession);
  }
  grpc::ServerUnaryReactor* LeaveSession(Call* call, const pb::LeaveSessionRequest* request,
                                         pb::LeaveSessionResponse* response) override {
    return answer(context_, call, request, response, api::leaveSession);
  }
  grpc::ServerUnaryReactor* UpdatePresence(Call* call, const pb::UpdatePresenceRequest* request,
                                           pb::UpdatePresenceResponse* response) override {
    return answer(context_, call, request, response, api::updatePresence);
  }
  grpc::ServerUnaryReactor* CreateToken(Call* call, const pb::CreateTokenRequest* request,
                                        pb::CreateTokenResponse* response) override {
    return answer(context_, call, request, response, api::createToken);
  }
  grpc::ServerUnaryReactor* RevokeToken(Call* call, const pb::RevokeTokenRequest* request,
                                        pb::RevokeTokenResponse* response) override {
    return answer(context_, call, request, response, api::revokeToken);
  }
  grpc::ServerWriteReactor<pb::ExportSessionResponse>* ExportSession(Call* call,
                                                                     const pb::ExportSessionRequest* request) override {
    return serve(context_, call, api::exportSession, request);
  }
  grpc::ServerReadReactor<pb::ImportSessionRequest>* ImportSession(Call* call,
                                                                   pb::ImportSessionResponse* response) override {
    return serve(context_, call, api::importSession, response);
  }

 private:
  api::Context& context_;
};

class BlobDoor final : public pb::BlobService::CallbackService {
 public:
  explicit BlobDoor(api::Context& context) : context_(context) {}

  grpc::ServerUnaryReactor* FindBlobs(Call* call, const pb::FindBlobsRequest* request,
                                      pb::FindBlobsResponse* response) override {
    return answer(context_, call, request, response, api::findBlobs);
  }
  grpc::ServerReadReactor<pb::UploadBlobRequest>* UploadBlob(Call* call, pb::UploadBlobResponse* response) override {
    return serve(context_, call, api::uploadBlob, response);
  }
  grpc::ServerWriteReactor<pb::ReadBlobResponse>* ReadBlob(Call* call, const pb::ReadBlobRequest* request) override {
    return serve(context_, call, api::readBlob, request);
  }

 private:
  api::Context& context_;
};

class SceneDoor final : public pb::SceneService::CallbackService {
 public:
  explicit SceneDoor(api::Context& context) : context_(context) {}

  grpc::ServerUnaryReactor* ApplyEdit(Call* call, const pb::ApplyEditRequest* request,
                                      pb::ApplyEditResponse* response) override {
    return answer(context_, call, request, response, api::applyEdit);
  }
  grpc::ServerUnaryReactor* ListLights(Call* call, const pb::ListLightsRequest* request,
                                       pb::ListLightsResponse* response) override {
    return answer(context_, call, request, response, api::listLights);
  }
  grpc::ServerUnaryReactor* ListSurfaces(Call* call, const pb::ListSurfacesRequest* request,
                                         pb::ListSurfacesResponse* response) override {
    return answer(context_, call, request, response, api::listSurfaces);
  }
  grpc::ServerUnaryReactor* ListCameras(Call* call, const pb::ListCamerasRequest* request,
                                        pb::ListCamerasResponse* response) override {
    return answer(context_, call, request, response, api::listCameras);
  }
  grpc::ServerBidiReactor<pb::StreamEditsRequest, pb::StreamEditsResponse>* StreamEdits(Call* call) override {
    return serve(context_, call, api::streamEdits);
  }
  grpc::ServerWriteReactor<pb::WatchSceneResponse>* WatchScene(Call* call,
                                                               const pb::WatchSceneRequest* request) override {
    return serve(context_, call, api::watchScene, request);
  }
  grpc::ServerUnaryReactor* LockObjects(Call* call, const pb::LockObjectsRequest* request,
                                        pb::LockObjectsResponse* response) override {
    return answer(context_, call, request, response, api::lockObjects);
  }
  grpc::ServerUnaryReactor* Undo(Call* call, const pb::UndoRequest* request, pb::UndoResponse* response) override {
    return answer(context_, call, request, response, api::undo);
  }
  grpc::ServerUnaryReactor* Redo(Call* call, const pb::RedoRequest* request, pb::RedoResponse* response) override {
    return answer(context_, call, request, response, api::redo);
  }

 private:
  api::Context& context_;
};

class ResultDoor final : public pb::ResultService::CallbackService {
 public:
  explicit ResultDoor(api::Context& context) : context_(context) {}

  grpc::ServerWriteReactor<pb::WatchVolumeResponse>* WatchVolume(Call* call,
                                                                 const pb::WatchVolumeRequest* request) override {
    return serve(context_, call, api::watchVolume, request);
  }
  grpc::ServerBidiReactor<pb::StreamVolumeRequest, pb::StreamVolumeResponse>* StreamVolume(Call* call) override {
    return serve(context_, call, api::streamVolume);
  }
  grpc::ServerWriteReactor<pb::WatchFramesResponse>* WatchFrames(Call* call,
                                                                 const pb::WatchFramesRequest* request) override {
    return serve(context_, call, api::watchFrames, request);
  }
  grpc::ServerBidiReactor<pb::StreamFramesRequest, pb::StreamFramesResponse>* StreamFrames(Call* call) override {
    return serve(context_, call, api::streamFrames);
  }
  grpc::ServerUnaryReactor* UpdateSubscription(Call* call, const pb::UpdateSubscriptionRequest* request,
                                               pb::UpdateSubscriptionResponse* response) override {
    return answer(context_, call, request, response, api::updateSubscription);
  }
  grpc::ServerWriteReactor<pb::GetVolumeResponse>* GetVolume(Call* call, const pb::GetVolumeRequest* request) override {
    return serve(context_, call, api::getVolume, request);
  }
  grpc::ServerWriteReactor<pb::GetFrameResponse>* GetFrame(Call* call, const pb::GetFrameRequest* request) override {
    return serve(context_, call, api::getFrame, request);
  }
  grpc::ServerUnaryReactor* Probe(Call* call, const pb::ProbeRequest* request, pb::ProbeResponse* response) override {
    return serve(context_, call, api::probe, request, response);
  }
  grpc::ServerBidiReactor<pb::StreamProbeRequest, pb::StreamProbeResponse>* StreamProbe(Call* call) override {
    return serve(context_, call, api::streamProbe);
  }
  grpc::ServerUnaryReactor* Pick(Call* call, const pb::PickRequest* request, pb::PickResponse* response) override {
    return answer(context_, call, request, response, api::pick);
  }

 private:
  api::Context& context_;
};

}  // namespace

struct Services::Parts {
  explicit Parts(api::Context& context)
      : server(context), session(context), blob(context), scene(context), result(context) {}
  ServerDoor server;
  SessionDoor session;
  BlobDoor blob;
  SceneDoor scene;
  ResultDoor result;
};

Services::Services(api::Context& context) : parts_(std::make_unique<Parts>(context)) {}
Services::~Services() = default;

void Services::registerWith(grpc::ServerBuilder& builder) {
  builder.RegisterService(&parts_->server);
  builder.RegisterService(&parts_->session);
  builder.RegisterService(&parts_->blob);
  builder.RegisterService(&parts_->scene);
  builder.RegisterService(&parts_->result);
}

}  // namespace lpv::door
