// Same scene, grid and options: the same bytes (ARCHITECTURE.md, Contracts).

#include <cstring>

#include "engine/device_choice.h"
#include "gpu/engine/engine_rig.h"

namespace lpv {
namespace {

class DeterminismTest : public test::EngineTest {
 protected:
  static bool sameBytes(const VolumePtr& a, const VolumePtr& b) {
    const std::vector<float>&x = a->layers[0].coefficients, &y = b->layers[0].coefficients;
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(float)) == 0;
  }
  static Scene scene() {
    Scene s = test::smallScene();
    test::lightOf(s).mesh = reference::bumpySphere(20000);
    auto red = std::make_shared<Light>(*s.lights.at("light"));
    red->radiance = {1.0, 0.1, 0.0};
    red->transform.translation = {0.3, 0.2, 0.1};
    s.lights["red"] = red;
    return s;
  }
  static TickRequest request(SessionKey session) {
    TickRequest r = test::requestOf(scene(), session);
    r.transported = r.injected = true;
    return r;
  }
};

// Broken by: float atomics in voxelize.comp; a sum in the order of the touched list.
TEST_F(DeterminismTest, RunsSessionsAndEnginesAgreeBitForBit) {
  const TickResult first = run(request(1)), second = run(request(2));
  EXPECT_TRUE(sameBytes(first.injected, second.injected));
  EXPECT_TRUE(sameBytes(first.transported, second.transported));
  Expected<std::unique_ptr<Engine>> other = startEngine({});
  ASSERT_TRUE(other.ok());
  const Expected<TickResult> third = submit(**other, request(1)).get();
  ASSERT_TRUE(third.ok());
  EXPECT_TRUE(sameBytes(first.injected, third->injected));
  EXPECT_TRUE(sameBytes(first.transported, third->transported));
}

// Where a session has been before does not show. Broken by: steps not cleared; cells not retired.
TEST_F(DeterminismTest, TheWayThereDoesNotMatter) {
  const TickResult straight = run(request(1));
  TickRequest wandering = request(2);
  Scene elsewhere = *wandering.scene;
  test::lightOf(elsewhere).transform.translation = {-1.0, 0.7, 0.9};
  elsewhere.options.clampFaces = true;
  wandering.scene = std::make_shared<Scene>(elsewhere);
  run(wandering);
  const TickResult back = run(request(2));
  EXPECT_TRUE(sameBytes(straight.injected, back.injected));
  EXPECT_TRUE(sameBytes(straight.transported, back.transported));
}

}  // namespace
}  // namespace lpv
