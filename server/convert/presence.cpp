#include "convert/presence.h"

#include "convert/geometry.h"

namespace lpv::api {

PresenceUpdate fromProto(const pb::JoinSessionRequest& request) {
  PresenceUpdate out;
  if (!request.display_name().empty()) out.displayName = request.display_name();
  if (request.has_colour()) out.colour = fromProto(request.colour());
  return out;
}

Expected<PresenceUpdate> fromProto(const pb::Presence& presence) {
  PresenceUpdate out;
  if (!presence.display_name().empty()) out.displayName = presence.display_name();
  if (presence.has_colour()) out.colour = fromProto(presence.colour());
  if (presence.has_camera()) {
    const Expected<Camera> camera = fromProto(presence.camera());
    if (!camera) return camera.status().within("camera");
    out.camera = *camera;
  }
  out.selection.assign(presence.selection().begin(), presence.selection().end());
  return out;
}

void toProto(const std::string& client, const Presence& presence, pb::Presence* out) {
  out->set_client_id(client);
  out->set_display_name(presence.displayName);
  toProto(presence.colour, out->mutable_colour());
  if (presence.camera) toProto(std::string(), *presence.camera, out->mutable_camera());
  for (const std::string& name : presence.selection) out->add_selection(name);
  for (const std::string& name : presence.locked) out->add_locked(name);
}

}  // namespace lpv::api
