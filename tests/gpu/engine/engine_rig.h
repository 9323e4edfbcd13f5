#pragma once
// The engine as a session uses it, with answers waited for.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <string>
#include <vector>

#include "engine/engine.h"
#include "reference/meshes.h"

namespace lpv::test {

/// Skips, saying why, where there is no device. Every test has an engine of its own.
class EngineTest : public ::testing::Test {
 protected:
  void SetUp() override;

  static std::future<Expected<TickResult>> submit(Engine& engine, TickRequest request);
  Expected<TickResult> tick(TickRequest request) { return submit(*engine_, std::move(request)).get(); }
  /// A tick that must succeed.
  TickResult run(TickRequest request);

  std::unique_ptr<Engine> engine_;
};

TickRequest requestOf(const Scene& scene, SessionKey session = 1);

/// A grid of 16^3 cells of .25 m about the origin, a sphere light in it.
Scene smallScene();
/// The light called "light", to be changed; the scene gets a copy of its own.
Light& lightOf(Scene& scene);
Surface& addSurface(Scene& scene, const std::string& name, const MeshPtr& mesh);

std::vector<std::string> stagesOf(const TickResult& result);

/// A camera at (0, 0, distance) looking at the origin, 90 degrees: the plane z = 0 is 2 distance high.
Camera frontCamera(double distance = 2.0);
/// 64 x 64 linear pixels.
FrameRequest linearFrame(const Camera& camera, const glm::ivec2& size = {64, 64});

/// Pixel (x, y), y from the top.
glm::dvec3 pixel(const Frame& frame, int x, int y);

}  // namespace lpv::test
