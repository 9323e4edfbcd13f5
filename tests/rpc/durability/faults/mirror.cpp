#include "rpc/durability/faults/mirror.h"

#include <cmath>
#include <functional>

namespace lpv::rpc::faults {
namespace {

constexpr double kEditMark = 2.0;  // in the third place of a colour that says an edit; a new light has 1

}  // namespace

pb::Vec3 colourOf(const EditId& id) {
  pb::Vec3 out;
  out.set_x(double(id.writer));
  out.set_y(double(id.sequence));
  out.set_z(kEditMark);
  return out;
}

void SceneBuilder::put(const std::string& name, std::uint64_t revision, const std::string& bytes) {
  erase(name);
  const std::uint64_t hash = std::hash<std::string>()(name + "/" + bytes);
  state_.objects[name] = {revision, hash};
  digest_ += hash;
}

void SceneBuilder::put(const pb::Light& light) {
  put(light.name(), light.status().revision(), light.SerializeAsString());
  if (light.name() != kLamp || light.radiance().z() != kEditMark) return;
  state_.last = nameOf({int(std::lround(light.radiance().x())), std::uint64_t(std::llround(light.radiance().y()))});
}

void SceneBuilder::put(const pb::Surface& surface) {
  put(surface.name(), surface.revision(), surface.SerializeAsString());
}

void SceneBuilder::erase(const std::string& name) {
  const auto found = state_.objects.find(name);
  if (found == state_.objects.end()) return;
  digest_ -= found->second.hash;
  state_.objects.erase(found);
}

void SceneBuilder::clear() {
  state_ = {};
  digest_ = 0;
}

void SceneBuilder::stand(std::uint64_t epoch, std::uint64_t revision) {
  state_.epoch = epoch;
  state_.revision = revision;
}

template <typename Event>
void SceneMirror::takeObjects(const Event& event) {
  for (const pb::Light& light : event.lights()) scene_.put(light);
  for (const pb::Surface& surface : event.surfaces()) scene_.put(surface);
}

Read SceneMirror::read() const {
  Read out;
  out.epoch = state().epoch;
  out.revision = state().revision;
  out.follows = follows_;
  out.digest = scene_.digest();
  out.whole = scene_.whole();
  return out;
}

std::optional<Read> SceneMirror::take(const pb::WatchSceneResponse& event) {
  if (event.has_snapshot()) {
    if (!inSnapshot_) scene_.clear();
    takeObjects(event.snapshot());
    inSnapshot_ = event.snapshot().more();
    follows_.reset();
    if (inSnapshot_) return std::nullopt;
    scene_.stand(event.snapshot().epoch(), event.snapshot().revision());
    return read();
  }
  if (!event.has_change()) return std::nullopt;
  const pb::SceneChange& change = event.change();
  for (const auto* names : {&change.deleted_lights(), &change.deleted_surfaces()}) {
    for (const std::string& name : *names) scene_.erase(name);
  }
  takeObjects(change);
  if (change.more()) return std::nullopt;
  follows_ = change.first_revision() - 1;
  scene_.stand(change.epoch(), change.last_revision());
  return read();
}

void SceneMirror::breakOff() {
  if (inSnapshot_) scene_.clear();
  inSnapshot_ = false;
}

void SceneMirror::askIn(pb::WatchSceneRequest* request) const {
  request->set_since_revision(state().revision);
  request->set_since_epoch(state().epoch);
}

}  // namespace lpv::rpc::faults
