// A lost context: everything is made again from the scene, and nobody is told anything else than without.

#include "engine/device_choice.h"
#include "gpu/engine/engine_rig.h"
#include "lpv/device/engine_testing.h"

namespace lpv {
namespace {

using testing::Contains;

class ContextLossTest : public test::EngineTest {
 protected:
  /// Volumes and a picture, of a scene with several stages.
  static TickRequest request(SessionKey session, double x, Transport transport = Transport::kGather) {
    Scene scene = test::smallScene();
    scene.options.transport = transport;
    scene.options.injection = Injection::kFlux;
    test::addSurface(scene, "floor", reference::quad());
    Light& light = test::lightOf(scene);
    light.transform.translation.x = x;
    scene.revision = std::uint64_t(1000.0 * (x + 10.0));
    TickRequest out = test::requestOf(scene, session);
    out.transported = true;
    out.frames = {test::linearFrame(test::frontCamera())};
    out.frames[0].view = 7;
    return out;
  }

  /// The same of another engine, which loses nothing.
  TickResult undisturbed(const TickRequest& request) {
    Expected<std::unique_ptr<Engine>> other = startEngine({});
    EXPECT_TRUE(other.ok());
    Expected<TickResult> result = submit(**other, request).get();
    EXPECT_TRUE(result.ok());
    return std::move(*result);
  }

  static void expectSame(const TickResult& got, const TickResult& want) {
    EXPECT_EQ(got.revision, want.revision);
    ASSERT_NE(got.transported, nullptr);
    EXPECT_EQ(got.transported->layers[0].coefficients, want.transported->layers[0].coefficients);
    ASSERT_EQ(got.frames.size(), 1U);
    EXPECT_EQ(got.frames[0]->rgb32f, want.frames[0]->rgb32f);
  }
};

// One piece of a tick after the other is the one in which the context goes: in uploads, voxelization, transport, frames
// and copies. Broken by: not making the ticks under way again; keeping the session's state, or the pipeline's programs,
// of the old context; making the new context before the old objects are gone (they delete those of the new one by
// number).
TEST_F(ContextLossTest, ATickInWhichItGoesIsMadeAgain) {
  for (const Transport transport : {Transport::kGather, Transport::kPropagate}) {
    const TickRequest wanted = request(1, 0.3, transport);
    const TickResult want = undisturbed(wanted);
    std::int64_t losses = engine_->contextLosses();
    std::uint64_t piece = 1;
    for (;; piece += 5) {
      engine_->forget(1);
      loseContext(*engine_, piece);
      expectSame(run(wanted), want);
      if (engine_->contextLosses() == losses) break;  // the tick has fewer pieces
      EXPECT_EQ(engine_->contextLosses(), ++losses) << piece;
    }
    EXPECT_GT(piece, 10U);
  }
}

// What a session had on the GPU is gone with the context: its next tick makes it again, from where it stands now.
// Broken by: looking for a lost context only while a tick is under way.
TEST_F(ContextLossTest, SessionsThatRestedGoOn) {
  run(request(1, 0.1));
  run(request(2, 0.2));
  loseContext(*engine_, 1);
  run(request(2, 0.25));
  EXPECT_EQ(engine_->contextLosses(), 1);
  const TickRequest again = request(1, 0.1);
  const TickResult result = run(again);
  EXPECT_THAT(test::stagesOf(result), Contains("voxelize")) << "kept of a context that is gone";
  expectSame(result, undisturbed(again));
  EXPECT_THAT(test::stagesOf(run(again)), testing::Not(Contains("voxelize"))) << "and kept again from then on";
}

// Two sessions under way at once.
TEST_F(ContextLossTest, AllTicksUnderWayAreMadeAgain) {
  const TickRequest one = request(1, 0.3), two = request(2, -0.3, Transport::kPropagate);
  const TickResult wantOne = undisturbed(one), wantTwo = undisturbed(two);
  for (const std::uint64_t piece : {2U, 5U, 9U}) {
    engine_->forget(1);
    engine_->forget(2);
    loseContext(*engine_, piece);
    auto first = submit(*engine_, one), second = submit(*engine_, two);
    const Expected<TickResult> gotOne = first.get(), gotTwo = second.get();
    ASSERT_TRUE(gotOne.ok() && gotTwo.ok());
    expectSame(*gotOne, wantOne);
    expectSame(*gotTwo, wantTwo);
  }
  EXPECT_EQ(engine_->contextLosses(), 3);
}

}  // namespace
}  // namespace lpv
