#include "session/document/scene_copy.h"

#include <memory>
#include <string>

#include "scene/distant_lights.h"

namespace lpv {
namespace {

/// Null: the object is gone.
template <typename Map, typename Changed>
void put(const Map& changed, Changed& objects) {
  for (const auto& [name, object] : changed) {
    if (object) {
      objects.insert_or_assign(name, object);
    } else {
      objects.erase(name);
    }
  }
}

}  // namespace

void SceneCopy::apply(const SceneUpdate& update) {
  if (scene_ && scene_->revision == update.revision && !update.whole) return;
  auto next = scene_ && !update.whole ? std::make_shared<Scene>(*scene_) : std::make_shared<Scene>();
  next->revision = update.revision;
  next->options = update.options;
  next->grid = update.grid;
  for (const auto& [name, light] : update.lights) eraseParts(next->lights, name);
  put(update.lights, next->lights);
  placeDistantLights(next->lights, next->grid);
  put(update.surfaces, next->surfaces);
  for (const auto& [name, camera] : update.cameras) {
    if (camera) {
      next->cameras.insert_or_assign(name, *camera);
    } else {
      next->cameras.erase(name);
    }
  }
  scene_ = std::move(next);
}

}  // namespace lpv
