#pragma once
// Everything a door offers, by service. Plain functions run on a worker thread; those that change something answer when
// it is kept, through Done. The others are streams. Every function reports errors by field.

#include <functional>
#include <memory>

#include "api/context.h"
#include "api/stream.h"
#include "lpv/v1/blob.pb.h"
#include "lpv/v1/result.pb.h"
#include "lpv/v1/scene.pb.h"
#include "lpv/v1/server.pb.h"
#include "lpv/v1/session.pb.h"

namespace lpv::api {

namespace pb = lpv::v1;

/// Takes how a call ended, once, on any thread; the response is filled by then.
using Done = std::function<void(const Status&)>;

template <typename Request, typename Response>
using StreamPtr = std::shared_ptr<Stream<Request, Response>>;

// ServerService.
Status getServerInfo(Context&, const pb::GetServerInfoRequest&, pb::GetServerInfoResponse*);
Status getStats(Context&, const pb::GetStatsRequest&, pb::GetStatsResponse*);

// SessionService. What is not here answers UNIMPLEMENTED.
void createSession(Context&, const pb::CreateSessionRequest&, pb::CreateSessionResponse*, Done);
Status getSession(Context&, const pb::GetSessionRequest&, pb::GetSessionResponse*);
Status listSessions(Context&, const pb::ListSessionsRequest&, pb::ListSessionsResponse*);
void updateSession(Context&, const pb::UpdateSessionRequest&, pb::UpdateSessionResponse*, Done);
void deleteSession(Context&, const pb::DeleteSessionRequest&, pb::DeleteSessionResponse*, Done);
void fitSession(Context&, const pb::FitSessionRequest&, pb::FitSessionResponse*, Done);
void joinSession(Context&, const pb::JoinSessionRequest&, pb::JoinSessionResponse*, Done);
void leaveSession(Context&, const pb::LeaveSessionRequest&, pb::LeaveSessionResponse*, Done);
Status updatePresence(Context&, const pb::UpdatePresenceRequest&, pb::UpdatePresenceResponse*);

StreamPtr<pb::ExportSessionRequest, pb::ExportSessionResponse> exportSession(Context&);
StreamPtr<pb::ImportSessionRequest, pb::ImportSessionResponse> importSession(Context&);

// BlobService.
Status findBlobs(Context&, const pb::FindBlobsRequest&, pb::FindBlobsResponse*);
StreamPtr<pb::UploadBlobRequest, pb::UploadBlobResponse> uploadBlob(Context&);
StreamPtr<pb::ReadBlobRequest, pb::ReadBlobResponse> readBlob(Context&);

// SceneService.
void applyEdit(Context&, const pb::ApplyEditRequest&, pb::ApplyEditResponse*, Done);
void undo(Context&, const pb::UndoRequest&, pb::UndoResponse*, Done);
void redo(Context&, const pb::RedoRequest&, pb::RedoResponse*, Done);
Status lockObjects(Context&, const pb::LockObjectsRequest&, pb::LockObjectsResponse*);
Status listLights(Context&, const pb::ListLightsRequest&, pb::ListLightsResponse*);
Status listSurfaces(Context&, const pb::ListSurfacesRequest&, pb::ListSurfacesResponse*);
Status listCameras(Context&, const pb::ListCamerasRequest&, pb::ListCamerasResponse*);
StreamPtr<pb::StreamEditsRequest, pb::StreamEditsResponse> streamEdits(Context&);
StreamPtr<pb::WatchSceneRequest, pb::WatchSceneResponse> watchScene(Context&);

// ResultService.
StreamPtr<pb::WatchVolumeRequest, pb::WatchVolumeResponse> watchVolume(Context&);
StreamPtr<pb::StreamVolumeRequest, pb::StreamVolumeResponse> streamVolume(Context&);
StreamPtr<pb::WatchFramesRequest, pb::WatchFramesResponse> watchFrames(Context&);
StreamPtr<pb::StreamFramesRequest, pb::StreamFramesResponse> streamFrames(Context&);
Status updateSubscription(Context&, const pb::UpdateSubscriptionRequest&, pb::UpdateSubscriptionResponse*);
StreamPtr<pb::GetVolumeRequest, pb::GetVolumeResponse> getVolume(Context&);
StreamPtr<pb::GetFrameRequest, pb::GetFrameResponse> getFrame(Context&);
StreamPtr<pb::ProbeRequest, pb::ProbeResponse> probe(Context&);
StreamPtr<pb::StreamProbeRequest, pb::StreamProbeResponse> streamProbe(Context&);
Status pick(Context&, const pb::PickRequest&, pb::PickResponse*);

/// The session that "sessions/{id}" at `field` names.
Expected<SessionPtr> findSession(Context&, const std::string& field, const std::string& name);

}  // namespace lpv::api
