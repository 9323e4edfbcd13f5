#include "gpu/context.h"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <thread>

#include "engine/device_choice.h"
#include "gpu/device.h"
#include "gpu/support/gl_test.h"

namespace lpv {
namespace {

class ContextTest : public test::GlTest {};

TEST_F(ContextTest, SaysWhatItRunsOn) {
  std::string reason;
  const gpu::Capabilities& c = test::context(reason)->capabilities();
  EXPECT_FALSE(c.renderer.empty());
  EXPECT_GE(c.maxStorageBytes, std::int64_t(128) << 20) << "the least that 4.5 core promises";
}

// Broken by: ranking surfaceless before the device platform.
TEST_F(ContextTest, PrefersHardwareThenSoftwareThenSurfaceless) {
  std::vector<gpu::Device> devices(3);
  devices[0] = {0, "surfaceless", "s", false, nullptr};
  devices[1] = {1, "device", "cpu", true, &devices[1]};
  devices[2] = {2, "device", "gpu", false, &devices[2]};
  std::vector<int> order;
  for (const gpu::Device& d : gpu::preferredOrder(devices)) order.push_back(d.index);
  EXPECT_THAT(order, testing::ElementsAre(2, 1, 0));
}

TEST_F(ContextTest, SecondContextLivesBesideTheFirst) {
  std::string reason;
  {
    const Expected<gpu::Context> other = gpu::Context::make(test::context(reason)->device());
    ASSERT_TRUE(other.ok()) << other.status().message();
  }
  // The other one took the thread: this process's display must have survived it.
  const Expected<gpu::Context> third = gpu::Context::make(gpu::listDevices().back());
  EXPECT_TRUE(third.ok() || !third.status().message().empty());
}

TEST(DeviceChoiceTest, ReadsAutoSoftwareAndIndices) {
  EXPECT_EQ(parseDeviceChoice("auto")->kind, DeviceChoice::Kind::kAuto);
  EXPECT_EQ(parseDeviceChoice("software")->kind, DeviceChoice::Kind::kSoftware);
  EXPECT_EQ(parseDeviceChoice("7")->index, 7);
  for (const char* wrong : {"", "gpu", "-1", "1x", "99999999999999999999"}) {
    const Expected<DeviceChoice> choice = parseDeviceChoice(wrong);
    ASSERT_FALSE(choice.ok()) << wrong;
    EXPECT_EQ(choice.status().code(), Code::kInvalidArgument);
    EXPECT_EQ(choice.status().field(), "device");
  }
}

TEST(DeviceListTest, OneLinePerDeviceAndAtMostOneIsUsed) {
  const std::vector<std::string> lines = describeDevices({});
  EXPECT_EQ(lines.size(), gpu::listDevices().size());
  int used = 0;
  for (const std::string& line : lines) used += line.find("would be used") != std::string::npos ? 1 : 0;
  EXPECT_LE(used, 1);
}

// Broken by: overwriting what the environment says.
TEST(SoftwareWorkersTest, AreTwicePerCoreUnlessTheEnvironmentSays) {
  const char* const before = std::getenv("LP_NUM_THREADS");
  const std::string kept = before == nullptr ? "" : before;
  setenv("LP_NUM_THREADS", "3", 1);
  gpu::askForSoftwareWorkers();
  EXPECT_STREQ(std::getenv("LP_NUM_THREADS"), "3");
  unsetenv("LP_NUM_THREADS");
  gpu::askForSoftwareWorkers();
  EXPECT_EQ(std::stoi(std::getenv("LP_NUM_THREADS")), std::min(16, 2 * int(std::thread::hardware_concurrency())));
  before == nullptr ? unsetenv("LP_NUM_THREADS") : setenv("LP_NUM_THREADS", kept.c_str(), 1);
}

TEST(DeviceListTest, UnknownIndexIsUnavailable) {
  const auto engine = startEngine({DeviceChoice::Kind::kIndex, 99});
  ASSERT_FALSE(engine.ok());
  EXPECT_EQ(engine.status().code(), Code::kUnavailable);
  EXPECT_THAT(engine.status().message(), testing::HasSubstr("99"));
}

}  // namespace
}  // namespace lpv
