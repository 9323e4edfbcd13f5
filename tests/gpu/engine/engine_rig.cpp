#include "gpu/engine/engine_rig.h"

#include <iostream>

#include "engine/device_choice.h"

namespace lpv::test {

void EngineTest::SetUp() {
  Expected<std::unique_ptr<Engine>> engine = startEngine({});
  if (!engine.ok()) {
    std::cout << "SKIPPED: NO DEVICE (" << engine.status().message() << ")\n";
    GTEST_SKIP() << engine.status().message();
  }
  engine_ = std::move(*engine);
}

std::future<Expected<TickResult>> EngineTest::submit(Engine& engine, TickRequest request) {
  auto promise = std::make_shared<std::promise<Expected<TickResult>>>();
  engine.submit(std::move(request), [promise](Expected<TickResult> result) { promise->set_value(std::move(result)); });
  return promise->get_future();
}

TickResult EngineTest::run(TickRequest request) {
  Expected<TickResult> result = tick(std::move(request));
  EXPECT_TRUE(result.ok()) << result.status().message();
  return result.ok() ? std::move(*result) : TickResult{};
}

TickRequest requestOf(const Scene& scene, SessionKey session) {
  TickRequest request;
  request.session = session;
  request.scene = std::make_shared<Scene>(scene);
  return request;
}

Scene smallScene() {
  Scene scene;
  scene.options = LightingSettings::paper();
  scene.revision = 1;
  scene.grid = {glm::dvec3(-2.0), 0.25, glm::ivec3(16)};
  auto light = std::make_shared<Light>();
  light->name = "light";
  light->mesh = reference::sphere();
  light->radiance = {4.0, 2.0, 1.0};
  scene.lights["light"] = light;
  return scene;
}

Light& lightOf(Scene& scene) {
  auto copy = std::make_shared<Light>(*scene.lights.at("light"));
  scene.lights["light"] = copy;
  ++scene.revision;
  return *copy;
}

Surface& addSurface(Scene& scene, const std::string& name, const MeshPtr& mesh) {
  auto surface = std::make_shared<Surface>();
  surface->name = name;
  surface->mesh = mesh;
  scene.surfaces[name] = surface;
  return *surface;
}

std::vector<std::string> stagesOf(const TickResult& result) {
  std::vector<std::string> names;
  for (const StageTime& time : result.report.stages) names.push_back(nameOf(time.stage));
  return names;
}

Camera frontCamera(double distance) {
  Camera camera;
  camera.eye = {0.0, 0.0, distance};
  camera.target = glm::dvec3(0.0);
  camera.fovDegrees = 90.0;
  return camera;
}

FrameRequest linearFrame(const Camera& camera, const glm::ivec2& size) {
  FrameRequest frame;
  frame.camera = camera;
  frame.size = size;
  frame.format = PixelFormat::kRgb32F;
  return frame;
}

glm::dvec3 pixel(const Frame& frame, int x, int y) {
  const std::size_t at = 3 * (std::size_t(y) * std::size_t(frame.size.x) + std::size_t(x));
  if (frame.format == PixelFormat::kRgb8) return glm::dvec3(frame.rgb8[at], frame.rgb8[at + 1], frame.rgb8[at + 2]);
  return glm::dvec3(frame.rgb32f[at], frame.rgb32f[at + 1], frame.rgb32f[at + 2]);
}

}  // namespace lpv::test
