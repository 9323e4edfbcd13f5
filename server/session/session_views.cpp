// Which camera a frame is seen through. Those who give none share a view that is chosen from the scene on a worker,
// outside the lock; ticks that need it wait for it (scene/default_view.h, Document::viewScene).

#include <algorithm>

#include "session/session.h"

namespace lpv {
namespace {

double aspectOf(const glm::ivec2& size) { return double(size.x) / size.y; }

}  // namespace

/// Given, or found by its name.
std::optional<Camera> Session::chosenCamera(const CameraChoice& choice) const {
  if (choice.camera || choice.name.empty()) return choice.camera;
  return document_.camera(choice.name);
}

Status Session::checkCamera(const CameraChoice& choice) const {
  const MutexLock lock(mutex_);
  if (choice.name.empty() || chosenCamera(choice)) return {};
  return {Code::kNotFound, "there is no camera \"" + choice.name + "\" in this session", "camera_name"};
}

Expected<Camera> Session::cameraFor(const CameraChoice& choice, const glm::ivec2& size) const {
  if (Status s = checkCamera(choice); !s.ok()) return s;
  ScenePtr scene;
  {
    const MutexLock lock(mutex_);
    if (const auto camera = chosenCamera(choice)) return *camera;
    scene = document_.viewScene();
    if (viewScene_ == scene) return view_.camera(aspectOf(size));
  }
  return DefaultView(*scene).camera(aspectOf(size));
}

/// Whether frameRequest() knows where to look from. While a newer view is being chosen, an older one will do unless it
/// is from before `minRevision` or shows nothing at all: streams go on while objects keep coming.
bool Session::hasView(const FrameSettings& subscription, std::uint64_t minRevision) {
  if (chosenCamera(subscription.camera)) return true;
  if (viewScene_ == document_.viewScene()) return true;
  chooseView();
  constexpr std::uint64_t kFirstContent = 1;
  return viewScene_ && viewScene_->revision >= std::max(minRevision, kFirstContent);
}

void Session::chooseView() {
  if (choosingView_) return;
  choosingView_ = true;
  services_.pool->post([weak = weak_from_this(), scene = document_.viewScene()] {
    const DefaultView view(*scene);
    if (const SessionPtr self = weak.lock()) self->viewChosen(scene, view);
  });
}

void Session::viewChosen(const ScenePtr& scene, const DefaultView& view) {
  const MutexLock lock(mutex_);
  choosingView_ = false;
  view_ = view;
  viewScene_ = scene;
  for (const auto& [id, subscriber] : subscribers_) {
    if (subscriber->subscription.frame && !chosenCamera(subscriber->subscription.frame->camera))
      subscriber->settingsChanged = true;
  }
  scheduleTick();
}

/// A camera that was deleted since it was chosen by name shows the default view rather than ending the stream.
FrameRequest Session::frameRequest(const Subscriber& subscriber) const {
  FrameSettings subscription = *subscriber.subscription.frame;
  if (subscriber.adapter)
    subscription.size = subscriber.adapter->shapeFor({subscription.size, subscription.quality}).size;
  return frameRequest(subscription, subscriber.key);
}

FrameRequest Session::frameRequest(const FrameSettings& subscription, std::uint64_t view) const {
  FrameRequest request;
  request.view = view;
  request.camera = chosenCamera(subscription.camera).value_or(view_.camera(aspectOf(subscription.size)));
  request.size = subscription.size;
  request.exposure = subscription.exposure;
  request.format = subscription.format;
  return request;
}

}  // namespace lpv
