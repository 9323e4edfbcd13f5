// What each operation of an edit does to the scene.

#include <array>
#include <cstdio>

#include "base/text.h"
#include "scene/grid_choice.h"
#include "session/document/document.h"

namespace lpv {
namespace {

Status noSuch(const char* what, const std::string& name, const char* field = "name") {
  return Status(Code::kNotFound,
                std::string("there is no ") + what + " \"" + truncatedUtf8(name) + "\" in this session", field);
}

/// The mesh of that hash that an object has: meshes that came within an edit are no blobs.
template <typename Objects>
MeshPtr meshAmong(const Objects& objects, const BlobHash& hash) {
  for (const auto& [name, entry] : objects) {
    if (entry.object->mesh && entry.object->mesh->hash == hash) return entry.object->mesh;
  }
  return nullptr;
}

Expected<MeshPtr> resolveMesh(const MeshReference& reference, const Blobs& blobs) {
  if (reference.mesh) return reference.mesh;
  const BlobPtr blob = blobs.find(reference.hash);
  if (blob && blob->mesh) return blob->mesh;
  return Status(
      Code::kNotFound,
      blob ? "mesh " + truncatedUtf8(reference.hash) + " is a texture, not a mesh"
           : "mesh \"" + truncatedUtf8(reference.hash) + "\" is not in this session; upload it with UploadBlob first",
      "mesh");
}

Expected<TexturePtr> resolveTexture(const char* field, const BlobHash& hash, const Blobs& blobs) {
  if (hash.empty()) return TexturePtr();
  const BlobPtr blob = blobs.find(hash);
  if (blob && blob->texture) return blob->texture;
  return Status(Code::kNotFound,
                std::string(field) + " \"" + truncatedUtf8(hash) +
                    "\" is no texture of this session; upload it with UploadBlob first",
                field);
}

/// A texture of a T, and its path in an edit.
template <typename T>
struct TextureSlot {
  TexturePtr T::*member;
  std::optional<BlobHash> FieldsOf<T>::*given;
  const char* path;
};
template <typename T>
constexpr std::array<TextureSlot<T>, 0> kTextures = {};
template <>
constexpr std::array kTextures<Light> = {TextureSlot<Light>{&Light::texture, &LightFields::texture, "texture"}};
template <>
constexpr std::array kTextures<Surface> = {
    TextureSlot<Surface>{&Surface::albedoTexture, &SurfaceFields::albedoTexture, "albedo_texture"},
    TextureSlot<Surface>{&Surface::normalTexture, &SurfaceFields::normalTexture, "normal_texture"},
    TextureSlot<Surface>{&Surface::glossTexture, &SurfaceFields::glossTexture, "gloss_texture"}};

/// What the fields of a light may not be together.
Status checkTogether(const Light& light) {
  if (!light.distant || !light.power) return {};
  return invalid("power", "power: a distant light has no area that it could be spread over; give its radiance");
}

Status checkTogether(const Surface&) { return {}; }

template <typename T>
Status assign(T& object, const FieldsOf<T>& f, const Blobs& blobs) {
  if (Status s = checkFields(f); !s.ok()) return s;
  if (f.mesh) {
    Expected<MeshPtr> mesh = resolveMesh(*f.mesh, blobs);
    if (!mesh) return mesh.status();
    object.mesh = *mesh;
  }
  for (const TextureSlot<T>& slot : kTextures<T>) {
    const std::optional<BlobHash>& hash = f.*slot.given;
    if (!hash) continue;
    Expected<TexturePtr> texture = resolveTexture(slot.path, *hash, blobs);
    if (!texture) return texture.status();
    object.*slot.member = *texture;
  }
  Expected<Transform> transform = withFields(object.transform, f.transform);
  if (!transform) return transform.status().within("transform");
  object.transform = *transform;
  assignValues(object, f);
  return checkTogether(object);
}

/// What an edit calls objects of a kind.
template <typename T>
struct Words;
template <>
struct Words<Light> {
  static constexpr ObjectKind kKind = ObjectKind::kLight;
  static constexpr const char* kNoun = "light";
  static constexpr const char* kCreate = "create_light";
  static constexpr const char* kUpdate = "update_light.light";
  static constexpr const char* kDelete = "delete_light";
};
template <>
struct Words<Surface> {
  static constexpr ObjectKind kKind = ObjectKind::kSurface;
  static constexpr const char* kNoun = "surface";
  static constexpr const char* kCreate = "create_surface";
  static constexpr const char* kUpdate = "update_surface.surface";
  static constexpr const char* kDelete = "delete_surface";
};

/// Remembers what `name` was before the first change of this edit.
template <typename Map, typename Before>
void remember(const Map& objects, const std::string& name, Before& before) {
  if (before.contains(name)) return;
  const auto found = objects.find(name);
  if (found == objects.end()) {
    before[name] = std::nullopt;
  } else {
    before[name] = found->second;
  }
}

}  // namespace

template <typename T>
void Document::put(const std::string& name, std::shared_ptr<const T> object, Rollback& rollback) {
  remember(objects<T>(), name, rollback.before<T>());
  objects<T>()[name] = {std::move(object), revision_};
}

template <typename Fields>
Fields Document::withMeshInUse(const Fields& fields, const Blobs& blobs) const {
  Fields out = fields;
  if (!out.mesh || out.mesh->mesh || blobs.find(out.mesh->hash)) return out;
  out.mesh->mesh = meshAmong(lights_, out.mesh->hash);
  if (!out.mesh->mesh) out.mesh->mesh = meshAmong(surfaces_, out.mesh->hash);
  return out;
}

template <typename T>
Expected<std::string> Document::create(const std::string& name, const auto& fields, const Blobs& blobs,
                                       Rollback& rollback) {
  using W = Words<T>;
  if (Status s = checkName(name); !s.ok()) return s.within(W::kCreate);
  if (!fields.mesh) {
    return invalid(std::string(W::kCreate) + ".mesh",
                   std::string("a ") + W::kNoun + " needs a mesh: set mesh or inline_mesh");
  }
  auto object = std::make_shared<T>();
  if (Status s = assign(*object, withMeshInUse(fields, blobs), blobs); !s.ok()) return s.within(W::kCreate);
  object->name = freeName(name);
  put<T>(object->name, object, rollback);
  rollback.contentAdded = true;
  return object->name;
}

template <typename T>
Expected<std::string> Document::update(const std::string& name, const auto& fields, const Blobs& blobs,
                                       Rollback& rollback) {
  using W = Words<T>;
  const auto found = objects<T>().find(name);
  if (found == objects<T>().end()) return noSuch(W::kNoun, name).within(W::kUpdate);
  auto object = std::make_shared<T>(*found->second.object);
  if (Status s = assign(*object, withMeshInUse(fields, blobs), blobs); !s.ok()) return s.within(W::kUpdate);
  put<T>(name, object, rollback);
  return name;
}

template <typename T>
Expected<std::string> Document::remove(const std::string& name, Rollback& rollback) {
  using W = Words<T>;
  if (!objects<T>().contains(name)) return noSuch(W::kNoun, name, W::kDelete);
  remember(objects<T>(), name, rollback.before<T>());
  objects<T>().erase(name);
  tombstones_.push_back({W::kKind, name, revision_});
  rollback.contentRemoved = true;
  return name;
}

template <typename T>
void Document::deform(const std::string& name, const MeshPtr& mesh, Rollback& rollback) {
  auto object = std::make_shared<T>(*objects<T>().at(name).object);
  object->mesh = mesh;
  put<T>(name, object, rollback);
}

Expected<std::string> Document::applyOne(const CreateLight& op, const Blobs& blobs, Rollback& rollback) {
  return create<Light>(op.name, op.fields, blobs, rollback);
}

Expected<std::string> Document::applyOne(const UpdateLight& op, const Blobs& blobs, Rollback& rollback) {
  return update<Light>(op.name, op.fields, blobs, rollback);
}

Expected<std::string> Document::applyOne(const DeleteLight& op, const Blobs&, Rollback& rollback) {
  return remove<Light>(op.name, rollback);
}

Expected<std::string> Document::applyOne(const CreateSurface& op, const Blobs& blobs, Rollback& rollback) {
  return create<Surface>(op.name, op.fields, blobs, rollback);
}

Expected<std::string> Document::applyOne(const UpdateSurface& op, const Blobs& blobs, Rollback& rollback) {
  return update<Surface>(op.name, op.fields, blobs, rollback);
}

Expected<std::string> Document::applyOne(const DeleteSurface& op, const Blobs&, Rollback& rollback) {
  return remove<Surface>(op.name, rollback);
}

Expected<std::string> Document::applyOne(const SetVertices& op, const Blobs&, Rollback& rollback) {
  const MeshPtr current = meshOf(op.object);
  if (!current) return noSuch("light or surface", op.object, "object").within("set_vertices");
  MeshPtr deformed = op.deformed;
  // The mesh was exchanged, or made by this very edit, after the preparation; or that failed, and says here why.
  if (op.base != current || !deformed) {
    SetVertices again = op;
    if (Status s = prepareVertices(again, current, hasher_); !s.ok()) return s.within("set_vertices");
    deformed = again.deformed;
  }
  if (lights_.contains(op.object)) {
    deform<Light>(op.object, deformed, rollback);
  } else {
    deform<Surface>(op.object, deformed, rollback);
  }
  return op.object;
}

Expected<std::string> Document::applyOne(const PutCamera& op, const Blobs&, Rollback& rollback) {
  if (Status s = checkName(op.name); !s.ok()) return s.within("put_camera");
  if (Status s = checkCamera(op.camera); !s.ok()) return s.within("put_camera");
  remember(cameras_, op.name, rollback.cameras);
  cameras_[op.name] = {op.camera, revision_};
  return op.name;
}

Expected<std::string> Document::applyOne(const DeleteCamera& op, const Blobs&, Rollback& rollback) {
  if (!cameras_.contains(op.name)) return noSuch("camera", op.name, "delete_camera");
  remember(cameras_, op.name, rollback.cameras);
  cameras_.erase(op.name);
  tombstones_.push_back({ObjectKind::kCamera, op.name, revision_});
  return op.name;
}

Expected<std::string> Document::applyOne(const FitGrid&, const Blobs&, Rollback& rollback) {
  if (options_.grid.hasBounds && !choosesCells(options_.grid)) {
    return Status(Code::kFailedPrecondition, Reason::kFixedBounds,
                  "the grid has fixed bounds; clear settings.grid.bounds to fit it", "fit_grid");
  }
  if (Status s = refit(true, rollback); !s.ok()) return s.within("fit_grid");
  rollback.fitted = true;
  return std::string();
}

template <typename T>
void Document::restoreOne(const std::string& name, const std::shared_ptr<const T>& object, Rollback& rollback) {
  const bool stands = objects<T>().contains(name);
  if (object) {
    put<T>(name, object, rollback);
    rollback.contentAdded = rollback.contentAdded || !stands;
  } else if (stands) {
    (void)remove<T>(name, rollback);
  }
}

/// What stands under the name, of whatever kind, gives way.
void Document::restoreOne(const NamedState& wanted, Rollback& rollback) {
  const auto& [key, object] = wanted;
  if (!key.camera) {
    restoreOne<Light>(key.name, object.light, rollback);
    restoreOne<Surface>(key.name, object.surface, rollback);
  } else if (object.camera || cameras_.contains(key.name)) {
    remember(cameras_, key.name, rollback.cameras);
    if (object.camera) {
      cameras_[key.name] = {*object.camera, revision_};
    } else {
      cameras_.erase(key.name);
      tombstones_.push_back({ObjectKind::kCamera, key.name, revision_});
    }
  }
}

std::string Document::freeName(const std::string& wanted) const {
  std::string name = wanted;
  for (int n = 1; lights_.contains(name) || surfaces_.contains(name); ++n) {
    char suffix[16];
    const int length = std::snprintf(suffix, sizeof suffix, ".%03d", n);
    name = truncatedUtf8(wanted, kMaxNameBytes - std::size_t(length)) + suffix;
  }
  return name;
}

Status prepareVertices(SetVertices& op, const MeshPtr& base, const MeshHasher& hasher) {
  op.base = base;
  op.deformed.reset();
  if (!base) return {};  // the document says that the object is not there, or finds it made by the same edit
  Expected<Mesh> mesh = withVertices(*base, op.positions, op.normals);
  if (!mesh) return mesh.status();
  mesh->hash = hasher(*mesh);
  op.deformed = std::make_shared<const Mesh>(std::move(*mesh));
  return {};
}

}  // namespace lpv
