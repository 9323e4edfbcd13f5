#include "unit/session/small_engine.h"

#include <set>
#include <string>

namespace lpv::test {
namespace {

std::shared_ptr<Volume> ramp(const Scene& scene, VolumeStage stage, const Grid& grid) {
  auto volume = std::make_shared<Volume>();
  volume->grid = grid;
  volume->stage = stage;
  volume->probed = true;
  std::set<std::string> groups = {""};
  for (const auto& [name, light] : scene.lights) groups.insert(light->group);
  for (const std::string& group : groups) {
    VolumeLayer& layer = volume->layers.emplace_back(VolumeLayer{group, {}});
    layer.coefficients.assign(grid.cells() * 12, 0.0F);
    for (std::size_t i = 0; i < layer.coefficients.size(); i += 4) {
      layer.coefficients[i] = float(scene.revision + i % 100);
    }
  }
  return volume;
}

/// A reader of guard cells is not served by a volume without them.
VolumePtr volumeOf(const TickRequest& request, VolumeStage stage) {
  const Scene& scene = *request.scene;
  const std::shared_ptr<Volume> volume = ramp(scene, stage, scene.grid);
  if (request.guarded) volume->guarded = ramp(scene, stage, guardedGrid(scene.grid));
  return volume;
}

FramePtr grey(const FrameRequest& request) {
  auto frame = std::make_shared<Frame>();
  frame->size = request.size;
  frame->format = request.format;
  const std::size_t values = std::size_t(request.size.x) * std::size_t(request.size.y) * 3;
  if (request.format == PixelFormat::kRgb8) {
    frame->rgb8.assign(values, 128);
  } else {
    frame->rgb32f.assign(values, 0.5F);
  }
  return frame;
}

}  // namespace

Expected<TickResult> smallResult(const TickRequest& request) {
  const Scene& scene = *request.scene;
  if (scene.grid.cells() > kSmallCells) return exhausted("grid", "this engine makes small volumes only");
  TickResult result;
  result.revision = scene.revision;
  result.report.stages.push_back({Stage::kVolume, 0.001});
  if (request.transported) result.transported = volumeOf(request, VolumeStage::kTransported);
  if (request.injected) result.injected = volumeOf(request, VolumeStage::kInjected);
  for (const FrameRequest& frame : request.frames) result.frames.push_back(grey(frame));
  return result;
}

ThreadedEngine::ThreadedEngine() : thread_([this] { run(); }) {}

ThreadedEngine::~ThreadedEngine() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void ThreadedEngine::submit(TickRequest request, TickDone done) {
  {
    const std::lock_guard lock(mutex_);
    queue_.emplace_back(std::move(request), std::move(done));
  }
  wake_.notify_all();
}

void ThreadedEngine::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    if (queue_.empty()) return;
    auto [request, done] = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    ++ticks_;
    done(smallResult(request));
    lock.lock();
  }
}

}  // namespace lpv::test
