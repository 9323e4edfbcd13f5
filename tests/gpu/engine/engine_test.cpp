// The engine's contract: stages skipped, sessions taking turns, failures that stay small.

#include <atomic>
#include <chrono>
#include <thread>

#include "engine/device_choice.h"
#include "gpu/engine/engine_rig.h"

namespace lpv {
namespace {

using test::stagesOf;
using testing::Contains;
using testing::ElementsAre;
using testing::Not;

class EngineContractTest : public test::EngineTest {};

TEST_F(EngineContractTest, FirstTickRunsEverythingAsked) {
  TickRequest request = test::requestOf(test::smallScene());
  request.transported = request.injected = true;
  const TickResult result = run(request);
  EXPECT_EQ(result.revision, 1U);
  ASSERT_NE(result.transported, nullptr);
  ASSERT_NE(result.injected, nullptr);
  EXPECT_EQ(result.transported->stage, VolumeStage::kTransported);
  EXPECT_EQ(result.injected->stage, VolumeStage::kInjected);
  EXPECT_EQ(result.transported->layers.at(0).coefficients.size(), 16U * 16 * 16 * 12);
  EXPECT_THAT(stagesOf(result), ElementsAre("upload", "voxelize", "inject", "propagate", "volume", "readback"));
  EXPECT_GT(result.report.touchedCells, 0U);
  EXPECT_GT(result.report.fixedPointError, 0.0);
  EXPECT_THAT(result.report.features, Contains("propagate"));
}

// Broken by: inputs of a stage that leave something out, or a stage whose product is never set.
TEST_F(EngineContractTest, UnchangedInputsSkipTheirStages) {
  Scene scene = test::smallScene();
  TickRequest request = test::requestOf(scene);
  request.transported = true;
  const VolumePtr first = run(request).transported;
  const TickResult again = run(request);
  EXPECT_THAT(stagesOf(again), ElementsAre());
  EXPECT_EQ(again.transported, first) << "the same volume, not a copy";

  scene.options.iterations = 3;
  request.scene = std::make_shared<Scene>(scene);
  EXPECT_THAT(stagesOf(run(request)), ElementsAre("propagate", "volume", "readback"));
  scene.options.clampFaces = true;
  request.scene = std::make_shared<Scene>(scene);
  EXPECT_THAT(stagesOf(run(request)), ElementsAre("propagate", "volume", "readback"));
  test::lightOf(scene).name = "another name";
  scene.options.lookup = Lookup::kNearest;
  request.scene = std::make_shared<Scene>(scene);
  EXPECT_THAT(stagesOf(run(request)), ElementsAre()) << "neither changes the light";
}

// Broken by: an opening ratio in what PROPAGATE is made from, iterations or the clamp in what GATHER is.
TEST_F(EngineContractTest, SettingsOfOtherTransportsRedoNothing) {
  Scene scene = test::smallScene();
  TickRequest request = test::requestOf(scene);
  request.transported = true;
  const VolumePtr propagated = run(request).transported;
  scene.options.k = 5.0;
  scene.options.quality = Quality::kAccurate;
  request.scene = std::make_shared<Scene>(scene);
  const TickResult again = run(request);
  EXPECT_THAT(stagesOf(again), ElementsAre());
  EXPECT_EQ(again.transported, propagated);

  scene.options.transport = Transport::kGather;
  scene.options.injection = Injection::kFlux;
  request.scene = std::make_shared<Scene>(scene);
  const VolumePtr gathered = run(request).transported;
  scene.options.iterations = 3;
  scene.options.clampFaces = true;
  request.scene = std::make_shared<Scene>(scene);
  const TickResult still = run(request);
  EXPECT_THAT(stagesOf(still), ElementsAre());
  EXPECT_EQ(still.transported, gathered);
  scene.options.k = 1.0;
  request.scene = std::make_shared<Scene>(scene);
  EXPECT_THAT(stagesOf(run(request)), ElementsAre("gather", "volume", "readback"));
}

TEST_F(EngineContractTest, EveryPropertyThatEmitsRevoxelizes) {
  Scene scene = test::smallScene();
  TickRequest request = test::requestOf(scene);
  run(request);
  const std::vector<std::function<void(Light&)>> edits = {[](Light& l) { l.transform.translation.x += 0.1; },
                                                          [](Light& l) { l.radiance.y += 1.0; },
                                                          [](Light& l) { l.twoSided = true; },
                                                          [](Light& l) { l.mesh = reference::pyramid(); },
                                                          [](Light& l) { l.enabled = false; },
                                                          [](Light& l) { l.enabled = true; }};
  for (std::size_t i = 0; i < edits.size(); ++i) {
    edits[i](test::lightOf(scene));
    request.scene = std::make_shared<Scene>(scene);
    EXPECT_THAT(stagesOf(run(request)), Contains("inject")) << "edit " << i;
  }
  scene.grid.origin.x += 0.01;
  request.scene = std::make_shared<Scene>(scene);
  EXPECT_THAT(stagesOf(run(request)), Contains("voxelize"));
}

/// Transport and injection of a session.
using Way = std::pair<Transport, Injection>;

// A light's tree is made where it is voxelized, and only there. Broken by: never keeping voxels in keepVoxels();
// keeping any that were made.
TEST_F(EngineContractTest, MovingOneOfFiftyLightsVoxelizesItAndRebuildsOneTree) {
  SessionKey session = 0;
  for (const auto& [transport, injection] :
       {Way{Transport::kPropagate, Injection::kCount}, Way{Transport::kPropagate, Injection::kFlux},
        Way{Transport::kGather, Injection::kFlux}}) {
    Scene scene = test::smallScene();
    scene.options.transport = transport;
    scene.options.injection = injection;
    for (int i = 0; i < 49; ++i) {
      auto light = std::make_shared<Light>(*scene.lights.at("light"));
      light->transform.translation = {0.1 * (i % 7) - 0.3, 0.1 * double(i / 7) - 0.3, 0.05 * i - 1.2};
      light->radiance = {1.0 + i, 50.0 - i, 1.0};
      scene.lights["other " + std::to_string(100 + i)] = light;
    }
    TickRequest request = test::requestOf(scene, ++session);
    request.transported = true;
    EXPECT_EQ(run(request).report.lightsVoxelized, 50U);
    const auto tickWith = [&](const std::function<void(Light&)>& edit) {
      edit(test::lightOf(scene));
      request.scene = std::make_shared<Scene>(scene);
      return run(request);
    };
    const TickResult moved = tickWith([](Light& l) { l.transform.translation.x += 0.07; });
    EXPECT_EQ(moved.report.lightsVoxelized, 1U);
    TickRequest fresh = request;
    fresh.session = 99;
    EXPECT_EQ(run(fresh).transported->layers[0].coefficients, moved.transported->layers[0].coefficients)
        << "the same as if every light were new";
    engine_->forget(99);
    EXPECT_EQ(tickWith([](Light& l) { l.radiance = {9.0, 1.0, 3.0}; }).report.lightsVoxelized, 0U);
    EXPECT_EQ(tickWith([](Light& l) { l.twoSided = true; }).report.lightsVoxelized, 0U);
    EXPECT_EQ(tickWith([](Light& l) { l.enabled = false; }).report.lightsVoxelized, 0U);
    EXPECT_EQ(tickWith([](Light& l) { l.enabled = true; }).report.lightsVoxelized, 1U);
  }
}

TEST_F(EngineContractTest, ACameraAloneMovesNoLight) {
  Scene scene = test::smallScene();
  test::addSurface(scene, "floor", reference::quad());
  TickRequest request = test::requestOf(scene);
  request.frames = {test::linearFrame(test::frontCamera())};
  request.frames[0].view = 5;
  run(request);
  EXPECT_THAT(stagesOf(run(request)), ElementsAre("emitters", "shade", "readback"))
      << "a still camera keeps its G-buffer";
  request.frames[0].camera.eye.x = 0.5;
  EXPECT_THAT(stagesOf(run(request)), ElementsAre("gbuffer", "emitters", "shade", "readback"));
  test::lightOf(scene).transform.translation.x = 0.2;
  request.scene = std::make_shared<Scene>(scene);
  const std::vector<std::string> stages = stagesOf(run(request));
  EXPECT_THAT(stages, Contains("voxelize"));
  EXPECT_THAT(stages, Not(Contains("gbuffer"))) << "a moving light does not redraw the room";
  engine_->forgetView(1, 5);
  EXPECT_THAT(stagesOf(run(request)), Contains("gbuffer"));
}

// A scene without light, then a light, then none again.
TEST_F(EngineContractTest, DarkScenesAreDark) {
  Scene scene = test::smallScene();
  TickRequest request = test::requestOf(scene);
  request.transported = true;
  for (const bool on : {false, true, false}) {
    test::lightOf(scene).enabled = on;
    request.scene = std::make_shared<Scene>(scene);
    const TickResult result = run(request);
    float most = 0.0F;
    for (const float c : result.transported->layers[0].coefficients) most = std::max(most, std::abs(c));
    EXPECT_EQ(most > 0.0F, on);
    EXPECT_EQ(result.report.touchedCells > 0, on);
  }
}

// A deforming mesh: a new object each tick with the same triangles, which are not sent again.
// Broken by: writing into buffers that another light still uses.
TEST_F(EngineContractTest, ADeformingMeshGivesTheSameAsAFreshOne) {
  Scene scene = test::smallScene();
  auto twin = std::make_shared<Light>(*scene.lights.at("light"));
  twin->transform.translation = {1.0, 0.0, 0.0};
  scene.lights["twin"] = twin;  // the same mesh object: must not deform with the other
  Expected<std::unique_ptr<Engine>> other = startEngine({});  // shares nothing with the first
  ASSERT_TRUE(other.ok());
  TickRequest request = test::requestOf(scene);
  request.transported = true;
  run(request);
  for (int step = 1; step <= 4; ++step) {
    Mesh mesh = *reference::sphere();
    for (glm::vec3& p : mesh.positions) p *= 1.0F + 0.2F * float(step) * p.y;
    ASSERT_TRUE(finishMesh(mesh).ok());
    test::lightOf(scene).mesh = std::make_shared<Mesh>(std::move(mesh));
    request.scene = std::make_shared<Scene>(scene);
    const VolumePtr deformed = run(request).transported;
    const Expected<TickResult> fresh = submit(**other, request).get();
    ASSERT_TRUE(fresh.ok());
    EXPECT_EQ(deformed->layers[0].coefficients, fresh->transported->layers[0].coefficients) << step;
    (*other)->forget(1);
  }
}

// Long work of one session is cut into pieces, so that a short tick of another gets its turn in between.
// Broken by: advancing the first tick until it is done.
TEST_F(EngineContractTest, SessionsTakeTurns) {
  Scene heavy = test::smallScene(), quick = test::smallScene();
  heavy.grid = {glm::dvec3(-2.0), 4.0 / 64.0, glm::ivec3(64)};
  run(test::requestOf(quick, 2));  // programs compiled
  bool between = false;
  for (heavy.options.iterations = 400; !between && heavy.options.iterations < 100000; heavy.options.iterations *= 2) {
    auto slow = submit(*engine_, test::requestOf(heavy, 1));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    test::lightOf(quick).transform.translation.x += 0.3;
    auto fast = submit(*engine_, test::requestOf(quick, 2));
    ASSERT_TRUE(fast.get().ok());
    between = slow.wait_for(std::chrono::seconds(0)) == std::future_status::timeout;
    EXPECT_TRUE(slow.get().ok());
    engine_->forget(1);
  }
  EXPECT_TRUE(between) << "the heavy one came first, however heavy";
}

// A long tick is many pieces, and a short one has its turns before the long one has many. Broken by: turns that go
// round whatever pieces cost.
TEST_F(EngineContractTest, TurnsGoByTime) {
  Scene heavy = test::smallScene(), quick = test::smallScene();
  heavy.grid = {glm::dvec3(-2.0), 4.0 / 128.0, glm::ivec3(128)};
  heavy.options.iterations = 6;
  for (const char* name : {"red", "green", "blue"}) {  // three channels
    auto light = std::make_shared<Light>();
    light->mesh = reference::quad();  // small: what one light puts in is not cut
    light->radiance = glm::dvec3(*name == 'r', *name == 'g', *name == 'b');
    heavy.lights[light->name = name] = light;
  }
  heavy.lights.erase("light");
  test::addSurface(heavy, "floor", reference::quad());
  TickRequest large = test::requestOf(heavy, 1);
  large.transported = true;
  large.frames = {test::linearFrame(test::frontCamera(), glm::ivec2(2048, 1024))};
  run(test::requestOf(quick, 2));
  // Programs compiled, rates measured; on fast devices more iterations until there is something to share.
  while (run(large).report.pieces <= 60 && heavy.options.iterations < 100000) {
    engine_->forget(1);
    heavy.options.iterations *= 4;
    large.scene = std::make_shared<Scene>(heavy);
  }
  engine_->forget(1);
  auto slow = submit(*engine_, large);
  std::uint64_t others = 0, own = 0, ticks = 0;
  for (; slow.wait_for(std::chrono::seconds(0)) == std::future_status::timeout; ++ticks) {
    test::lightOf(quick).transform.translation.x = 0.001 * double(ticks);
    const TickReport report = run(test::requestOf(quick, 2)).report;
    others += report.othersPieces;
    own += report.pieces;
  }
  const Expected<TickResult> done = slow.get();
  ASSERT_TRUE(done.ok());
  EXPECT_GT(done->report.pieces, 50U);
  EXPECT_LT(2 * others, own) << "its pieces are the shorter ones";
  EXPECT_GT(ticks, 3U) << "while the long one was under way";
}

/// A scene whose tick takes `iterations`, to be waited for or given up.
Scene slowScene(int iterations) {
  Scene scene = test::smallScene();
  scene.grid = {glm::dvec3(-2.0), 4.0 / 64.0, glm::ivec3(64)};
  scene.options.iterations = iterations;
  return scene;
}

// Broken by: a tick that is waited for to its end; what its story has half made taken for made; an answer while the
// device is at its pieces still.
TEST_F(EngineContractTest, AnAbandonedTickEndsAndTheNextIsAsIfItHadNotBeen) {
  TickRequest request = test::requestOf(slowScene(1000000));
  request.transported = request.patient = true;
  auto endless = submit(*engine_, request);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  engine_->abandon(2);  // another session
  EXPECT_EQ(endless.wait_for(std::chrono::milliseconds(0)), std::future_status::timeout);
  engine_->abandon(1);
  const Expected<TickResult> ended = endless.get();
  ASSERT_FALSE(ended.ok());
  EXPECT_EQ(ended.status().code(), Code::kCancelled) << ended.status().message();
  engine_->abandon(1);  // there is none
  request.patient = false;
  request.scene = std::make_shared<Scene>(slowScene(100));
  auto pressing = submit(*engine_, request);
  engine_->abandon(1);
  EXPECT_TRUE(pressing.get().ok()) << "it is not patient";
  request.scene = std::make_shared<Scene>(slowScene(5));
  TickRequest fresh = request;
  fresh.session = 3;
  EXPECT_EQ(run(request).transported->layers[0].coefficients, run(fresh).transported->layers[0].coefficients);
}

// Broken by: turns by time alone, in which a new session goes first only until it has had as much.
TEST_F(EngineContractTest, APatientTickWaitsForAllOthers) {
  run(test::requestOf(slowScene(1), 2));
  TickRequest patient = test::requestOf(slowScene(1000000), 1);
  patient.patient = true;
  auto waits = submit(*engine_, patient);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  std::uint64_t own = 0, others = 0;
  for (int iterations = 100; iterations <= 102; ++iterations) {
    const TickReport report = run(test::requestOf(slowScene(iterations), 2)).report;
    own += report.pieces;
    others += report.othersPieces;
  }
  EXPECT_EQ(waits.wait_for(std::chrono::milliseconds(0)), std::future_status::timeout);
  engine_->abandon(1);
  EXPECT_FALSE(waits.get().ok());
  EXPECT_LT(4 * others, own) << "but for those that fit between a fence and its turn";
}

TEST_F(EngineContractTest, ASecondTickOfOneSessionIsRefused) {
  Scene heavy = test::smallScene();
  heavy.options.iterations = 1000;
  auto first = submit(*engine_, test::requestOf(heavy));
  const Expected<TickResult> second = tick(test::requestOf(heavy));
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.status().code(), Code::kFailedPrecondition);
  engine_->forget(1);  // while under way: after it
  EXPECT_TRUE(first.get().ok());
  EXPECT_THAT(stagesOf(run(test::requestOf(heavy))), Contains("voxelize"));
}

// Memory that cannot be had fails one tick, not the session, and not another session.
TEST_F(EngineContractTest, AnAllocationThatFailsFailsThatTickOnly) {
  Scene scene = test::smallScene();
  TickRequest request = test::requestOf(scene);
  run(test::requestOf(scene, 2));
  Scene impossible = scene;
  impossible.grid.dims = glm::ivec3(4096, 4096, 1024);
  request.scene = std::make_shared<Scene>(impossible);
  const Expected<TickResult> failed = tick(request);
  ASSERT_FALSE(failed.ok());
  EXPECT_EQ(failed.status().code(), Code::kResourceExhausted) << failed.status().message();
  EXPECT_THAT(stagesOf(run(test::requestOf(scene, 2))), ElementsAre());
  EXPECT_THAT(stagesOf(run(test::requestOf(scene))), Contains("inject"));
}

TEST_F(EngineContractTest, StoppingCancelsWhatIsUnderWay) {
  Scene heavy = test::smallScene();
  heavy.grid = {glm::dvec3(-2.0), 4.0 / 64.0, glm::ivec3(64)};
  heavy.options.iterations = 1000;
  auto result = submit(*engine_, test::requestOf(heavy));
  engine_.reset();
  const Expected<TickResult> answer = result.get();
  ASSERT_FALSE(answer.ok());
  EXPECT_EQ(answer.status().code(), Code::kCancelled);
}

}  // namespace
}  // namespace lpv
