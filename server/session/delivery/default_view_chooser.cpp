#include "session/delivery/default_view_chooser.h"

#include <algorithm>
#include <utility>

namespace lpv {

bool DefaultViewChooser::ready(const ScenePtr& scene, std::uint64_t minRevision, std::function<void()> chosen) {
  const MutexLock lock(state_->mutex);
  if (state_->scene == scene) return true;
  if (!std::exchange(state_->choosing, true)) {
    pool_.post([state = state_, scene, chosen = std::move(chosen)] {
      const DefaultView view(*scene);
      {
        const MutexLock done(state->mutex);
        state->choosing = false;
        state->view = view;
        state->scene = scene;
      }
      chosen();
    });
  }
  constexpr std::uint64_t kFirstContent = 1;
  return state_->scene && state_->scene->revision >= std::max(minRevision, kFirstContent);
}

Camera DefaultViewChooser::camera(double aspect) const {
  const MutexLock lock(state_->mutex);
  return state_->view.camera(aspect);
}

std::optional<Camera> DefaultViewChooser::cameraOf(const ScenePtr& scene, double aspect) const {
  const MutexLock lock(state_->mutex);
  return state_->scene == scene ? std::optional(state_->view.camera(aspect)) : std::nullopt;
}

}  // namespace lpv
