// A document as values: what an edit changed, and all of it.

#include "session/document/document.h"

namespace lpv {
namespace {

/// What of `before`'s names is there now.
template <typename T, typename Before>
std::vector<Versioned<T>> touched(const std::map<std::string, Versioned<T>>& objects, const Before& before) {
  std::vector<Versioned<T>> out;
  for (const auto& [name, was] : before) {
    if (const auto found = objects.find(name); found != objects.end()) out.push_back(found->second);
  }
  return out;
}

}  // namespace

Document::Document(const DocumentState& state, const Limits& limits, MeshHasher hasher)
    : limits_(limits),
      hasher_(std::move(hasher)),
      options_(state.options),
      grid_(state.grid),
      revision_(state.revision),
      optionsRevision_(state.optionsRevision),
      gridRevision_(state.gridRevision),
      tombstones_(state.tombstones.begin(), state.tombstones.end()),
      tombstoneHorizon_(state.tombstoneHorizon) {
  for (const Versioned<Light>& light : state.lights) lights_[light.object->name] = light;
  for (const Versioned<Surface>& surface : state.surfaces) surfaces_[surface.object->name] = surface;
  for (const DocumentState::Camera& camera : state.cameras) cameras_[camera.name] = {camera.camera, camera.revision};
  for (const auto& [name, light] : lights_) count(*light.object, 1);
  for (const auto& [name, surface] : surfaces_) count(*surface.object, 1);
  chooseTransportAnew();
  setStage();
}

DocumentState Document::state() const {
  DocumentState out;
  out.revision = revision_;
  out.options = options_;
  out.optionsRevision = optionsRevision_;
  out.grid = grid_;
  out.gridRevision = gridRevision_;
  out.lights = lights();
  out.surfaces = surfaces();
  for (const auto& [name, entry] : cameras_) out.cameras.push_back({name, entry.camera, entry.revision});
  out.tombstones.assign(tombstones_.begin(), tombstones_.end());
  out.tombstoneHorizon = tombstoneHorizon_;
  return out;
}

namespace {

/// The object of an entry, where there is one.
template <typename Map>
auto objectIn(const Map& objects, const std::string& name) {
  const auto found = objects.find(name);
  return found == objects.end() ? nullptr : found->second.object;
}

/// The same of what was before an edit.
template <typename Before>
auto objectOf(const Before& before) {
  return before ? before->object : nullptr;
}

}  // namespace

ObjectState Document::object(const ObjectKey& key) const {
  if (key.camera) return {nullptr, nullptr, camera(key.name)};
  return {objectIn(lights_, key.name), objectIn(surfaces_, key.name), std::nullopt};
}

ObjectState Document::objectBefore(const ObjectKey& key) const {
  ObjectState out = object(key);
  if (key.camera) {
    const auto was = replaced_.cameras.find(key.name);
    if (was == replaced_.cameras.end()) return out;
    out.camera = was->second ? std::optional(was->second->camera) : std::nullopt;
    return out;
  }
  const auto light = replaced_.lights.find(key.name);
  if (light != replaced_.lights.end()) out.light = objectOf(light->second);
  const auto surface = replaced_.surfaces.find(key.name);
  if (surface != replaced_.surfaces.end()) out.surface = objectOf(surface->second);
  return out;
}

SceneUpdate Document::takeUpdate() {
  SceneUpdate out = std::exchange(pending_, SceneUpdate());
  pending_.whole = false;
  out.revision = revision_;
  out.options = inForce();
  out.grid = grid_;
  if (!out.whole) return out;
  for (const auto& [name, light] : lights_) out.lights.emplace_hint(out.lights.end(), name, light.object);
  for (const auto& [name, surface] : surfaces_) out.surfaces.emplace_hint(out.surfaces.end(), name, surface.object);
  for (const auto& [name, entry] : cameras_) out.cameras.emplace_hint(out.cameras.end(), name, entry.camera);
  return out;
}

/// The objects are looked up here, where the edit has just looked at them: taking the update takes the same time for a
/// large scene as for a small one.
void Document::notePending(const Rollback& rollback) {
  if (pending_.whole) return;
  for (const auto& [name, was] : rollback.lights) pending_.lights[name] = objectIn(lights_, name);
  for (const auto& [name, was] : rollback.surfaces) pending_.surfaces[name] = objectIn(surfaces_, name);
  for (const auto& [name, was] : rollback.cameras) pending_.cameras[name] = camera(name);
  // More names than there are objects: the whole is as cheap, and names that are gone are let go of.
  constexpr std::size_t kFew = 64;
  const std::size_t names = pending_.lights.size() + pending_.surfaces.size() + pending_.cameras.size();
  if (names > kFew + lights_.size() + surfaces_.size() + cameras_.size()) pending_ = SceneUpdate();
}

/// In time of the edit's size, not the scene's.
void Document::noteChange(const Rollback& rollback) {
  lastChange_ = Changes();
  lastChange_.revision = revision_;
  lastChange_.lights = touched(lights_, rollback.lights);
  lastChange_.surfaces = touched(surfaces_, rollback.surfaces);
  for (const auto& [name, was] : rollback.cameras) {
    if (const auto found = cameras_.find(name); found != cameras_.end()) {
      lastChange_.cameras.emplace_back(name, found->second.camera);
    }
  }
  lastChange_.deleted.assign(tombstones_.begin() + std::ptrdiff_t(rollback.tombstones), tombstones_.end());
  if (gridRevision_ == revision_) lastChange_.grid = grid_;
}

}  // namespace lpv
