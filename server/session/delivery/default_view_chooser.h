#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "base/mutex.h"
#include "base/worker_pool.h"
#include "scene/default_view.h"
#include "scene/scene.h"

namespace lpv {

/// The view that all readers share who gave no camera, chosen on a worker from the scene that is meant for it
/// (scene/default_view.h, Document::viewScene): at most one choice runs at a time. Thread-safe; acquires no other lock.
class DefaultViewChooser {
 public:
  explicit DefaultViewChooser(WorkerPool& pool) : pool_(pool) {}

  /// Whether camera() may be used: a view of `scene` has been chosen, or, while that is being chosen, a view of an
  /// older scene that is not from before `minRevision` and not empty, so that streams go on while objects keep coming.
  /// Starts the choice where it is missing; then calls `chosen` once, on a worker, without locks.
  bool ready(const ScenePtr& scene, std::uint64_t minRevision, std::function<void()> chosen);
  /// The view chosen last, for a picture `aspect` times as wide as high.
  Camera camera(double aspect) const;
  /// The same where it was chosen from `scene`, else null.
  std::optional<Camera> cameraOf(const ScenePtr& scene, double aspect) const;

 private:
  /// Outlives the chooser while a worker chooses.
  struct State {
    Mutex mutex;
    DefaultView view LPV_GUARDED_BY(mutex);
    ScenePtr scene LPV_GUARDED_BY(mutex);  ///< from which it was chosen; null until the first choice
    bool choosing LPV_GUARDED_BY(mutex) = false;
  };

  WorkerPool& pool_;
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

}  // namespace lpv
