// Bad input, each with its code, the field to blame and the limit. All rows go to one session, which afterwards is at
// the revision it was at and still lights.

#include <gtest/gtest.h>

#include "rpc/edits/bad_input.h"
#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc {
namespace {

World& world() {
  static World it;
  return it;
}

TEST(BadInput, IsRefusedByFieldAndLimit) {
  World& w = world();
  const std::uint64_t revision = getSession(w.stubs, w.session).revision();
  for (const Row& row : badInput()) {
    EXPECT_THAT(row.send(w), Refused(row.code, row.field, row.text)) << "row " << row.name;
    ASSERT_TRUE(server().running()) << "row " << row.name;
  }
  const pb::Session after = getSession(w.stubs, w.session);
  EXPECT_EQ(after.revision(), revision);
  EXPECT_EQ(after.light_count(), 1);
  EXPECT_EQ(after.surface_count(), 0);
  EXPECT_GT(probe(w.stubs, w.session, {{{0, 0, 0.4}, {0, 0, -1}}})[0].x, 0.0);
  pb::GetStatsResponse stats;
  ASSERT_THAT(w.stubs.server->GetStats(Call(), pb::GetStatsRequest(), &stats), IsOk());
  EXPECT_EQ(stats.sessions(), 1);
  EXPECT_EQ(stats.blobs(), 0);
}

/// Irradiance before and behind a lamp in the middle, from its +z side and its -z side.
std::pair<double, double> sides(Stubs& stubs, const glm::dvec3& scale) {
  const std::string session = makeSession(stubs, settings(9));  // odd: the lamp is in the middle of a cell
  pb::Light lamp = light("Lamp");
  *lamp.mutable_transform()->mutable_scale() = vec3(scale.x, scale.y, scale.z);
  apply(stubs, session, {client::createLight(lamp)});
  const auto e = probe(stubs, session, {{{0, 0, 0.5}, {0, 0, -1}}, {{0, 0, -0.5}, {0, 0, 1}}});
  return {e[0].x, e[1].x};
}

TEST(MirroredLights, ShineFromTheSideThatIsOutsideInTheObject) {
  Stubs& stubs = world().stubs;
  const auto [front, back] = sides(stubs, {1, 1, 1});
  ASSERT_GT(front, 2.0 * back) << "the lamp emits towards +z";
  // Mirrored across its own plane: the object's outside is now towards -z.
  const auto [frontZ, backZ] = sides(stubs, {1, 1, -1});
  EXPECT_NEAR(backZ, front, 1e-3 * front);
  EXPECT_NEAR(frontZ, back, 1e-3 * front);
  // Mirrored within its plane the winding turns round, the outside stays where it was.
  const auto [frontX, backX] = sides(stubs, {-1, 1, 1});
  EXPECT_NEAR(frontX, front, 1e-3 * front);
  EXPECT_NEAR(backX, back, 1e-3 * front);
  // Three mirrors: the outside is towards -z, the winding turned.
  const auto [frontAll, backAll] = sides(stubs, {-1, -1, -1});
  EXPECT_NEAR(backAll, front, 1e-3 * front);
  EXPECT_NEAR(frontAll, back, 1e-3 * front);
}

}  // namespace
}  // namespace lpv::rpc
