#include "session/document/document.h"

#include <algorithm>

#include "scene/distant_lights.h"
#include "scene/error_goal.h"
#include "scene/grid_choice.h"
#include "scene/transport_choice.h"

namespace lpv {
namespace {

template <typename Map, typename Before>
void putBack(Map& objects, Before& before) {
  for (auto& [name, entry] : before) {
    if (entry) {
      objects[name] = *entry;
    } else {
      objects.erase(name);
    }
  }
}

/// Calls `use` with each object that an edit replaced and -1, and with what is there instead and 1.
template <typename Map, typename Before, typename Use>
void forEachReplaced(const Map& objects, const Before& before, const Use& use) {
  for (const auto& [name, was] : before) {
    if (was) use(*was->object, -1);
    if (const auto now = objects.find(name); now != objects.end()) use(*now->second.object, 1);
  }
}

/// Whether there was no object of a kind before an edit.
template <typename Map, typename Before>
bool wasEmpty(const Map& objects, const Before& before) {
  const auto wasThere = [](const auto& was) { return was.second.has_value(); };
  const auto untouched = [&before](const auto& object) { return !before.contains(object.first); };
  return std::ranges::none_of(before, wasThere) && std::ranges::none_of(objects, untouched);
}

/// Whether an edit brought the first of a kind of objects.
template <typename Map, typename Before>
bool isFirst(const Map& objects, const Before& before) {
  return !objects.empty() && wasEmpty(objects, before);
}

int longestEdgeOf(const Grid& grid) { return std::max({grid.dims.x, grid.dims.y, grid.dims.z}); }

/// Whether settings that leave the number of cells to the server give it other reasons.
bool choosesOtherwise(const LightingSettings& a, const LightingSettings& b) {
  if (!choosesCells(a.grid)) return false;
  const double ratios[] = {resolved(a).openingRatio(), resolved(b).openingRatio()};
  return a.maxError != b.maxError || a.transport != b.transport || a.lookup != b.lookup || ratios[0] != ratios[1];
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

Document::Document(const LightingSettings& options, const Limits& limits, MeshHasher hasher)
    : limits_(limits), hasher_(std::move(hasher)), options_(options) {
  grid_ = *gridFor(options, Bounds());  // the caller has checked the options
  viewScene_ = snapshot();
}

MeshPtr Document::meshOf(const std::string& object) const {
  if (const auto light = lights_.find(object); light != lights_.end()) return light->second.object->mesh;
  if (const auto surface = surfaces_.find(object); surface != surfaces_.end()) return surface->second.object->mesh;
  return nullptr;
}

Expected<std::vector<std::string>> Document::apply(const Edit& edit, const Blobs& blobs) {
  if (edit.expectedRevision && *edit.expectedRevision != revision_) {
    return Status(Code::kAborted, Reason::kRevisionChanged,
                  "expected_revision is " + std::to_string(*edit.expectedRevision) + ", the session is at revision " +
                      std::to_string(revision_) + "; read the scene again and repeat",
                  "expected_revision");
  }
  std::vector<std::string> names;
  Status status = change([&](Rollback& rollback) { return applyAll(edit, blobs, rollback, &names); });
  if (!status.ok()) return status;
  return names;
}

Status Document::restore(const std::vector<NamedState>& objects, const std::optional<RestoredGrid>& grid) {
  return change([&](Rollback& rollback) {
    rollback.restores = true;
    rollback.restoredGrid = grid;
    for (const NamedState& each : objects) restoreOne(each, rollback);
    return Status();
  });
}

/// One revision, or nothing where `make` or the limits say no.
Status Document::change(const std::function<Status(Rollback&)>& make) {
  Rollback rollback;
  rollback.tombstones = tombstones_.size();
  rollback.grid = grid_;
  rollback.gridRevision = gridRevision_;
  ++revision_;
  Status status = make(rollback);
  if (status.ok()) status = checkAll(rollback);
  if (!status.ok()) {
    rollBack(rollback);
    return status;
  }
  noteChange(rollback);
  notePending(rollback);
  updateViewScene(rollback);
  while (tombstones_.size() > kMaxTombstones) {
    tombstoneHorizon_ = tombstones_.front().revision;
    tombstones_.pop_front();
  }
  replaced_ = std::move(rollback);
  return {};
}

Status Document::applyAll(const Edit& edit, const Blobs& blobs, Rollback& rollback, std::vector<std::string>* names) {
  for (std::size_t i = 0; i < edit.operations.size(); ++i) {
    Expected<std::string> name =
        std::visit([&](const auto& op) { return applyOne(op, blobs, rollback); }, edit.operations[i]);
    if (!name) return name.status().within("operations[" + std::to_string(i) + "]");
    names->push_back(std::move(*name));
  }
  return {};
}

Status Document::checkAll(Rollback& rollback) {
  count(rollback);
  if (Status s = checkTotals(); !s.ok()) return s;
  if (Status s = checkGroups(rollback); !s.ok()) return s;
  if (Status s = fitAfter(rollback); !s.ok()) return s;
  if (!sameWorkload(rollback)) {
    if (Status s = checkCost(options_, grid_); !s.ok()) return s;
  }
  correct(rollback);
  if (rollback.contentAdded || rollback.contentRemoved || gridRevision_ == revision_) chooseTransportAnew();
  return {};
}

/// Like the number of cells it stands while things move.
void Document::chooseTransportAnew() {
  if (options_.transport != Transport::kAuto) return;
  chosen_ = chooseTransport(*snapshot()).transport;
  snapshot_.reset();
}

LightingSettings Document::inForce() const {
  LightingSettings out = resolved(options_);
  if (options_.transport == Transport::kAuto) out.transport = chosen_;
  return out;
}

bool Document::missesWhatIsWanted() const {
  return measured_ && measured_->revision >= std::max(gridRevision_, contentRevision_) &&
         measured_->low > wantedError(options_);
}

/// Refuses nothing: where more cells cannot be had, those in use stay.
void Document::correct(const Rollback& rollback) {
  if (rollback.contentAdded || rollback.contentRemoved || rollback.fitted) {
    contentRevision_ = revision_;
    return;
  }
  if (!choosesCells(options_.grid) || correctedRevision_ > contentRevision_ || !missesWhatIsWanted()) return;
  const int cells = longestEdgeOf(grid_), wanted = cellsForMeasured(options_, cells, measured_->error);
  if (wanted <= cells) return;
  const Expected<GridChoice> choice = chooseGrid(*snapshot(), options_, wanted);
  if (!choice || longestEdgeOf(choice->grid) <= cells || !checkCost(options_, choice->grid).ok()) return;
  correction_ = {cells, measured_->error, longestEdgeOf(choice->grid)};
  correctedRevision_ = revision_;
  grid_ = choice->grid;
  gridRevision_ = revision_;
  snapshot_.reset();
}

void Document::rollBack(Rollback& rollback) {
  uncount(rollback);
  snapshot_.reset();
  putBack(lights_, rollback.lights);
  putBack(surfaces_, rollback.surfaces);
  putBack(cameras_, rollback.cameras);
  tombstones_.resize(rollback.tombstones, Deleted{});
  grid_ = rollback.grid;
  gridRevision_ = rollback.gridRevision;
  --revision_;
}

Status Document::checkTotals() const {
  const auto over = [](Reason reason, const char* limit, std::int64_t have, std::int64_t allowed) {
    return exhausted(reason, limit,
                     std::string(limit) + ": the session would hold " + std::to_string(have) + ", allowed are " +
                         std::to_string(allowed));
  };
  if (std::int64_t(lights_.size()) > limits_.maxLights) {
    return over(Reason::kMaxLights, "max_lights", std::int64_t(lights_.size()), limits_.maxLights);
  }
  if (std::int64_t(surfaces_.size()) > limits_.maxSurfaces) {
    return over(Reason::kMaxSurfaces, "max_surfaces", std::int64_t(surfaces_.size()), limits_.maxSurfaces);
  }
  if (std::int64_t(cameras_.size()) > limits_.maxCameras) {
    return over(Reason::kMaxCameras, "max_cameras", std::int64_t(cameras_.size()), limits_.maxCameras);
  }
  if (tally_.triangles > limits_.maxTriangles)
    return over(Reason::kMaxTriangles, "max_triangles", tally_.triangles, limits_.maxTriangles);
  return {};
}

/// Names one of the groups that the edit brings where there are too many.
Status Document::checkGroups(const Rollback& rollback) const {
  const std::size_t groups = tally_.lightsInGroup.size();
  if (groups <= std::size_t(kMaxGroups)) return {};
  std::set<std::string> there;  // those of lights that the edit did not touch
  for (const auto& [name, light] : lights_) {
    if (!rollback.lights.contains(name)) there.insert(light.object->group);
  }
  std::string brought;
  for (const auto& [group, lights] : tally_.lightsInGroup) {
    if (!there.contains(group)) brought = group;
  }
  return exhausted(Reason::kMaxGroups, "max_groups",
                   "max_groups: with light group \"" + brought + "\" the session's lights would be in " +
                       std::to_string(groups) + " groups, allowed are " + std::to_string(kMaxGroups) +
                       "; give a group that another light has, or none");
}

Bounds Document::content() const {
  Bounds bounds;
  const auto add = [&bounds](const MeshPtr& mesh, const Transform& transform) {
    bounds.add(mesh->bounds.transformed(transform.worldFromObject()));
  };
  for (const auto& [name, surface] : surfaces_) add(surface.object->mesh, surface.object->transform);
  for (const auto& [name, light] : lights_) {
    if (light.object->enabled && !light.object->distant) add(light.object->mesh, light.object->transform);
  }
  return bounds;
}

bool Document::firstOfItsKind(const Rollback& rollback) const {
  return isFirst(lights_, rollback.lights) || isFirst(surfaces_, rollback.surfaces);
}

bool Document::firstOfAll(const Rollback& rollback) const {
  return wasEmpty(lights_, rollback.lights) && wasEmpty(surfaces_, rollback.surfaces);
}

/// The grid after an edit, an undo or a redo: the one that comes back, else a fit where new content asks for one.
Status Document::fitAfter(const Rollback& rollback) {
  if (!rollback.restoredGrid) return rollback.contentAdded ? refit(false, rollback) : Status();
  grid_ = rollback.restoredGrid->grid;
  gridRevision_ = revision_;
  snapshot_.reset();
  return rollback.restoredGrid->holds ? Status() : refit(true, rollback);
}

/// New content that leaves a fitted grid makes a new fit. So does what comes into an empty scene, unless an undo brings
/// it, and the first light and the first surface where the number of cells goes by them; a moving light never does
/// (MATHS.md 1).
Status Document::refit(bool always, const Rollback& rollback) {
  const bool chooses = choosesCells(options_.grid);
  if (options_.grid.hasBounds && !chooses) return {};
  const Bounds bounds = content();
  if (bounds.empty()) return {};
  const Bounds now = grid_.bounds();
  const bool inside =
      glm::all(glm::lessThanEqual(now.min, bounds.min)) && glm::all(glm::greaterThanEqual(now.max, bounds.max));
  const bool fitted = gridRevision_ != 0 && (rollback.restores || !firstOfAll(rollback));
  const bool stands = options_.grid.hasBounds || (inside && fitted);
  if (!always && stands && !(chooses && firstOfItsKind(rollback))) return {};
  const Expected<GridChoice> choice = chooseGrid(*snapshot(), options_, leastCells());
  if (!choice) return choice.status();
  if (!(choice->grid == grid_)) {
    grid_ = choice->grid;
    gridRevision_ = revision_;
    snapshot_.reset();
  }
  return {};
}

void Document::updateViewScene(const Rollback& rollback) {
  if (rollback.contentAdded || rollback.contentRemoved || rollback.fitted || leftViewBounds(rollback)) setStage();
}

void Document::setStage() {
  viewScene_ = snapshot();
  viewBounds_ = content();
  if (viewBounds_.empty()) return;
  const glm::dvec3 extent = viewBounds_.extent();
  const glm::dvec3 surroundings(0.5 * std::max({extent.x, extent.y, extent.z}));
  viewBounds_ = {viewBounds_.min - surroundings, viewBounds_.max + surroundings};
}

/// Whether something that the edit touched is now outside of the stage.
bool Document::leftViewBounds(const Rollback& rollback) const {
  const auto outside = [this](const auto& object) {
    const Bounds now = object.mesh->bounds.transformed(object.transform.worldFromObject());
    return glm::any(glm::lessThan(now.min, viewBounds_.min)) || glm::any(glm::greaterThan(now.max, viewBounds_.max));
  };
  for (const auto& [name, before] : rollback.lights) {
    const auto light = lights_.find(name);
    if (light == lights_.end() || !light->second.object->enabled || light->second.object->distant) continue;
    if (outside(*light->second.object)) return true;
  }
  for (const auto& [name, before] : rollback.surfaces) {
    const auto surface = surfaces_.find(name);
    if (surface != surfaces_.end() && outside(*surface->second.object)) return true;
  }
  return false;
}

void Document::count(const Light& light, int sign) {
  tally_.triangles += sign * std::int64_t(light.mesh->triangles.size());
  if ((tally_.lightsInGroup[light.group] += sign) == 0) tally_.lightsInGroup.erase(light.group);
}

void Document::count(const Surface& surface, int sign) {
  tally_.triangles += sign * std::int64_t(surface.mesh->triangles.size());
}

/// Counts what an edit made instead of what it replaced, in time of the edit's size.
void Document::count(Rollback& rollback) {
  rollback.counted = true;
  snapshot_.reset();
  forEachReplaced(lights_, rollback.lights, [this](const Light& light, int sign) { count(light, sign); });
  forEachReplaced(surfaces_, rollback.surfaces, [this](const Surface& surface, int sign) { count(surface, sign); });
}

void Document::uncount(const Rollback& rollback) {
  if (!rollback.counted) return;
  forEachReplaced(lights_, rollback.lights, [this](const Light& light, int sign) { count(light, -sign); });
  forEachReplaced(surfaces_, rollback.surfaces, [this](const Surface& surface, int sign) { count(surface, -sign); });
}

Status Document::setOptions(const LightingSettings& options) {
  if (options == options_) return {};
  if (Status s = checkOptions(options); !s.ok()) return s.within("settings");
  Grid grid = grid_;
  std::uint64_t gridRevision = gridRevision_;
  const bool other = !(options.grid == options_.grid);
  const bool otherwise = other || choosesOtherwise(options, options_);
  if (otherwise) {
    const Expected<GridChoice> fitted = chooseGrid(*snapshot(), options);
    if (!fitted) return fitted.status().within("settings.grid");
    if (other || longestEdgeOf(fitted->grid) != longestEdgeOf(grid)) {
      grid = fitted->grid;
      gridRevision = revision_ + 1;
    }
  }
  if (Status s = checkCost(options, grid); !s.ok()) return s;
  grid_ = grid;
  gridRevision_ = gridRevision;
  options_ = options;
  if (otherwise) correction_.reset();
  optionsRevision_ = ++revision_;
  snapshot_.reset();
  chooseTransportAnew();
  lastChange_ = Changes();
  lastChange_.revision = revision_;
  lastChange_.options = options_;
  if (gridRevision_ == revision_) lastChange_.grid = grid_;
  return {};
}

ScenePtr Document::snapshot() {
  if (snapshot_) return snapshot_;
  auto scene = std::make_shared<Scene>();
  scene->revision = revision_;
  scene->options = inForce();
  scene->grid = grid_;
  for (const auto& [name, light] : lights_) scene->lights.emplace_hint(scene->lights.end(), name, light.object);
  placeDistantLights(scene->lights, scene->grid);
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
  out.snapshot = !from || since < tombstoneHorizon_ || since > revision_;
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

std::optional<Camera> Document::camera(const std::string& name) const {
  const auto found = cameras_.find(name);
  return found == cameras_.end() ? std::nullopt : std::optional(found->second.camera);
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
    for (const TexturePtr& texture : texturesOf(*surface.object))
      if (texture) out.insert(texture->hash);
  }
  return out;
}

}  // namespace lpv
