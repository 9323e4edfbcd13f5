#include "api/call/method_table.h"
#include "api/call/paging.h"
#include "api/services.h"
#include "convert/geometry.h"
#include "convert/scene.h"
#include "convert/session.h"

namespace lpv::api {

void applyEdit(const Context& context, const pb::ApplyEditRequest& request, pb::ApplyEditResponse* response,
               Done done) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return done(session.status());
  const ClientIdentity client = fromProto(request.client());
  if (Status s = (*session)->verify(client); !s.ok()) return done(s);
  if (Status s = checkSequence(client, request.edit().sequence()); !s.ok()) return done(s.within("edit"));
  Expected<Edit> edit = fromProto(request.edit(), context.limits);
  const EditOutcome outcome = edit ? (*session)->apply(client, std::move(*edit))
                                   : (*session)->recordRejected(client, request.edit().sequence(), edit.status());
  (*session)->confirmWhenDurable(outcome,
                                 [session = *session, response, done = std::move(done)](const EditOutcome& confirmed) {
                                   if (confirmed.status.ok()) toProto(confirmed, *session, response->mutable_ack());
                                   done(confirmed.status);
                                 });
}

namespace {

/// Of Undo and Redo, which differ in their direction only.
template <typename Request, typename Response>
void undoRedo(const Context& context, const Request& request, Response* response, UndoDirection direction, Done done) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return done(session.status());
  const ClientIdentity client = fromProto(request.client());
  if (Status s = (*session)->verify(client); !s.ok()) return done(s);
  if (Status s = checkSequence(client, request.sequence()); !s.ok()) return done(s);
  const EditOutcome outcome = (*session)->undoRedo(client, request.sequence(), direction);
  (*session)->confirmWhenDurable(outcome,
                                 [session = *session, response, done = std::move(done)](const EditOutcome& confirmed) {
                                   if (confirmed.status.ok()) {
                                     toProto(confirmed, *session, response->mutable_ack());
                                   }
                                   done(confirmed.status);
                                 });
}

}  // namespace

void undo(const Context& context, const pb::UndoRequest& request, pb::UndoResponse* response, Done done) {
  undoRedo(context, request, response, UndoDirection::kUndo, std::move(done));
}

void redo(const Context& context, const pb::RedoRequest& request, pb::RedoResponse* response, Done done) {
  undoRedo(context, request, response, UndoDirection::kRedo, std::move(done));
}

Status lockObjects(const Context& context, const pb::LockObjectsRequest& request, pb::LockObjectsResponse*) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return session.status();
  if (request.ttl().nanos() != 0) return invalid("ttl", "ttl has a fraction of a second; give whole ones");
  return (*session)->lockObjects(fromProto(request.client()), {request.objects().begin(), request.objects().end()},
                                 std::chrono::seconds(request.ttl().seconds()));
}

Status listLights(const Context& context, const pb::ListLightsRequest& request, pb::ListLightsResponse* response) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return session.status();
  response->set_revision((*session)->revision());
  const std::vector<Versioned<Light>> lights = (*session)->lights();
  return page(
      request, lights, [](const Versioned<Light>& light) { return light.object->name; },
      [&](const Versioned<Light>& light) {
        pb::Light* out = response->add_lights();
        toProto(light, out);
        // Worth milliseconds for a large mesh: only where somebody asks for a list, never in the stream of changes.
        out->mutable_status()->set_area(worldArea(*light.object->mesh, light.object->transform));
        out->mutable_status()->set_skipped_degenerate(std::int64_t(degenerateTriangles(*light.object->mesh)));
      },
      response->mutable_next_page_token());
}

Status listSurfaces(const Context& context, const pb::ListSurfacesRequest& request,
                    pb::ListSurfacesResponse* response) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return session.status();
  response->set_revision((*session)->revision());
  const std::vector<Versioned<Surface>> surfaces = (*session)->surfaces();
  return page(
      request, surfaces, [](const Versioned<Surface>& surface) { return surface.object->name; },
      [&](const Versioned<Surface>& surface) { toProto(surface, response->add_surfaces()); },
      response->mutable_next_page_token());
}

Status listCameras(const Context& context, const pb::ListCamerasRequest& request, pb::ListCamerasResponse* response) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return session.status();
  response->set_revision((*session)->revision());
  const std::vector<std::pair<std::string, Camera>> cameras = (*session)->cameras();
  return page(
      request, cameras, [](const auto& camera) { return camera.first; },
      [&](const auto& camera) { toProto(camera.first, camera.second, response->add_cameras()); },
      response->mutable_next_page_token());
}

std::vector<Method> sceneMethods() {
  return {
      {"SceneService.ApplyEdit", Role::kEditor, "session", handler(applyEdit)},
      {"SceneService.StreamEdits", Role::kEditor, "session", handler(streamEdits)},
      {"SceneService.WatchScene", Role::kViewer, "session", handler(watchScene)},
      {"SceneService.ListLights", Role::kViewer, "session", handler(listLights)},
      {"SceneService.ListSurfaces", Role::kViewer, "session", handler(listSurfaces)},
      {"SceneService.ListCameras", Role::kViewer, "session", handler(listCameras)},
      {"SceneService.Undo", Role::kEditor, "session", handler(undo)},
      {"SceneService.Redo", Role::kEditor, "session", handler(redo)},
      {"SceneService.LockObjects", Role::kEditor, "session", handler(lockObjects)},
  };
}

}  // namespace lpv::api
