// Who may begin how many calls, by address.

#include "api/call/address_limit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lpv::api {
namespace {

using ::testing::HasSubstr;

AddressList listOf(const std::string& text) {
  const Expected<AddressList> list = AddressList::read("trusted-proxy", text);
  EXPECT_TRUE(list.ok()) << list.status().message();
  return list ? *list : AddressList();
}

bool holds(const AddressList& list, const std::string& peer) { return list.contains(addressOf(peer)); }

TEST(AddressList, HoldsAddressesAndNetworks) {
  const AddressList list = listOf("10.1.2.3, 192.168.0.0/20,fd00::/9, ::1");
  EXPECT_TRUE(holds(list, "ipv4:10.1.2.3:50000"));
  EXPECT_FALSE(holds(list, "ipv4:10.1.2.4:50000"));
  EXPECT_TRUE(holds(list, "ipv4:192.168.15.255:1"));
  EXPECT_FALSE(holds(list, "ipv4:192.168.16.0:1"));
  EXPECT_TRUE(holds(list, "ipv6:%5Bfd7f::9%5D:1"));
  EXPECT_FALSE(holds(list, "ipv6:%5Bfd80::9%5D:1"));
  EXPECT_TRUE(holds(list, "ipv6:%5B::1%5D:50000"));
  EXPECT_TRUE(holds(list, "ipv6:%5B::ffff:10.1.2.3%5D:50000")) << "IPv4 over an IPv6 socket";
  EXPECT_FALSE(holds(listOf("none"), "ipv4:127.0.0.1:1"));
  EXPECT_TRUE(holds(listOf("0.0.0.0/0"), "ipv4:8.8.8.8:1"));
  EXPECT_FALSE(holds(listOf("0.0.0.0/0"), "ipv6:%5Bfd00::1%5D:1"));
}

TEST(AddressList, RefusesWhatIsNone) {
  for (const char* wrong :
       {"proxy", "10.1.2", "10.1.2.3/33", "::1/129", "10.1.2.3/-1", "10.1.2.3,,::1", "10.1.2.3/x", ",", ""}) {
    const Status status = AddressList::read("trusted-proxy", wrong).status();
    EXPECT_EQ(status.code(), Code::kInvalidArgument) << wrong;
    EXPECT_THAT(status.message(), HasSubstr("--trusted-proxy")) << wrong;
  }
}

TEST(AddressOf, KnowsWhatGrpcCallsPeers) {
  EXPECT_EQ(addressOf("ipv4:127.0.0.1:50000").size(), 16U);
  EXPECT_EQ(addressOf("ipv6:%5Bfe80::1%25eth0%5D:50000"), addressOf("ipv6:%5Bfe80::1%5D:1"));
  for (const char* other : {"unix:/tmp/socket", "unix-abstract:x", "", "ipv4:", "ipv4:x:1", "ipv6:%5B%5D:1"}) {
    EXPECT_EQ(addressOf(other), "") << other;
  }
}

class AddressLimitTest : public ::testing::Test {
 protected:
  int begun(const std::string& peer, int calls, double perSecond = 10.0) {
    int out = 0;
    for (int i = 0; i < calls; ++i) out += call(peer, perSecond).status.ok() ? 1 : 0;
    return out;
  }
  /// Begins and ends.
  AddressLimit::Verdict call(const std::string& peer, double perSecond = 10.0) {
    const AddressLimit::Verdict out = limit_.begin(peer, perSecond, now_);
    limit_.ended(peer);
    return out;
  }
  Clock::time_point now_ = Clock::now();
  AddressLimit limit_{listOf("127.0.0.0/8")};
};

TEST_F(AddressLimitTest, EachAddressHasItsOwn) {
  EXPECT_EQ(begun("ipv4:10.0.0.1:1", 15), 10);
  EXPECT_EQ(begun("ipv4:10.0.0.1:2", 15), 0) << "another connection of the same";
  EXPECT_EQ(begun("ipv4:10.0.0.2:1", 15), 10);
  now_ += std::chrono::milliseconds(500);
  EXPECT_EQ(begun("ipv4:10.0.0.1:1", 15), 5);
  const Status refused = call("ipv4:10.0.0.1:1").status;
  EXPECT_EQ(refused.code(), Code::kResourceExhausted);
  EXPECT_EQ(refused.reason(), Reason::kMaxCallsPerSecondPerAddress);
  EXPECT_GT(refused.retryAfter().count(), 0);
  EXPECT_THAT(refused.message(), HasSubstr("--trusted-proxy"));
}

TEST_F(AddressLimitTest, ANetworkOf64BitsIsOneAddress) {
  EXPECT_EQ(begun("ipv6:%5B2001:db8:0:1::1%5D:1", 15), 10);
  EXPECT_EQ(begun("ipv6:%5B2001:db8:0:1:ffff::2%5D:1", 15), 0);
  EXPECT_EQ(begun("ipv6:%5B2001:db8:0:2::1%5D:1", 15), 10);
}

TEST_F(AddressLimitTest, ProxiesAndSocketsHaveNone) {
  EXPECT_EQ(begun("ipv4:127.0.0.9:1", 100), 100);
  EXPECT_EQ(begun("unix:/tmp/socket", 100), 100);
}

/// It is banned, whichever its connection; who listens to refusals is not.
TEST_F(AddressLimitTest, WhoGoesOnAfterManyRefusalsIsBanned) {
  const auto floods = [this](const std::string& peer, int calls) {
    int out = 0;
    for (int i = 0; i < calls; ++i) out += call(peer).flood ? 1 : 0;
    return out;
  };
  const std::string flooding = addressOf("ipv4:10.0.0.1:1");
  EXPECT_EQ(floods("ipv4:10.0.0.1:1", 400), 0);
  EXPECT_FALSE(limit_.banned(flooding, now_));
  EXPECT_EQ(floods("ipv4:10.0.0.1:2", 400), 1) << "its connections are ended once";
  EXPECT_TRUE(limit_.banned(flooding, now_));
  EXPECT_FALSE(limit_.banned(addressOf("ipv4:10.0.0.2:1"), now_));
  now_ += std::chrono::milliseconds(200);
  EXPECT_EQ(floods("ipv4:10.0.0.1:3", 400), 1) << "a connection that was taken while the ban began";
  now_ += AddressLimit::kBan - std::chrono::milliseconds(1);
  EXPECT_TRUE(limit_.banned(flooding, now_));
  now_ += std::chrono::milliseconds(1);
  EXPECT_FALSE(limit_.banned(flooding, now_));
  EXPECT_EQ(floods("ipv4:10.0.0.1:3", 400), 0) << "it has listened meanwhile";
}

TEST_F(AddressLimitTest, ABanIsNewsOnce) {
  int news = 0;
  for (int i = 0; i < 100; ++i, now_ += std::chrono::milliseconds(50)) {
    for (int k = 0; k < 100; ++k) news += call("ipv4:10.0.0.1:1").news ? 1 : 0;
  }
  EXPECT_EQ(news, 1);
}

TEST_F(AddressLimitTest, ManyWhoAreRefusedNowAndThenAreNoFlood) {
  for (int i = 0; i < 3000; ++i, now_ += std::chrono::milliseconds(10)) {
    EXPECT_FALSE(call("ipv4:10.0.0.1:1").flood);
  }
}

/// However slowly: a busy server ends few calls a second, fewer than the limit counts.
TEST_F(AddressLimitTest, WhoseCallsPileUpIsBanned) {
  const auto begin = [this](const std::string& peer) {
    now_ += std::chrono::milliseconds(200);  // always allowed, by the second
    return limit_.begin(peer, 10.0, now_);
  };
  for (int i = 0; i < AddressLimit::kMostUnfinished; ++i) {
    EXPECT_TRUE(begin("ipv4:10.0.0.1:1").status.ok());
    EXPECT_TRUE(begin("ipv4:10.0.0.1:2").status.ok()) << "each connection has its own";
  }
  limit_.ended("ipv4:10.0.0.1:1");
  EXPECT_TRUE(begin("ipv4:10.0.0.1:1").status.ok());
  EXPECT_FALSE(limit_.banned(addressOf("ipv4:10.0.0.1:1"), now_));
  const AddressLimit::Verdict verdict = begin("ipv4:10.0.0.1:1");
  EXPECT_EQ(verdict.status.code(), Code::kResourceExhausted);
  EXPECT_TRUE(verdict.flood);
  EXPECT_TRUE(limit_.banned(addressOf("ipv4:10.0.0.1:2"), now_));
}

/// An attacker with many addresses does not fill memory.
TEST_F(AddressLimitTest, SilentCallersAreForgotten) {
  for (int i = 0; i < 300'000; ++i) {
    const std::string address =
        "10." + std::to_string(i >> 16) + "." + std::to_string((i >> 8) & 255) + "." + std::to_string(i & 255);
    ASSERT_TRUE(call("ipv4:" + address + ":1").status.ok());
  }
  EXPECT_EQ(begun("ipv4:10.0.0.1:1", 15), 10);
}

}  // namespace
}  // namespace lpv::api
