// Which camera a frame is seen through. Those who give none share a view that is chosen from the scene on a worker,
// outside the lock; ticks that need it wait for it (scene/default_view.h, Document::staged).

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
  const std::lock_guard lock(mutex_);
  if (choice.name.empty() || chosenCamera(choice)) return {};
  return {Code::kNotFound, "there is no camera \"" + choice.name + "\" in this session", "camera_name"};
}

Expected<Camera> Session::cameraFor(const CameraChoice& choice, const glm::ivec2& size) const {
  if (Status s = checkCamera(choice); !s.ok()) return s;
  ScenePtr staged;
  {
    const std::lock_guard lock(mutex_);
    if (const auto camera = chosenCamera(choice)) return *camera;
    staged = document_.staged();
    if (viewScene_ == staged) return view_.camera(aspectOf(size));
  }
  return DefaultView(*staged).camera(aspectOf(size));
}

/// Whether frameRequest() knows where to look from. While a newer view is being chosen, an older one will do unless it
/// is from before `minRevision` or shows nothing at all: streams go on while objects keep coming.
bool Session::hasView(const FrameWish& wish, std::uint64_t minRevision) {
  if (chosenCamera(wish.camera)) return true;
  if (viewScene_ == document_.staged()) return true;
  chooseView();
  constexpr std::uint64_t kFirstContent = 1;
  return viewScene_ && viewScene_->revision >= std::max(minRevision, kFirstContent);
}

void Session::chooseView() {
  if (choosingView_) return;
  choosingView_ = true;
  workshop_.pool->post([weak = weak_from_this(), scene = document_.staged()] {
    const DefaultView view(*scene);
    if (const SessionPtr self = weak.lock()) self->viewChosen(scene, view);
  });
}

void Session::viewChosen(const ScenePtr& scene, const DefaultView& view) {
  const std::lock_guard lock(mutex_);
  choosingView_ = false;
  view_ = view;
  viewScene_ = scene;
  for (const auto& [id, subscriber] : subscribers_) {
    if (subscriber->wish.frame && !chosenCamera(subscriber->wish.frame->camera)) subscriber->wishChanged = true;
  }
  kick();
}

/// A camera that was deleted since it was chosen by name shows the default view rather than ending the stream.
FrameRequest Session::frameRequest(const Subscriber& subscriber) const {
  FrameWish wish = *subscriber.wish.frame;
  if (subscriber.adapter) wish.size = subscriber.adapter->shapeFor({wish.size, wish.quality}).size;
  return frameRequest(wish, subscriber.key);
}

FrameRequest Session::frameRequest(const FrameWish& wish, std::uint64_t view) const {
  FrameRequest request;
  request.view = view;
  request.camera = chosenCamera(wish.camera).value_or(view_.camera(aspectOf(wish.size)));
  request.size = wish.size;
  request.exposure = wish.exposure;
  request.format = wish.format;
  return request;
}

}  // namespace lpv
