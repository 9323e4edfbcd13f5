#pragma once

#include "scene/scene.h"
#include "session/document/document.h"

namespace lpv {

/// The scene as ticks read it: a copy of a document's that is brought up to date outside the lock of the document, in
/// time of the scene's size, by updates that are taken under it. Not thread-safe.
class SceneCopy {
 public:
  /// Updates come in the order in which the document gave them, none left out. Keeps the scene of a revision that is
  /// there already.
  void apply(const SceneUpdate& update);
  /// Immutable: stays as it is when the next update comes. Null before the first.
  const ScenePtr& scene() const { return scene_; }

 private:
  ScenePtr scene_;
};

}  // namespace lpv
