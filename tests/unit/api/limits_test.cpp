// The table of limits and the message that tells clients of them.

#include <gtest/gtest.h>

#include "api/services.h"
#include "session/limit_table.h"
#include "unit/api/door_rig.h"

namespace lpv::api {
namespace {

pb::Limits told(const Limits& limits) {
  test::DoorRig rig(false, limits);
  test::TestCall call(rig, pb::GetServerInfoRequest());
  call.say(pb::GetServerInfoRequest());
  EXPECT_TRUE(call.end().ok());
  return dynamic_cast<const pb::GetServerInfoResponse&>(*call.answer()).limits();
}

// Broken by a limit of the table that the message has not: this test, and GetServerInfo, crash.
TEST(LimitTable, EveryLimitIsAFieldOfTheMessage) {
  forEachLimit([](const auto& row) {
    EXPECT_NE(pb::Limits::descriptor()->FindFieldByName(row.name), nullptr) << row.name;
    EXPECT_LT(row.least, row.most) << row.name;
    EXPECT_NE(*row.help, '\0') << row.name;
  });
}

// Broken by a field that nobody fills in.
TEST(LimitTable, EveryFieldOfTheMessageIsSet) {
  const pb::Limits limits = told(Limits());
  for (int i = 0; i < pb::Limits::descriptor()->field_count(); ++i) {
    const google::protobuf::FieldDescriptor& field = *pb::Limits::descriptor()->field(i);
    EXPECT_TRUE(pb::Limits::GetReflection()->HasField(limits, &field)) << field.name();
  }
}

// Broken by rows that read each other's members.
TEST(LimitTable, TellsTheLimitsInForce) {
  Limits limits;
  limits.maxLights = 7;
  limits.maxTriangles = 70'000'000'000;
  limits.maxTickRate = 12.5;
  limits.uploadIdle = std::chrono::seconds(3);
  const pb::Limits out = told(limits);
  EXPECT_EQ(out.max_lights(), 7);
  EXPECT_EQ(out.max_surfaces(), 4096);
  EXPECT_EQ(out.max_triangles(), 70'000'000'000);
  EXPECT_EQ(out.max_tick_rate(), 12.5);
  EXPECT_EQ(out.upload_idle().seconds(), 3);
  EXPECT_EQ(out.first_message().seconds(), 10);
}

}  // namespace
}  // namespace lpv::api
