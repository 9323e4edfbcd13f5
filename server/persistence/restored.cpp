// From what is kept to sessions. A file may be anybody's: nothing in it is taken on trust.

#include <google/protobuf/unknown_field_set.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "convert/blob_content.h"
#include "convert/geometry.h"
#include "convert/scene.h"
#include "convert/session.h"
#include "convert/wire_fields.h"
#include "persistence/snapshot.h"

namespace lpv::api {
namespace {

Deleted readDeleted(const kept::Tombstone& in) {
  const ObjectKind kind = in.kind() == kept::Tombstone::KIND_LIGHT     ? ObjectKind::kLight
                          : in.kind() == kept::Tombstone::KIND_SURFACE ? ObjectKind::kSurface
                                                                       : ObjectKind::kCamera;
  return {kind, in.name(), in.revision()};
}

EditOutcome readOutcome(const pb::EditAck& in) {
  return {in.sequence(),
          fromProto(in.status()),
          in.revision(),
          {in.names().begin(), in.names().end()},
          {in.skipped_fields().begin(), in.skipped_fields().end()}};
}

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
  LightFields given;
  if (in.has_power()) {
    given.power = fromProto(in.power());
  } else {
    given.radiance = fromProto(in.radiance());
  }
  takeStored<Light>(in, &given);
  Status status = checkName(in.name());
  if (status.ok()) status = checkFields(given);
  if (!status.ok()) return outOfRange("light", in.name(), status);
  assignValues(*light, given);
  return Versioned<Light>{light, in.status().revision()};
}

/// Surfaces kept before the field two_sided had the opposite, one_sided, as field 9, left out where it was false.
bool wasOneSided(const pb::Surface& in) {
  constexpr int kOneSided = 9;
  const google::protobuf::UnknownFieldSet& fields = in.GetReflection()->GetUnknownFields(in);
  bool oneSided = false;
  for (int i = 0; i < fields.field_count(); ++i) {
    const google::protobuf::UnknownField& field = fields.field(i);
    if (field.number() == kOneSided && field.type() == google::protobuf::UnknownField::TYPE_VARINT) {
      oneSided = field.varint() != 0;
    }
  }
  return oneSided;
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
  const Expected<TexturePtr> normals = contents.texture(in.normal_texture());
  if (!normals) return normals.status();
  surface->normalTexture = *normals;
  const Expected<TexturePtr> gloss = contents.texture(in.gloss_texture());
  if (!gloss) return gloss.status();
  surface->glossTexture = *gloss;
  const Expected<Transform> transform = transformOf(in.transform());
  if (!transform) return outOfRange("surface", in.name(), transform.status());
  surface->transform = *transform;
  SurfaceFields given;
  takeStored<Surface>(in, &given);
  if (!in.has_two_sided()) given.twoSided = !wasOneSided(in);
  Status status = checkName(in.name());
  if (status.ok()) status = checkFields(given);
  if (!status.ok()) return outOfRange("surface", in.name(), status);
  assignValues(*surface, given);
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
  out.outcomeHorizon = in.outcome_horizon();
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
  const Expected<SessionSettings> settings = fromProto(in.settings());
  if (!settings) return Status(Code::kDataLoss, settings.status().message());
  if (Status s = checkSavedOptions(settings->options); !s.ok()) return Status(Code::kDataLoss, s.message());
  const Expected<Grid> grid = gridFrom(in.grid());
  if (!grid) return grid.status();
  out->policy = settings->policy;
  DocumentState& document = out->document;
  document.options = settings->options;
  document.optionsRevision = in.settings_revision();
  document.grid = *grid;
  document.gridRevision = in.grid_revision();
  document.revision = in.revision();
  for (const kept::Tombstone& deleted : in.tombstones()) document.tombstones.push_back(readDeleted(deleted));
  document.tombstoneHorizon = in.tombstone_horizon();
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
  check("part", "deletions", document.tombstoneHorizon);
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
  for (const Versioned<Surface>& surface : out->document.surfaces) {
    for (const TexturePtr& texture : texturesOf(*surface.object)) add(texture);
  }
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
  out.displayName = state.policy.displayName;
  out.options = state.document.options;
  out.grid = state.document.grid;
  out.revision = state.document.revision;
  out.epoch = loaded.head.epoch;
  out.created = loaded.head.created;
  out.lastUsed = loaded.head.lastUsed;
  out.ttl = state.policy.ttl;
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
