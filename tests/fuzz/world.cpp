#include "fuzz/world.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include "convert/blob_content.h"
#include "fuzz/check.h"
#include "persistence/snapshot.h"
#include "reference/meshes.h"

namespace lpv::fuzz {

Limits smallLimits() {
  Limits limits;
  limits.maxSessions = 3;
  limits.maxClientsPerSession = 4;
  limits.maxSubscribersPerSession = 4;
  limits.maxLights = 6;
  limits.maxSurfaces = 6;
  limits.maxCameras = 4;
  limits.maxTriangles = 200;
  limits.maxTexels = 4096;
  limits.maxBlobBytes = 8192;
  limits.maxOperationsPerEdit = 6;
  limits.maxQueuedEdits = 4;
  limits.maxEditsPerSecond = 1e9;
  limits.maxUndoSteps = 4;
  limits.maxPresenceUpdatesPerSecond = 1e9;
  limits.maxTickRate = 1e9;
  limits.maxFrameEdge = 32;
  limits.maxProbePoints = 8;
  return limits;
}

Machinery& machinery() {
  static Machinery it;
  return it;
}

static Edit furniture() {
  const auto mesh = [] {
    Mesh out = *reference::quad();
    out.hash = api::meshHash(out);
    return std::make_shared<const Mesh>(std::move(out));
  };
  static const MeshPtr quad = mesh();
  CreateLight lamp{"Lamp", {}};
  lamp.fields.mesh = MeshReference{quad->hash, quad};
  CreateSurface wall{"Wall", {}};
  wall.fields.mesh = MeshReference{quad->hash, quad};
  Edit edit;
  edit.operations = {lamp, wall, PutCamera{"Front", Camera()}};
  return edit;
}

World::World(bool tokens)
    : access_(machinery().journal, machinery().timers),
      services_{smallLimits(),         &machinery().engine, &machinery().pool,    &machinery().timers,
                &machinery().counters, api::meshHash,       &machinery().journal, &access_},
      registry_(services_) {
  LightingSettings options;
  options.grid.longest = 8;
  const Expected<SessionPtr> room = registry_.create("room", options, {}, "");
  check(room.ok() && (*room)->apply({}, furniture()).status.ok(), "the room is made");
  a_ = *(*room)->join();
  b_ = *(*room)->join();
  if (tokens) check(access_.require(kAdminToken).ok(), "the admin token is taken");
}

World::~World() {
  registry_.drain();
  machinery().settle();
}

api::Context World::contextOf(Role role) {
  Machinery& m = machinery();
  api::Context context{&registry_, &m.pool, &m.timers, &m.counters, services_.limits, {}, "fuzz", {}, &access_};
  context.caches = caches_;
  if (access_.required() && role != Role::kAdmin) context.caller = {role, "room", "token"};
  return context;
}

std::string World::content() const {
  std::string out;
  for (const SessionPtr& session : registry_.all()) {
    out += session->id() + "\n" + deterministic(api::toSnapshot(session->state())) + "\n";
  }
  return out;
}

std::string deterministic(const google::protobuf::MessageLite& message) {
  std::string bytes;
  google::protobuf::io::StringOutputStream stream(&bytes);
  google::protobuf::io::CodedOutputStream coded(&stream);
  coded.SetSerializationDeterministic(true);
  message.SerializeToCodedStream(&coded);
  coded.Trim();
  return bytes;
}

}  // namespace lpv::fuzz
