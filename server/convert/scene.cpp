#include "convert/scene.h"

#include <algorithm>

#include "convert/blob_content.h"
#include "convert/geometry.h"
#include "convert/session.h"
#include "convert/wire_fields.h"
#include "scene/distant_lights.h"

namespace lpv::api {
namespace {

constexpr std::size_t kMaxUndoGroupBytes = 100;
constexpr std::size_t kObjectsPerPart = 1000;  // an object is a few hundred bytes: a part stays far below 1 MiB

/// Which fields of an object a message names: those of a mask, or those that are set in a new object.
class FieldSelection {
 public:
  FieldSelection() = default;
  explicit FieldSelection(const google::protobuf::FieldMask& mask) : mask_(&mask) {}

  bool isNew() const { return mask_ == nullptr; }
  /// True for `path` in the mask; for a new object, what `present` says.
  bool operator()(const char* path, bool present) const {
    if (isNew()) return present;
    for (const std::string& candidate : mask_->paths()) {
      if (candidate == path) return true;
    }
    return false;
  }
  /// INVALID_ARGUMENT for an empty mask or a path that `known` does not have.
  Status check(const std::vector<std::string>& known) const {
    if (isNew()) return {};
    if (mask_->paths().empty()) return invalid("update_mask", "update_mask names no field; say what shall change");
    for (const std::string& path : mask_->paths()) {
      if (std::find(known.begin(), known.end(), path) == known.end()) {
        return invalid("update_mask", "update_mask has the unknown path \"" + path + "\"");
      }
    }
    return {};
  }

 private:
  const google::protobuf::FieldMask* mask_ = nullptr;
};

/// A named field that a mask mentions but the message leaves out goes back to its default.
Expected<TransformFields> transformFields(const pb::Transform& in, bool isSet, const FieldSelection& named) {
  const Expected<TransformFields> given = fromProto(in);
  if (!given) return given.status();
  if (named("transform", isSet)) {
    if (named.isNew()) return *given;
    const Transform identity;
    return TransformFields{given->translation.value_or(identity.translation),
                           given->rotation.value_or(identity.rotation), given->scale.value_or(identity.scale)};
  }
  TransformFields out;
  const Transform identity;
  if (named("transform.translation", false)) out.translation = given->translation.value_or(identity.translation);
  if (named("transform.rotation", false)) out.rotation = given->rotation.value_or(identity.rotation);
  if (named("transform.scale", false)) out.scale = given->scale.value_or(identity.scale);
  return out;
}

/// `mesh` or `inline_mesh` of a light or surface.
template <typename Message>
Status takeMesh(const Message& in, const FieldSelection& named, std::optional<MeshReference>* out) {
  const bool inlined = named("inline_mesh", in.has_inline_mesh());
  const bool byHash = named("mesh", !in.mesh().empty());
  if (inlined && byHash) return invalid("mesh", "mesh and inline_mesh are both given; give one");
  if (byHash) *out = MeshReference{in.mesh(), nullptr};
  if (!inlined) return {};
  const Expected<MeshPtr> mesh = inlineMesh(in.inline_mesh());
  if (!mesh) return mesh.status().within("inline_mesh");
  *out = MeshReference{(*mesh)->hash, *mesh};
  return {};
}

/// Takes the plain fields that the message names. One that a mask names but the message leaves out goes back to its
/// default where the message can tell absence, else to proto's default; a Vec3 goes to 0, 0, 0.
template <typename T>
void takePlain(const MessageOf<T>& in, const FieldSelection& named, FieldsOf<T>* out) {
  const auto& places = wireFields<T>();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const WireField& place = places[i];
    const Field<T>& field = fieldTable<T>()[i];
    if (!place || !named(field.path, named.isNew() && isPresent(in, place))) continue;
    const bool isDefault = place.hasOwnDefault() && !isPresent(in, place);
    field.give(*out, isDefault ? field.get(T()) : readField(in, place));
  }
}

/// The paths that an update mask of a T may have.
template <typename T>
const std::vector<std::string>& maskPaths() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> out = {"inline_mesh", "transform"};
    for (const Field<T>& field : fieldTable<T>()) {
      out.emplace_back(field.path);
      if (field.kind == FieldKind::kEmission) out.emplace_back("power");
    }
    return out;
  }();
  return all;
}

/// Mesh, transform and the plain fields.
template <typename T>
Status takeCommon(const MessageOf<T>& in, const FieldSelection& named, FieldsOf<T>* out) {
  if (Status s = takeMesh(in, named, &out->mesh); !s.ok()) return s;
  const Expected<TransformFields> transform = transformFields(in.transform(), in.has_transform(), named);
  if (!transform) return transform.status().within("transform");
  out->transform = *transform;
  takePlain<T>(in, named, out);
  return {};
}

/// What a distant light without a mesh has: one for all sessions.
const Expected<MeshPtr>& skyAsBlob() {
  static const Expected<MeshPtr> sky = inlineMesh(meshToProto(skyMesh()));
  return sky;
}

Expected<LightFields> lightFields(const pb::Light& in, const FieldSelection& named) {
  LightFields out;
  if (Status s = takeCommon<Light>(in, named, &out); !s.ok()) return s;
  if (named("radiance", in.has_radiance())) out.radiance = fromProto(in.radiance());
  if (named("power", in.has_power())) out.power = fromProto(in.power());
  if (out.radiance && out.power) return invalid("power", "radiance and power are both to change; give one");
  if (named("texture", !in.texture().empty())) out.texture = in.texture();
  if (named.isNew() && in.distant() && !out.mesh) {
    const Expected<MeshPtr> sky = skyAsBlob();
    if (!sky) return sky.status();
    out.mesh = MeshReference{(*sky)->hash, *sky};
  }
  return out;
}

Expected<SurfaceFields> surfaceFields(const pb::Surface& in, const FieldSelection& named) {
  SurfaceFields out;
  if (Status s = takeCommon<Surface>(in, named, &out); !s.ok()) return s;
  if (named("albedo_texture", !in.albedo_texture().empty())) out.albedoTexture = in.albedo_texture();
  if (named("normal_texture", !in.normal_texture().empty())) out.normalTexture = in.normal_texture();
  if (named("gloss_texture", !in.gloss_texture().empty())) out.glossTexture = in.gloss_texture();
  return out;
}

Expected<Operation> setVertices(const pb::SetVertices& in) {
  Expected<std::vector<glm::vec3>> positions = vec3sFromBytes("positions", in.positions());
  if (!positions) return positions.status();
  Expected<std::vector<glm::vec3>> normals = vec3sFromBytes("normals", in.normals());
  if (!normals) return normals.status();
  return Operation(SetVertices{in.object(), std::move(*positions), std::move(*normals), nullptr, nullptr});
}

/// An operation, or what is wrong with it, named from the operation's field.
template <typename Created, typename Fields>
Expected<Operation> operationOf(const char* place, const std::string& name, const Expected<Fields>& fields) {
  if (!fields) return fields.status().within(place);
  return Operation(Created{name, *fields});
}

Expected<Operation> operationFromProto(const pb::Operation& op) {
  switch (op.operation_case()) {
    case pb::Operation::kCreateLight:
      return operationOf<CreateLight>("create_light", op.create_light().name(),
                                      lightFields(op.create_light(), FieldSelection()));
    case pb::Operation::kUpdateLight: {
      const pb::UpdateLight& update = op.update_light();
      const FieldSelection named(update.update_mask());
      if (Status s = named.check(maskPaths<Light>()); !s.ok()) return s.within("update_light");
      return operationOf<UpdateLight>("update_light.light", update.light().name(), lightFields(update.light(), named));
    }
    case pb::Operation::kDeleteLight:
      return Operation(DeleteLight{op.delete_light()});
    case pb::Operation::kCreateSurface:
      return operationOf<CreateSurface>("create_surface", op.create_surface().name(),
                                        surfaceFields(op.create_surface(), FieldSelection()));
    case pb::Operation::kUpdateSurface: {
      const pb::UpdateSurface& update = op.update_surface();
      const FieldSelection named(update.update_mask());
      if (Status s = named.check(maskPaths<Surface>()); !s.ok()) return s.within("update_surface");
      return operationOf<UpdateSurface>("update_surface.surface", update.surface().name(),
                                        surfaceFields(update.surface(), named));
    }
    case pb::Operation::kDeleteSurface:
      return Operation(DeleteSurface{op.delete_surface()});
    case pb::Operation::kSetVertices: {
      const Expected<Operation> out = setVertices(op.set_vertices());
      if (!out) return out.status().within("set_vertices");
      return out;
    }
    case pb::Operation::kPutCamera: {
      const Expected<Camera> camera = fromProto(op.put_camera());
      if (!camera) return camera.status().within("put_camera");
      return Operation(PutCamera{op.put_camera().name(), *camera});
    }
    case pb::Operation::kDeleteCamera:
      return Operation(DeleteCamera{op.delete_camera()});
    case pb::Operation::kFitGrid:
      return Operation(FitGrid{});
    case pb::Operation::OPERATION_NOT_SET:
      break;
  }
  return invalid("", "the operation is not set, or newer than this server");
}

}  // namespace

Expected<Edit> fromProto(const pb::Edit& in, const Limits& limits) {
  if (in.operations_size() < 1 || in.operations_size() > limits.maxOperationsPerEdit) {
    return invalid("edit.operations", "operations has " + std::to_string(in.operations_size()) +
                                          " entries, allowed are 1 to " + std::to_string(limits.maxOperationsPerEdit));
  }
  if (in.undo_group().size() > kMaxUndoGroupBytes) {
    return invalid("edit.undo_group", "undo_group has " + std::to_string(in.undo_group().size()) +
                                          " bytes, allowed are " + std::to_string(kMaxUndoGroupBytes));
  }
  Edit out;
  out.sequence = in.sequence();
  if (in.has_expected_revision()) out.expectedRevision = in.expected_revision();
  out.undoGroup = in.undo_group();
  for (int i = 0; i < in.operations_size(); ++i) {
    Expected<Operation> operation = operationFromProto(in.operations(i));
    if (!operation) return operation.status().within("edit.operations[" + std::to_string(i) + "]");
    out.operations.push_back(std::move(*operation));
  }
  return out;
}

void toProto(const Versioned<Light>& in, pb::Light* out) {
  const Light& light = *in.object;
  out->set_name(light.name);
  out->set_mesh(light.mesh->hash);
  toProto(light.transform, out->mutable_transform());
  if (light.power) {
    toProto(*light.power, out->mutable_power());
  } else {
    toProto(light.radiance, out->mutable_radiance());
  }
  if (light.texture) out->set_texture(light.texture->hash);
  writePlain(light, out);
  out->mutable_status()->set_triangle_count(std::int64_t(light.mesh->triangles.size()));
  out->mutable_status()->set_revision(in.revision);
}

void toProto(const Versioned<Surface>& in, pb::Surface* out) {
  const Surface& surface = *in.object;
  out->set_name(surface.name);
  out->set_mesh(surface.mesh->hash);
  toProto(surface.transform, out->mutable_transform());
  if (surface.albedoTexture) out->set_albedo_texture(surface.albedoTexture->hash);
  if (surface.normalTexture) out->set_normal_texture(surface.normalTexture->hash);
  if (surface.glossTexture) out->set_gloss_texture(surface.glossTexture->hash);
  writePlain(surface, out);
  out->set_revision(in.revision);
  out->set_triangle_count(std::int64_t(surface.mesh->triangles.size()));
}

constexpr const char* kErrorDomain = "lpv.v1";
/// lpv.v1.ErrorInfo has the fields of google.rpc.ErrorInfo, and is read under that name by common libraries.
constexpr const char* kErrorInfoType = "type.googleapis.com/google.rpc.ErrorInfo";
constexpr const char* kRetryInfoType = "type.googleapis.com/google.rpc.RetryInfo";
constexpr std::int64_t kLongestPause = 86'400;  ///< seconds

void toProto(std::chrono::milliseconds in, google::protobuf::Duration* out) {
  out->set_seconds(in.count() / 1000);
  out->set_nanos(std::int32_t(in.count() % 1000) * 1'000'000);
}

/// Of a file too, which may be anybody's.
std::chrono::milliseconds pauseFrom(const google::protobuf::Duration& in) {
  const std::int64_t seconds = std::clamp<std::int64_t>(in.seconds(), 0, kLongestPause);
  return std::chrono::milliseconds(seconds * 1000 + std::clamp(in.nanos(), 0, 999'999'999) / 1'000'000);
}

std::string inLowerCase(std::string_view name) {
  std::string out(name);
  for (char& c : out) {
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  }
  return out;
}

void toProto(const Status& status, pb::Status* out) {
  out->set_code(static_cast<int>(status.code()));
  out->set_message(status.message());
  if (!status.field().empty()) {
    pb::FieldViolation violation;
    violation.set_field(status.field());
    out->add_details()->PackFrom(violation);
  }
  if (status.retryAfter() > std::chrono::milliseconds(0)) {
    pb::RetryInfo retry;
    toProto(status.retryAfter(), retry.mutable_retry_delay());
    google::protobuf::Any* any = out->add_details();
    any->set_type_url(kRetryInfoType);
    any->set_value(retry.SerializeAsString());
  }
  if (status.reason() == Reason::kNone) return;
  pb::ErrorInfo info;
  info.set_reason(std::string(nameOf(status.reason())));
  info.set_domain(kErrorDomain);
  if (isLimit(status.reason())) (*info.mutable_metadata())["limit"] = inLowerCase(nameOf(status.reason()));
  google::protobuf::Any* any = out->add_details();
  any->set_type_url(kErrorInfoType);
  any->set_value(info.SerializeAsString());
}

Status fromProto(const pb::Status& status) {
  pb::FieldViolation violation;
  pb::ErrorInfo info;
  pb::RetryInfo retry;
  for (const google::protobuf::Any& any : status.details()) {
    if (any.Is<pb::FieldViolation>()) (void)any.UnpackTo(&violation);
    if (any.type_url() == kErrorInfoType) (void)info.ParseFromString(any.value());
    if (any.type_url() == kRetryInfoType) (void)retry.ParseFromString(any.value());
  }
  const Reason reason = info.domain() == kErrorDomain ? reasonNamed(info.reason()) : Reason::kNone;
  return Status(static_cast<Code>(status.code()), reason, status.message(), violation.field())
      .retriedAfter(pauseFrom(retry.retry_delay()));
}

void toProto(const EditOutcome& outcome, const Session& session, pb::EditAck* out) {
  out->set_sequence(outcome.sequence);
  toProto(outcome.status, out->mutable_status());
  out->set_revision(outcome.revision);
  out->set_epoch(session.epoch());
  out->set_durability(toProto(session.durability()));
  for (const std::string& name : outcome.names) out->add_names(name);
  for (const std::string& field : outcome.skipped) out->add_skipped_fields(field);
}

namespace {

/// Deals objects out over messages: `current()` is a message with room for one more.
template <typename Part, typename NewPart>
class MessageSplitter {
 public:
  explicit MessageSplitter(NewPart newPart) : newPart_(newPart) { next(); }
  Part* current() {
    if (objects_++ == kObjectsPerPart) {
      part_->set_more(true);
      next();
    }
    return part_;
  }
  std::vector<pb::WatchSceneResponse> take() { return std::move(messages_); }

 private:
  void next() {
    messages_.emplace_back();
    part_ = newPart_(&messages_.back());
    objects_ = 1;
  }
  NewPart newPart_;
  std::vector<pb::WatchSceneResponse> messages_;
  Part* part_ = nullptr;
  std::size_t objects_ = 0;
};

template <typename Dealt>
void appendObjects(const Changes& changes, Dealt& parts) {
  if (changes.options) toProto(*changes.options, parts.current()->mutable_settings());
  if (changes.grid) toProto(*changes.grid, parts.current()->mutable_grid());
  for (const Versioned<Light>& light : changes.lights) toProto(light, parts.current()->add_lights());
  for (const Versioned<Surface>& surface : changes.surfaces) toProto(surface, parts.current()->add_surfaces());
  for (const auto& [name, camera] : changes.cameras) toProto(name, camera, parts.current()->add_cameras());
}

}  // namespace

std::vector<pb::WatchSceneResponse> toProto(const Changes& changes, std::uint64_t epoch, std::uint64_t since,
                                            const std::map<std::string, std::uint64_t>& clientSequences) {
  if (changes.snapshot) {
    const auto newPart = [&](pb::WatchSceneResponse* message) {
      pb::SceneSnapshot* part = message->mutable_snapshot();
      part->set_epoch(epoch);
      part->set_revision(changes.revision);
      return part;
    };
    MessageSplitter<pb::SceneSnapshot, decltype(newPart)> parts(newPart);
    appendObjects(changes, parts);
    return parts.take();
  }
  const auto newPart = [&](pb::WatchSceneResponse* message) {
    pb::SceneChange* part = message->mutable_change();
    part->set_epoch(epoch);
    part->set_first_revision(since + 1);
    part->set_last_revision(changes.revision);
    return part;
  };
  MessageSplitter<pb::SceneChange, decltype(newPart)> parts(newPart);
  for (const auto& [client, sequence] : clientSequences)
    (*parts.current()->mutable_client_sequences())[client] = sequence;
  for (const Deleted& deleted : changes.deleted) {
    pb::SceneChange* part = parts.current();
    if (deleted.kind == ObjectKind::kLight) part->add_deleted_lights(deleted.name);
    if (deleted.kind == ObjectKind::kSurface) part->add_deleted_surfaces(deleted.name);
    if (deleted.kind == ObjectKind::kCamera) part->add_deleted_cameras(deleted.name);
  }
  appendObjects(changes, parts);
  return parts.take();
}

}  // namespace lpv::api
