#include "session/document.h"

#include <algorithm>
#include <cstdio>

namespace lpv {
namespace {

Status noSuch(const char* what, const std::string& name, const char* field = "name") {
  return Status(Code::kNotFound, std::string("there is no ") + what + " \"" + name + "\" in this session", field);
}

Expected<MeshPtr> resolveMesh(const MeshReference& reference, const Blobs& blobs) {
  if (reference.mesh) return reference.mesh;
  const BlobPtr blob = blobs.find(reference.hash);
  if (blob && blob->mesh) return blob->mesh;
  return Status(Code::kNotFound,
                blob ? "mesh " + reference.hash + " is a texture, not a mesh"
                     : "mesh \"" + reference.hash + "\" is not in this session; upload it with UploadBlob first",
                "mesh");
}

Expected<TexturePtr> resolveTexture(const char* field, const BlobHash& hash, const Blobs& blobs) {
  if (hash.empty()) return TexturePtr();
  const BlobPtr blob = blobs.find(hash);
  if (blob && blob->texture) return blob->texture;
  return Status(Code::kNotFound,
                std::string(field) + " \"" + hash + "\" is no texture of this session; upload it with UploadBlob first",
                field);
}

Status assign(Light& light, const LightFields& f, const Blobs& blobs) {
  if (Status s = checkFields(f); !s.ok()) return s;
  if (f.mesh) {
    Expected<MeshPtr> mesh = resolveMesh(*f.mesh, blobs);
    if (!mesh) return mesh.status();
    if (!(*mesh)->directions.empty()) {
      return unimplemented("mesh", "mesh has emission directions: not built in this version; upload it without");
    }
    light.mesh = *mesh;
  }
  if (f.texture) {
    Expected<TexturePtr> texture = resolveTexture("texture", *f.texture, blobs);
    if (!texture) return texture.status();
    light.texture = *texture;
  }
  Expected<Transform> transform = withFields(light.transform, f.transform);
  if (!transform) return transform.status().within("transform");
  light.transform = *transform;
  if (f.radiance) {
    light.radiance = *f.radiance;
    light.power.reset();
  }
  if (f.power) light.power = f.power;
  light.twoSided = f.twoSided.value_or(light.twoSided);
  light.enabled = f.enabled.value_or(light.enabled);
  light.group = f.group.value_or(light.group);
  return {};
}

Status assign(Surface& surface, const SurfaceFields& f, const Blobs& blobs) {
  if (Status s = checkFields(f); !s.ok()) return s;
  if (f.mesh) {
    Expected<MeshPtr> mesh = resolveMesh(*f.mesh, blobs);
    if (!mesh) return mesh.status();
    surface.mesh = *mesh;
  }
  if (f.albedoTexture) {
    Expected<TexturePtr> texture = resolveTexture("albedo_texture", *f.albedoTexture, blobs);
    if (!texture) return texture.status();
    surface.albedoTexture = *texture;
  }
  Expected<Transform> transform = withFields(surface.transform, f.transform);
  if (!transform) return transform.status().within("transform");
  surface.transform = *transform;
  surface.albedo = f.albedo.value_or(surface.albedo);
  surface.roughness = f.roughness.value_or(surface.roughness);
  surface.metalness = f.metalness.value_or(surface.metalness);
  surface.twoSided = f.twoSided.value_or(surface.twoSided);
  return {};
}

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

template <typename Map, typename Before>
void restore(Map& objects, Before& before) {
  for (auto& [name, entry] : before) {
    if (entry) {
      objects[name] = *entry;
    } else {
      objects.erase(name);
    }
  }
}

template <typename T>
std::vector<Versioned<T>> newer(const std::map<std::string, Versioned<T>>& objects, std::uint64_t since, bool all) {
  std::vector<Versioned<T>> out;
  for (const auto& [name, entry] : objects) {
    if (all || entry.revision > since) out.push_back(entry);
  }
  return out;
}

}  // namespace

Document::Document(const SessionOptions& options, const Limits& limits, MeshHasher hasher)
    : limits_(limits), hasher_(std::move(hasher)), options_(options) {
  const Expected<Grid> grid =
      options.grid.hasBounds ? makeGrid(options.grid, options.grid.bounds) : fitGrid(options.grid, Bounds());
  grid_ = *grid;  // the caller has checked the options
}

MeshPtr Document::meshOf(const std::string& object) const {
  if (const auto light = lights_.find(object); light != lights_.end()) return light->second.object->mesh;
  if (const auto surface = surfaces_.find(object); surface != surfaces_.end()) return surface->second.object->mesh;
  return nullptr;
}

Expected<std::vector<std::string>> Document::apply(const Edit& edit, const Blobs& blobs) {
  if (edit.expectedRevision && *edit.expectedRevision != revision_) {
    return Status(Code::kAborted,
                  "expected_revision is " + std::to_string(*edit.expectedRevision) + ", the session is at revision " +
                      std::to_string(revision_) + "; read the scene again and repeat",
                  "expected_revision");
  }
  Undo undo{.lights = {},
            .surfaces = {},
            .cameras = {},
            .tombstones = tombstones_.size(),
            .grid = grid_,
            .gridRevision = gridRevision_,
            .contentAdded = false};
  ++revision_;
  std::vector<std::string> names;
  Status failed;
  for (std::size_t i = 0; i < edit.operations.size() && failed.ok(); ++i) {
    Expected<std::string> name =
        std::visit([&](const auto& op) { return applyOne(op, blobs, undo); }, edit.operations[i]);
    if (name) {
      names.push_back(*name);
    } else {
      failed = name.status().within("operations[" + std::to_string(i) + "]");
    }
  }
  if (failed.ok()) {
    recount();
    failed = checkTotals();
  }
  if (failed.ok() && undo.contentAdded) failed = refit(false);
  if (!failed.ok()) {
    takeBack(undo);
    return failed;
  }
  while (tombstones_.size() > kMaxTombstones) {
    forgottenUpTo_ = tombstones_.front().revision;
    tombstones_.pop_front();
  }
  return names;
}

void Document::takeBack(Undo& undo) {
  restore(lights_, undo.lights);
  restore(surfaces_, undo.surfaces);
  restore(cameras_, undo.cameras);
  tombstones_.resize(undo.tombstones, Deleted{});
  grid_ = undo.grid;
  gridRevision_ = undo.gridRevision;
  --revision_;
  recount();
}

Status Document::checkTotals() const {
  const auto over = [](const char* limit, std::int64_t have, std::int64_t allowed) {
    return exhausted(limit, std::string(limit) + ": the session would hold " + std::to_string(have) + ", allowed are " +
                                std::to_string(allowed));
  };
  if (std::int64_t(lights_.size()) > limits_.maxLights) {
    return over("max_lights", std::int64_t(lights_.size()), limits_.maxLights);
  }
  if (std::int64_t(surfaces_.size()) > limits_.maxSurfaces) {
    return over("max_surfaces", std::int64_t(surfaces_.size()), limits_.maxSurfaces);
  }
  if (std::int64_t(cameras_.size()) > limits_.maxCameras) {
    return over("max_cameras", std::int64_t(cameras_.size()), limits_.maxCameras);
  }
  if (triangles_ > limits_.maxTriangles) return over("max_triangles", triangles_, limits_.maxTriangles);
  return {};
}

Expected<std::string> Document::applyOne(const CreateLight& op, const Blobs& blobs, Undo& undo) {
  if (Status s = checkName(op.name); !s.ok()) return s.within("create_light");
  if (!op.fields.mesh) return invalid("create_light.mesh", "a light needs a mesh: set mesh or inline_mesh");
  auto light = std::make_shared<Light>();
  if (Status s = assign(*light, op.fields, blobs); !s.ok()) return s.within("create_light");
  light->name = freeName(op.name);
  put(light->name, light, undo);
  undo.contentAdded = true;
  return light->name;
}

Expected<std::string> Document::applyOne(const UpdateLight& op, const Blobs& blobs, Undo& undo) {
  const auto found = lights_.find(op.name);
  if (found == lights_.end()) return noSuch("light", op.name).within("update_light.light");
  auto light = std::make_shared<Light>(*found->second.object);
  if (Status s = assign(*light, op.fields, blobs); !s.ok()) return s.within("update_light.light");
  put(op.name, light, undo);
  return op.name;
}

Expected<std::string> Document::applyOne(const DeleteLight& op, const Blobs&, Undo& undo) {
  if (!lights_.contains(op.name)) return noSuch("light", op.name, "delete_light");
  remember(lights_, op.name, undo.lights);
  lights_.erase(op.name);
  tombstones_.push_back({ObjectKind::kLight, op.name, revision_});
  return op.name;
}

Expected<std::string> Document::applyOne(const CreateSurface& op, const Blobs& blobs, Undo& undo) {
  if (Status s = checkName(op.name); !s.ok()) return s.within("create_surface");
  if (!op.fields.mesh) return invalid("create_surface.mesh", "a surface needs a mesh: set mesh or inline_mesh");
  auto surface = std::make_shared<Surface>();
  if (Status s = assign(*surface, op.fields, blobs); !s.ok()) return s.within("create_surface");
  surface->name = freeName(op.name);
  put(surface->name, surface, undo);
  undo.contentAdded = true;
  return surface->name;
}

Expected<std::string> Document::applyOne(const UpdateSurface& op, const Blobs& blobs, Undo& undo) {
  const auto found = surfaces_.find(op.name);
  if (found == surfaces_.end()) return noSuch("surface", op.name).within("update_surface.surface");
  auto surface = std::make_shared<Surface>(*found->second.object);
  if (Status s = assign(*surface, op.fields, blobs); !s.ok()) return s.within("update_surface.surface");
  put(op.name, surface, undo);
  return op.name;
}

Expected<std::string> Document::applyOne(const DeleteSurface& op, const Blobs&, Undo& undo) {
  if (!surfaces_.contains(op.name)) return noSuch("surface", op.name, "delete_surface");
  remember(surfaces_, op.name, undo.surfaces);
  surfaces_.erase(op.name);
  tombstones_.push_back({ObjectKind::kSurface, op.name, revision_});
  return op.name;
}

Expected<std::string> Document::applyOne(const SetVertices& op, const Blobs&, Undo& undo) {
  const MeshPtr current = meshOf(op.object);
  if (!current) return noSuch("light or surface", op.object, "object").within("set_vertices");
  MeshPtr deformed = op.deformed;
  // The mesh was exchanged, or made by this very edit, after the preparation; or that failed, and says here why.
  if (op.base != current || !deformed) {
    SetVertices again = op;
    if (Status s = prepareVertices(again, current, hasher_); !s.ok()) return s.within("set_vertices");
    deformed = again.deformed;
  }
  if (const auto light = lights_.find(op.object); light != lights_.end()) {
    auto copy = std::make_shared<Light>(*light->second.object);
    copy->mesh = deformed;
    put(op.object, copy, undo);
  } else {
    auto copy = std::make_shared<Surface>(*surfaces_.at(op.object).object);
    copy->mesh = deformed;
    put(op.object, copy, undo);
  }
  return op.object;
}

Expected<std::string> Document::applyOne(const PutCamera& op, const Blobs&, Undo& undo) {
  if (Status s = checkName(op.name); !s.ok()) return s.within("put_camera");
  if (Status s = checkCamera(op.camera); !s.ok()) return s.within("put_camera");
  remember(cameras_, op.name, undo.cameras);
  cameras_[op.name] = {op.camera, revision_};
  return op.name;
}

Expected<std::string> Document::applyOne(const DeleteCamera& op, const Blobs&, Undo& undo) {
  if (!cameras_.contains(op.name)) return noSuch("camera", op.name, "delete_camera");
  remember(cameras_, op.name, undo.cameras);
  cameras_.erase(op.name);
  tombstones_.push_back({ObjectKind::kCamera, op.name, revision_});
  return op.name;
}

Expected<std::string> Document::applyOne(const FitGrid&, const Blobs&, Undo&) {
  if (options_.grid.hasBounds) {
    return Status(Code::kFailedPrecondition, "the grid has fixed bounds; clear settings.grid.bounds to fit it",
                  "fit_grid");
  }
  if (Status s = refit(true); !s.ok()) return s.within("fit_grid");
  return std::string();
}

void Document::put(const std::string& name, std::shared_ptr<const Light> light, Undo& undo) {
  remember(lights_, name, undo.lights);
  lights_[name] = {std::move(light), revision_};
}

void Document::put(const std::string& name, std::shared_ptr<const Surface> surface, Undo& undo) {
  remember(surfaces_, name, undo.surfaces);
  surfaces_[name] = {std::move(surface), revision_};
}

std::string Document::freeName(const std::string& wanted) const {
  std::string name = wanted;
  for (int n = 1; lights_.contains(name) || surfaces_.contains(name); ++n) {
    char suffix[16];
    std::snprintf(suffix, sizeof suffix, ".%03d", n);
    name = wanted + suffix;
  }
  return name;
}

Bounds Document::content() const {
  Bounds bounds;
  const auto add = [&bounds](const MeshPtr& mesh, const Transform& transform) {
    bounds.add(mesh->bounds.transformed(transform.worldFromObject()));
  };
  for (const auto& [name, surface] : surfaces_) add(surface.object->mesh, surface.object->transform);
  for (const auto& [name, light] : lights_) {
    if (light.object->enabled) add(light.object->mesh, light.object->transform);
  }
  return bounds;
}

/// New content that leaves a fitted grid makes a new fit; a moving light never does (MATHS.md 1).
Status Document::refit(bool always) {
  if (options_.grid.hasBounds) return {};
  const Bounds bounds = content();
  if (bounds.empty()) return {};
  const Bounds now = grid_.bounds();
  const bool inside =
      glm::all(glm::lessThanEqual(now.min, bounds.min)) && glm::all(glm::greaterThanEqual(now.max, bounds.max));
  if (!always && inside && gridRevision_ != 0) return {};
  const Expected<Grid> grid = fitGrid(options_.grid, bounds);
  if (!grid) return grid.status();
  if (!(*grid == grid_)) {
    grid_ = *grid;
    gridRevision_ = revision_;
  }
  return {};
}

void Document::recount() {
  snapshot_.reset();
  triangles_ = 0;
  for (const auto& [name, light] : lights_) triangles_ += std::int64_t(light.object->mesh->triangles.size());
  for (const auto& [name, surface] : surfaces_) triangles_ += std::int64_t(surface.object->mesh->triangles.size());
}

Status Document::setOptions(const SessionOptions& options) {
  if (options == options_) return {};
  if (Status s = checkOptions(options); !s.ok()) return s.within("settings");
  if (!(options.grid == options_.grid)) {
    const Expected<Grid> grid =
        options.grid.hasBounds ? makeGrid(options.grid, options.grid.bounds) : fitGrid(options.grid, content());
    if (!grid) return grid.status().within("settings.grid");
    grid_ = *grid;
    gridRevision_ = revision_ + 1;
  }
  options_ = options;
  optionsRevision_ = ++revision_;
  snapshot_.reset();
  return {};
}

ScenePtr Document::snapshot() {
  if (snapshot_) return snapshot_;
  auto scene = std::make_shared<Scene>();
  scene->revision = revision_;
  scene->options = options_;
  scene->grid = grid_;
  for (const auto& [name, light] : lights_) scene->lights.emplace_hint(scene->lights.end(), name, light.object);
  for (const auto& [name, surface] : surfaces_) {
    scene->surfaces.emplace_hint(scene->surfaces.end(), name, surface.object);
  }
  for (const auto& [name, camera] : cameras_) scene->cameras.emplace_hint(scene->cameras.end(), name, camera.camera);
  snapshot_ = scene;
  return snapshot_;
}

/// A name deleted and then given again is no deletion for a reader that sees only the end.
bool Document::exists(const Deleted& deleted) const {
  switch (deleted.kind) {
    case ObjectKind::kLight:
      return lights_.contains(deleted.name);
    case ObjectKind::kSurface:
      return surfaces_.contains(deleted.name);
    case ObjectKind::kCamera:
      return cameras_.contains(deleted.name);
  }
  return false;
}

Changes Document::changesSince(std::optional<std::uint64_t> from) const {
  const std::uint64_t since = from.value_or(0);
  Changes out;
  out.snapshot = !from || since < forgottenUpTo_ || since > revision_;
  out.revision = revision_;
  out.lights = newer(lights_, since, out.snapshot);
  out.surfaces = newer(surfaces_, since, out.snapshot);
  for (const auto& [name, camera] : cameras_) {
    if (out.snapshot || camera.revision > since) out.cameras.emplace_back(name, camera.camera);
  }
  if (!out.snapshot) {
    for (const Deleted& deleted : tombstones_) {
      if (deleted.revision > since && !exists(deleted)) out.deleted.push_back(deleted);
    }
  }
  if (out.snapshot || optionsRevision_ > since) out.options = options_;
  if (out.snapshot || gridRevision_ > since) out.grid = grid_;
  return out;
}

std::vector<Versioned<Light>> Document::lights() const { return newer(lights_, 0, true); }
std::vector<Versioned<Surface>> Document::surfaces() const { return newer(surfaces_, 0, true); }

std::vector<std::pair<std::string, Camera>> Document::cameras() const {
  std::vector<std::pair<std::string, Camera>> out;
  for (const auto& [name, camera] : cameras_) out.emplace_back(name, camera.camera);
  return out;
}

MeshPtr Document::meshInUse(const BlobHash& hash) const {
  for (const auto& [name, light] : lights_) {
    if (light.object->mesh->hash == hash) return light.object->mesh;
  }
  for (const auto& [name, surface] : surfaces_) {
    if (surface.object->mesh->hash == hash) return surface.object->mesh;
  }
  return nullptr;
}

std::set<BlobHash> Document::hashesInUse() const {
  std::set<BlobHash> out;
  for (const auto& [name, light] : lights_) {
    out.insert(light.object->mesh->hash);
    if (light.object->texture) out.insert(light.object->texture->hash);
  }
  for (const auto& [name, surface] : surfaces_) {
    out.insert(surface.object->mesh->hash);
    if (surface.object->albedoTexture) out.insert(surface.object->albedoTexture->hash);
  }
  return out;
}

Status prepareVertices(SetVertices& op, MeshPtr base, const MeshHasher& hasher) {
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
