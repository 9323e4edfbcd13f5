#include "fuzz/edit_world.h"

#include "convert/geometry.h"
#include "convert/scene.h"
#include "fuzz/check.h"
#include "persistence/snapshot.h"
#include "store/envelope.h"
#include "store/fold.h"

namespace lpv::fuzz {

namespace pb = lpv::v1;

Position FoldedJournal::create(const SavedSession& state) {
  snapshot_ = api::toSnapshot(state);
  for (const store::Content& content : api::contentsOf(state)) take(content);
  return 0;
}

Position FoldedJournal::append(const std::string&, JournalStep step) {
  const store::LogRecord made = api::toStep(step, [this](const std::string& hash) { return contents_.contains(hash); });
  for (const store::Content& content : made.contents) take(content);
  kept::Record read;
  const Status unsealed = store::unseal("the log", *store::seal("the log", made.record), &read);
  check(unsealed.ok(), "a record can be read: " + unsealed.message());
  const Status folded = store::fold(read, &snapshot_);
  check(folded.ok(), "a record follows the one before: " + folded.message());
  return 0;
}

Expected<SavedSession> FoldedJournal::load(const std::string& session) {
  store::Loaded loaded;
  loaded.head.id = session;
  loaded.snapshot = snapshot_;
  for (const auto& [hash, kind] : store::contentsOf(snapshot_)) {
    check(contents_.contains(hash), "content that the snapshot needs is kept: " + hash);
    loaded.contents.push_back(contents_[hash]);
  }
  return api::fromStore(loaded);
}

void FoldedJournal::compact() {
  const std::map<std::string, pb::BlobKind> needed = store::contentsOf(snapshot_);
  std::erase_if(contents_, [&](const auto& entry) { return !needed.contains(entry.first); });
}

kept::Snapshot FoldedJournal::snapshot() const {
  kept::Snapshot out = snapshot_;
  out.clear_clients();
  return out;
}

void Mirror::follow(const Session& session) {
  const Changes changes = session.changesSince(revision_, nullptr);
  if (changes.snapshot) {
    lights_.clear();
    surfaces_.clear();
    cameras_.clear();
  }
  for (const Deleted& deleted : changes.deleted) {
    if (deleted.kind == ObjectKind::kLight) lights_.erase(deleted.name);
    if (deleted.kind == ObjectKind::kSurface) surfaces_.erase(deleted.name);
    if (deleted.kind == ObjectKind::kCamera) cameras_.erase(deleted.name);
  }
  for (const auto& light : changes.lights) lights_[light.object->name] = light.object;
  for (const auto& surface : changes.surfaces) surfaces_[surface.object->name] = surface.object;
  for (const auto& [name, camera] : changes.cameras) cameras_.insert(name);
  check(!revision_ || changes.revision >= *revision_, "what is told goes forward");
  revision_ = changes.revision;
}

void Mirror::compare(const Session& session) const {
  std::map<std::string, LightPtr> lights;
  for (const auto& light : session.lights()) lights[light.object->name] = light.object;
  std::map<std::string, SurfacePtr> surfaces;
  for (const auto& surface : session.surfaces()) surfaces[surface.object->name] = surface.object;
  std::set<std::string> cameras;
  for (const auto& [name, camera] : session.cameras()) cameras.insert(name);
  check(lights == lights_ && surfaces == surfaces_ && cameras == cameras_, "who follows the changes has the scene");
}

std::string scene(const Session& session) {
  std::string out;
  for (const auto& light : session.lights()) {
    pb::Light message;
    api::toProto(light, &message);
    message.clear_status();
    out += deterministic(message) + "\n";
  }
  for (const auto& surface : session.surfaces()) {
    pb::Surface message;
    api::toProto(surface, &message);
    message.clear_revision();
    out += deterministic(message) + "\n";
  }
  for (const auto& [name, camera] : session.cameras()) {
    pb::Camera message;
    api::toProto(name, camera, &message);
    out += deterministic(message) + "\n";
  }
  return out;
}

}  // namespace lpv::fuzz
