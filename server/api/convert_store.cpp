#include "api/convert_store.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "api/blob_content.h"
#include "api/convert_geometry.h"
#include "api/convert_scene.h"
#include "api/convert_session.h"
#include "store/fold.h"

namespace lpv::api {
namespace {

static_assert(store::kKeptTombstones == kMaxTombstones && store::kKeptOutcomes == kRememberedOutcomes);
static_assert(store::kKeptNameBytes == kRememberedNameBytes && store::kBytesPerName == kRememberedBytesPerName);

pb::BlobKind kindOf(const Blob& blob) {
  return blob.kind == BlobKind::kMesh ? pb::BLOB_KIND_MESH : pb::BLOB_KIND_TEXTURE;
}

void writeSettings(const SessionOptions& options, const SessionManners& manners, pb::SessionSettings* out) {
  toProto(options, out);
  out->mutable_ttl()->set_seconds(manners.ttl.count());
  out->set_display_name(manners.displayName);
}

void writeDeleted(const Deleted& in, kept::Tombstone* out) {
  out->set_kind(in.kind == ObjectKind::kLight     ? kept::Tombstone::KIND_LIGHT
                : in.kind == ObjectKind::kSurface ? kept::Tombstone::KIND_SURFACE
                                                  : kept::Tombstone::KIND_CAMERA);
  out->set_name(in.name);
  out->set_revision(in.revision);
}

Deleted readDeleted(const kept::Tombstone& in) {
  const ObjectKind kind = in.kind() == kept::Tombstone::KIND_LIGHT     ? ObjectKind::kLight
                          : in.kind() == kept::Tombstone::KIND_SURFACE ? ObjectKind::kSurface
                                                                       : ObjectKind::kCamera;
  return {kind, in.name(), in.revision()};
}

void writeOutcome(const EditOutcome& in, pb::EditAck* out) {
  out->set_sequence(in.sequence);
  if (!in.status.ok()) toProto(in.status, out->mutable_status());
  out->set_revision(in.revision);
  for (const std::string& name : in.names) out->add_names(name);
  for (const std::string& field : in.skipped) out->add_skipped_fields(field);
}

EditOutcome readOutcome(const pb::EditAck& in) {
  return {in.sequence(),
          fromProto(in.status()),
          in.revision(),
          {in.names().begin(), in.names().end()},
          {in.skipped_fields().begin(), in.skipped_fields().end()}};
}

/// Meshes that came in no upload: with an edit, or deformed by one.
void addMesh(const MeshPtr& mesh, const store::Holds& holds, std::set<BlobHash>& added, store::Step* out) {
  if (added.contains(mesh->hash) || holds(mesh->hash)) return;
  added.insert(mesh->hash);
  out->contents.push_back({mesh->hash, pb::BLOB_KIND_MESH,
                           mesh->source ? mesh->source : std::make_shared<const std::string>(meshBytes(*mesh))});
}

void addChanges(const Changes& changes, kept::Record* out) {
  for (const Versioned<Light>& light : changes.lights) toProto(light, out->add_lights());
  for (const Versioned<Surface>& surface : changes.surfaces) toProto(surface, out->add_surfaces());
  for (const auto& [name, camera] : changes.cameras) toProto(name, camera, out->add_cameras());
  for (const Deleted& deleted : changes.deleted) writeDeleted(deleted, out->add_deleted());
  if (changes.grid) toProto(*changes.grid, out->mutable_grid());
  out->set_settings_are_revision(changes.options.has_value());
}

}  // namespace

store::Step toStep(const JournalStep& step, const store::Holds& holds) {
  store::Step out;
  kept::Record& record = out.record;
  record.set_revision(step.changes.revision);
  addChanges(step.changes, &record);
  if (step.settings) writeSettings(step.settings->options, step.settings->manners, record.mutable_settings());
  record.set_client_id(step.client);
  if (step.outcome) writeOutcome(*step.outcome, record.mutable_outcome());
  if (step.joined) {
    record.set_joined_id(step.joined->id);
    record.set_joined_secret_hash(step.joined->secretHash);
  }
  record.set_left_id(step.left);
  if (step.upload) {
    (*record.mutable_uploads())[step.upload->hash] = kindOf(*step.upload);
    out.contents.push_back({step.upload->hash, kindOf(*step.upload), step.upload->bytes});
  }
  for (const BlobHash& hash : step.dropped) record.add_dropped(hash);
  std::set<BlobHash> added;
  for (const Versioned<Light>& light : step.changes.lights) addMesh(light.object->mesh, holds, added, &out);
  for (const Versioned<Surface>& surface : step.changes.surfaces) addMesh(surface.object->mesh, holds, added, &out);
  return out;
}

kept::Snapshot toSnapshot(const SavedSession& state) {
  const DocumentState& document = state.document;
  kept::Snapshot out;
  out.set_revision(document.revision);
  writeSettings(document.options, state.manners, out.mutable_settings());
  out.set_settings_revision(document.optionsRevision);
  toProto(document.grid, out.mutable_grid());
  out.set_grid_revision(document.gridRevision);
  for (const auto& light : document.lights) toProto(light, &(*out.mutable_lights())[light.object->name]);
  for (const auto& surface : document.surfaces) toProto(surface, &(*out.mutable_surfaces())[surface.object->name]);
  for (const DocumentState::Camera& camera : document.cameras) {
    kept::Camera& entry = (*out.mutable_cameras())[camera.name];
    toProto(camera.name, camera.camera, entry.mutable_camera());
    entry.set_revision(camera.revision);
  }
  for (const Deleted& deleted : document.tombstones) writeDeleted(deleted, out.add_tombstones());
  out.set_forgotten_up_to(document.forgottenUpTo);
  for (const ClientState& client : state.clients) {
    kept::Client& entry = (*out.mutable_clients())[client.id];
    entry.set_secret_hash(client.secretHash);
    for (const EditOutcome& outcome : client.outcomes) writeOutcome(outcome, entry.add_outcomes());
    entry.set_forgotten_up_to(client.forgottenUpTo);
    entry.set_accepted_sequence(client.acceptedSequence);
    entry.set_accepted_revision(client.acceptedRevision);
  }
  for (const BlobPtr& blob : state.uploads) (*out.mutable_uploads())[blob->hash] = kindOf(*blob);
  return out;
}

std::vector<store::Content> contentsOf(const SavedSession& state) {
  store::Step out;
  std::set<BlobHash> added;
  for (const BlobPtr& blob : state.uploads) {
    if (added.insert(blob->hash).second) out.contents.push_back({blob->hash, kindOf(*blob), blob->bytes});
  }
  const auto none = [](const std::string&) { return false; };
  for (const auto& light : state.document.lights) addMesh(light.object->mesh, none, added, &out);
  for (const auto& surface : state.document.surfaces) addMesh(surface.object->mesh, none, added, &out);
  return std::move(out.contents);
}

namespace {

bool isHash(const std::string& name) {
  return name.size() == 64 && name.find_first_not_of("0123456789abcdef") == std::string::npos;
}

/// Parsed contents by hash.
class Contents {
 public:
  Status add(const store::Content& content) {
    if (!isHash(content.hash)) {
      return {Code::kDataLoss, "a content is named by " + std::to_string(content.hash.size()) +
                                   " bytes, not by a SHA-256 in 64 lower-case hexadecimal digits"};
    }
    const Expected<BlobPtr> blob = blobFromBytes(content.kind, *content.bytes);
    if (!blob) return lost(content.hash, blob.status().message());
    if ((*blob)->hash != content.hash) return lost(content.hash, "its bytes have another hash");
    blobs_[content.hash] = *blob;
    return {};
  }
  BlobPtr blob(const BlobHash& hash) const {
    const auto found = blobs_.find(hash);
    return found == blobs_.end() ? nullptr : found->second;
  }
  Expected<MeshPtr> mesh(const BlobHash& hash) const {
    const BlobPtr found = blob(hash);
    return found && found->mesh ? Expected<MeshPtr>(found->mesh) : lost(hash, "it is no mesh of this session");
  }
  Expected<TexturePtr> texture(const BlobHash& hash) const {
    if (hash.empty()) return TexturePtr();
    const BlobPtr found = blob(hash);
    return found && found->texture ? Expected<TexturePtr>(found->texture)
                                   : lost(hash, "it is no texture of this session");
  }

 private:
  static Status lost(const BlobHash& hash, const std::string& why) {
    return {Code::kDataLoss, "content " + hash + ": " + why};
  }
  std::map<BlobHash, BlobPtr> blobs_;
};

Status outOfRange(const char* kind, const std::string& name, const Status& why) {
  return {Code::kDataLoss, std::string(kind) + " \"" + name + "\": " + why.message()};
}

Expected<Transform> transformOf(const pb::Transform& in) {
  const Expected<TransformFields> fields = fromProto(in);
  return fields ? withFields(Transform(), *fields) : fields.status();
}

Expected<Versioned<Light>> lightFrom(const pb::Light& in, const Contents& contents) {
  auto light = std::make_shared<Light>();
  light->name = in.name();
  const Expected<MeshPtr> mesh = contents.mesh(in.mesh());
  if (!mesh) return mesh.status();
  light->mesh = *mesh;
  const Expected<TexturePtr> texture = contents.texture(in.texture());
  if (!texture) return texture.status();
  light->texture = *texture;
  const Expected<Transform> transform = transformOf(in.transform());
  if (!transform) return outOfRange("light", in.name(), transform.status());
  light->transform = *transform;
  LightFields checked;
  if (in.has_power()) {
    light->power = checked.power = fromProto(in.power());
  } else {
    light->radiance = fromProto(in.radiance());
    checked.radiance = light->radiance;
  }
  checked.group = light->group = in.group();
  light->twoSided = in.two_sided();
  light->enabled = in.enabled();
  Status status = checkName(in.name());
  if (status.ok()) status = checkFields(checked);
  if (!status.ok()) return outOfRange("light", in.name(), status);
  return Versioned<Light>{light, in.status().revision()};
}

Expected<Versioned<Surface>> surfaceFrom(const pb::Surface& in, const Contents& contents) {
  auto surface = std::make_shared<Surface>();
  surface->name = in.name();
  const Expected<MeshPtr> mesh = contents.mesh(in.mesh());
  if (!mesh) return mesh.status();
  surface->mesh = *mesh;
  const Expected<TexturePtr> texture = contents.texture(in.albedo_texture());
  if (!texture) return texture.status();
  surface->albedoTexture = *texture;
  const Expected<Transform> transform = transformOf(in.transform());
  if (!transform) return outOfRange("surface", in.name(), transform.status());
  surface->transform = *transform;
  SurfaceFields checked;
  checked.albedo = surface->albedo = fromProto(in.albedo());
  checked.roughness = surface->roughness = in.roughness();
  checked.metalness = surface->metalness = in.metalness();
  surface->twoSided = !in.one_sided();
  Status status = checkName(in.name());
  if (status.ok()) status = checkFields(checked);
  if (!status.ok()) return outOfRange("surface", in.name(), status);
  return Versioned<Surface>{surface, in.revision()};
}

/// Lights and surfaces have one name space, and each has its name.
Status checkPlace(const char* kind, const std::string& place, const std::string& name, std::set<std::string>& taken) {
  if (place != name) return outOfRange(kind, place, invalid("name", "it is named \"" + name + "\" within"));
  if (!taken.insert(name).second) return outOfRange(kind, name, invalid("name", "a light has this name too"));
  return {};
}

Status objectsFrom(const kept::Snapshot& in, const Contents& contents, DocumentState* out) {
  std::set<std::string> taken;
  for (const auto& [name, message] : in.lights()) {
    if (Status s = checkPlace("light", name, message.name(), taken); !s.ok()) return s;
    Expected<Versioned<Light>> light = lightFrom(message, contents);
    if (!light) return light.status();
    out->lights.push_back(std::move(*light));
  }
  for (const auto& [name, message] : in.surfaces()) {
    if (Status s = checkPlace("surface", name, message.name(), taken); !s.ok()) return s;
    Expected<Versioned<Surface>> surface = surfaceFrom(message, contents);
    if (!surface) return surface.status();
    out->surfaces.push_back(std::move(*surface));
  }
  for (const auto& [name, message] : in.cameras()) {
    if (Status s = checkName(name); !s.ok()) return outOfRange("camera", name, s);
    const Expected<Camera> camera = fromProto(message.camera());
    if (!camera) return outOfRange("camera", name, camera.status());
    out->cameras.push_back({name, *camera, message.revision()});
  }
  return {};
}

ClientState clientFrom(const std::string& id, const kept::Client& in) {
  ClientState out;
  out.id = id;
  out.secretHash = in.secret_hash();
  for (const pb::EditAck& outcome : in.outcomes()) out.outcomes.push_back(readOutcome(outcome));
  out.forgottenUpTo = in.forgotten_up_to();
  out.acceptedSequence = in.accepted_sequence();
  out.acceptedRevision = in.accepted_revision();
  return out;
}

Expected<Grid> gridFrom(const pb::Grid& in) {
  Grid grid;
  grid.origin = fromProto(in.origin());
  grid.cell = in.cell_size();
  grid.dims = {in.dims().x(), in.dims().y(), in.dims().z()};
  for (int axis = 0; axis < 3; ++axis) {
    // Of any scene that floats can shade.
    const bool sane = std::abs(grid.origin[axis]) <= 1e12 && grid.cell >= 1e-12 && grid.cell <= 1e12;
    if (!sane || grid.dims[axis] < 1 || grid.dims[axis] > kMaxCellsPerAxis) {
      return Status(Code::kDataLoss, "the grid is out of range");
    }
  }
  return grid;
}

/// Settings, grid and revisions.
Status frameFrom(const kept::Snapshot& in, SavedSession* out) {
  const Expected<Settings> settings = fromProto(in.settings());
  if (!settings) return Status(Code::kDataLoss, settings.status().message());
  if (Status s = checkSavedOptions(settings->options); !s.ok()) return Status(Code::kDataLoss, s.message());
  const Expected<Grid> grid = gridFrom(in.grid());
  if (!grid) return grid.status();
  out->manners = settings->manners;
  DocumentState& document = out->document;
  document.options = settings->options;
  document.optionsRevision = in.settings_revision();
  document.grid = *grid;
  document.gridRevision = in.grid_revision();
  document.revision = in.revision();
  for (const kept::Tombstone& deleted : in.tombstones()) document.tombstones.push_back(readDeleted(deleted));
  document.forgottenUpTo = in.forgotten_up_to();
  return {};
}

/// Revisions count on from the session's, and nothing in it is from after that.
Status checkRevisions(const DocumentState& document) {
  constexpr auto kLast = std::uint64_t(std::numeric_limits<std::int64_t>::max());
  if (document.revision > kLast) {
    return {Code::kDataLoss,
            "its revision is " + std::to_string(document.revision) + ", allowed are up to " + std::to_string(kLast)};
  }
  Status status;
  const auto check = [&](const char* kind, const std::string& name, std::uint64_t revision) {
    if (revision <= document.revision || !status.ok()) return;
    const std::string why =
        "is of revision " + std::to_string(revision) + ", the session of " + std::to_string(document.revision);
    status = outOfRange(kind, name, invalid("revision", why));
  };
  check("part", "settings", document.optionsRevision);
  check("part", "grid", document.gridRevision);
  check("part", "deletions", document.forgottenUpTo);
  for (const Versioned<Light>& light : document.lights) check("light", light.object->name, light.revision);
  for (const Versioned<Surface>& surface : document.surfaces) check("surface", surface.object->name, surface.revision);
  for (const DocumentState::Camera& camera : document.cameras) check("camera", camera.name, camera.revision);
  for (const Deleted& deleted : document.tombstones) check("deletion of", deleted.name, deleted.revision);
  return status;
}

/// Textures have no bytes but those of their upload: what an object wears is kept as one, whatever a file says.
void addTextures(const Contents& contents, SavedSession* out) {
  std::set<BlobHash> there;
  for (const BlobPtr& blob : out->uploads) there.insert(blob->hash);
  const auto add = [&](const TexturePtr& texture) {
    if (texture && there.insert(texture->hash).second) out->uploads.push_back(contents.blob(texture->hash));
  };
  for (const Versioned<Light>& light : out->document.lights) add(light.object->texture);
  for (const Versioned<Surface>& surface : out->document.surfaces) add(surface.object->albedoTexture);
}

Status fill(const store::Loaded& loaded, SavedSession* out) {
  const kept::Snapshot& snapshot = loaded.snapshot;
  if (Status s = frameFrom(snapshot, out); !s.ok()) return s;
  Contents contents;
  for (const store::Content& content : loaded.contents) {
    if (Status s = contents.add(content); !s.ok()) return s;
  }
  if (Status s = objectsFrom(snapshot, contents, &out->document); !s.ok()) return s;
  if (Status s = checkRevisions(out->document); !s.ok()) return s;
  for (const auto& [id, client] : snapshot.clients()) out->clients.push_back(clientFrom(id, client));
  for (const auto& [hash, kind] : snapshot.uploads()) {
    const BlobPtr blob = contents.blob(hash);
    if (!blob) return {Code::kDataLoss, "content " + hash + " is missing"};
    out->uploads.push_back(blob);
  }
  addTextures(contents, out);
  return {};
}

}  // namespace

Expected<SavedSession> fromStore(const store::Loaded& loaded) {
  SavedSession out;
  out.id = loaded.head.id;
  out.epoch = loaded.head.epoch;
  out.requestId = loaded.head.requestId;
  out.created = loaded.head.created;
  const Status status = fill(loaded, &out);
  if (status.ok()) return out;
  return Status(status.code(), "session \"" + out.id + "\" cannot be read: " + status.message());
}

Expected<SessionSummary> summaryOf(const store::Loaded& loaded) {
  SavedSession state;
  if (Status s = frameFrom(loaded.snapshot, &state); !s.ok()) return s;
  SessionSummary out;
  out.id = loaded.head.id;
  out.displayName = state.manners.displayName;
  out.options = state.document.options;
  out.grid = state.document.grid;
  out.revision = state.document.revision;
  out.epoch = loaded.head.epoch;
  out.created = loaded.head.created;
  out.lastUsed = loaded.head.lastUsed;
  out.ttl = state.manners.ttl;
  out.lights = loaded.snapshot.lights().size();
  out.surfaces = loaded.snapshot.surfaces().size();
  const auto count = [&out](std::int64_t triangles) {
    // As many as indices can name: a file may say anything, and the sum has to be one.
    out.triangles += std::clamp<std::int64_t>(triangles, 0, std::numeric_limits<std::uint32_t>::max());
  };
  for (const auto& [name, light] : loaded.snapshot.lights()) count(light.status().triangle_count());
  for (const auto& [name, surface] : loaded.snapshot.surfaces()) count(surface.triangle_count());
  out.clients = loaded.snapshot.clients().size();
  out.durability = Durability::kDisk;
  return out;
}

}  // namespace lpv::api
