#pragma once
// The handlers of lpv.v1's methods, by service. Plain functions run on a worker thread; those that change something
// answer when it is kept, through Done. The others are streams. Every function reports errors by field, and none asks
// who calls: the call driver has. Those that only their own *_service.cpp uses need no declaration here.

#include "api/call/method.h"
#include "lpv/v1/blob.pb.h"
#include "lpv/v1/result.pb.h"
#include "lpv/v1/scene.pb.h"
#include "lpv/v1/server.pb.h"
#include "lpv/v1/session.pb.h"

namespace lpv::api {

namespace pb = lpv::v1;

// ServerService.
Status getServerInfo(const Context&, const pb::GetServerInfoRequest&, pb::GetServerInfoResponse*);
Status getStats(const Context&, const pb::GetStatsRequest&, pb::GetStatsResponse*);

// SessionService. What is not here answers UNIMPLEMENTED.
void createSession(const Context&, const pb::CreateSessionRequest&, pb::CreateSessionResponse*, Done);
Status getSession(const Context&, const pb::GetSessionRequest&, pb::GetSessionResponse*);
Status listSessions(const Context&, const pb::ListSessionsRequest&, pb::ListSessionsResponse*);
void updateSession(const Context&, const pb::UpdateSessionRequest&, pb::UpdateSessionResponse*, Done);
void deleteSession(const Context&, const pb::DeleteSessionRequest&, pb::DeleteSessionResponse*, Done);
void fitSession(const Context&, const pb::FitSessionRequest&, pb::FitSessionResponse*, Done);
void joinSession(const Context&, const pb::JoinSessionRequest&, pb::JoinSessionResponse*, Done);
void leaveSession(const Context&, const pb::LeaveSessionRequest&, pb::LeaveSessionResponse*, Done);
void createToken(const Context&, const pb::CreateTokenRequest&, pb::CreateTokenResponse*, Done);
void revokeToken(const Context&, const pb::RevokeTokenRequest&, pb::RevokeTokenResponse*, Done);
Status listTokens(const Context&, const pb::ListTokensRequest&, pb::ListTokensResponse*);
Status updatePresence(const Context&, const pb::UpdatePresenceRequest&, pb::UpdatePresenceResponse*);

StreamPtr<pb::ExportSessionRequest, pb::ExportSessionResponse> exportSession(const Context&);
StreamPtr<pb::ImportSessionRequest, pb::ImportSessionResponse> importSession(const Context&);

// BlobService.
Status findBlobs(const Context&, const pb::FindBlobsRequest&, pb::FindBlobsResponse*);
StreamPtr<pb::UploadBlobRequest, pb::UploadBlobResponse> uploadBlob(const Context&);
StreamPtr<pb::ReadBlobRequest, pb::ReadBlobResponse> readBlob(const Context&);

// SceneService.
void applyEdit(const Context&, const pb::ApplyEditRequest&, pb::ApplyEditResponse*, Done);
void undo(const Context&, const pb::UndoRequest&, pb::UndoResponse*, Done);
void redo(const Context&, const pb::RedoRequest&, pb::RedoResponse*, Done);
Status lockObjects(const Context&, const pb::LockObjectsRequest&, pb::LockObjectsResponse*);
Status listLights(const Context&, const pb::ListLightsRequest&, pb::ListLightsResponse*);
Status listSurfaces(const Context&, const pb::ListSurfacesRequest&, pb::ListSurfacesResponse*);
Status listCameras(const Context&, const pb::ListCamerasRequest&, pb::ListCamerasResponse*);
StreamPtr<pb::StreamEditsRequest, pb::StreamEditsResponse> streamEdits(const Context&);
StreamPtr<pb::WatchSceneRequest, pb::WatchSceneResponse> watchScene(const Context&);

// ResultService.
StreamPtr<pb::WatchVolumeRequest, pb::WatchVolumeResponse> watchVolume(const Context&);
StreamPtr<pb::StreamVolumeRequest, pb::StreamVolumeResponse> streamVolume(const Context&);
StreamPtr<pb::WatchFramesRequest, pb::WatchFramesResponse> watchFrames(const Context&);
StreamPtr<pb::StreamFramesRequest, pb::StreamFramesResponse> streamFrames(const Context&);
Status updateSubscription(const Context&, const pb::UpdateSubscriptionRequest&, pb::UpdateSubscriptionResponse*);
StreamPtr<pb::GetVolumeRequest, pb::GetVolumeResponse> getVolume(const Context&);
StreamPtr<pb::GetFrameRequest, pb::GetFrameResponse> getFrame(const Context&);
StreamPtr<pb::ProbeRequest, pb::ProbeResponse> probe(const Context&);
StreamPtr<pb::StreamProbeRequest, pb::StreamProbeResponse> streamProbe(const Context&);
Status pick(const Context&, const pb::PickRequest&, pb::PickResponse*);

/// The session that "sessions/{id}" at `field` names. Whether the caller may do something in it was asked before
/// (api/call/admission.h).
Expected<SessionPtr> findSession(const Context&, const std::string& field, const std::string& name);

}  // namespace lpv::api
