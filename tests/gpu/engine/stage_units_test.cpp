// What admission expects of a scene, against what the pieces of its first tick say that they did, stage by stage.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <map>

#include "gpu/support/gl_test.h"
#include "lpv/pipeline.h"
#include "reference/meshes.h"
#include "scene/workload.h"

namespace lpv {
namespace {

using Units = std::array<double, kStages>;

class StageUnitsTest : public test::GlTest {
 protected:
  /// A ball, a pane of another colour that takes a group of its own where the server groups, and a floor.
  static Scene sceneOf(Transport transport, int cells) {
    Scene scene;
    scene.options = LightingSettings::paper();
    scene.options.transport = transport;
    scene.options.followTransport();
    scene.grid = {glm::dvec3(-2.0), 4.0 / cells, glm::ivec3(cells)};
    for (const char* name : {"ball", "pane"}) {
      auto light = std::make_shared<Light>();
      light->name = name;
      light->mesh = name[0] == 'b' ? reference::sphere() : reference::quad();
      light->radiance = name[0] == 'b' ? glm::dvec3(4.0, 2.0, 1.0) : glm::dvec3(1.0, 3.0, 1.0);
      light->transform.translation = {name[0] == 'b' ? 0.7 : -1.1, 0.2, 0.3};
      scene.lights[name] = light;
    }
    auto floor = std::make_shared<Surface>();
    floor->name = "floor";
    floor->mesh = reference::quad();
    scene.surfaces["floor"] = floor;
    return scene;
  }

  static Units expectedOf(const Scene& scene) {
    Workload workload(scene.options, scene.grid);
    for (const auto& [name, light] : scene.lights) workload.add(*light);
    for (const auto& [name, surface] : scene.surfaces) workload.add(*surface);
    return unitsOf(workload);
  }

  static Units doneBy(const Scene& scene) {
    Pipeline pipeline(0.01);
    SessionState state;
    TickRequest request;
    request.scene = std::make_shared<Scene>(scene);
    request.transported = true;
    TickResult result;
    Units done{};
    GpuTask story = pipeline.tick(state, request, result);
    for (story.resume(); !story.done(); story.resume()) {
      const Pause& pause = story.pause();
      if (pause.kind == Pause::Kind::kPiece) done[std::size_t(pause.stage)] += pause.units;
      if (pause.kind != Pause::Kind::kFence) continue;
      while (!pause.fence->wait(std::chrono::milliseconds(100))) {
      }
    }
    return done;
  }
};

// By what factor they may differ: 1 where both know the same. Injection is expected in one pass, COUNT with several
// lights takes two, over cells of which some hold no light (0.59 and 0.67 of what is done, here). PROPAGATE's box and
// GATHER's trees are smaller than expected (1.25 to 1.30, 1.12 to 1.24). Broken by: another factor in units() of one of
// the two; a mean over more triangles than there are, in a small mesh.
TEST_F(StageUnitsTest, AdmissionExpectsWhatPiecesDo) {
  constexpr double kSame = 1.0001;
  const std::map<Stage, double> factors = {{Stage::kUpload, kSame}, {Stage::kVoxelize, kSame},
                                           {Stage::kInject, 2.0},   {Stage::kPropagate, 1.5},
                                           {Stage::kGather, 1.5},   {Stage::kVolume, kSame}};
  for (const Transport transport : {Transport::kPropagate, Transport::kGather}) {
    for (const int cells : {16, 36}) {
      const Scene scene = sceneOf(transport, cells);
      const Units expected = expectedOf(scene), done = doneBy(scene);
      for (const auto& [stage, factor] : factors) {
        const double want = done[std::size_t(stage)], got = expected[std::size_t(stage)];
        EXPECT_LE(got, factor * want) << nameOf(stage) << " of " << cells;
        EXPECT_GE(factor * got, want) << nameOf(stage) << " of " << cells;
      }
      EXPECT_GT(done[std::size_t(transport == Transport::kGather ? Stage::kGather : Stage::kPropagate)], 0.0);
    }
  }
}

}  // namespace
}  // namespace lpv
