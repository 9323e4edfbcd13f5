// Where servers listen: what is read, and what is refused by name.

#include "base/address.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lpv {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string read(const std::string& text) {
  const Expected<HostPort> at = parseHostPort("listen", text);
  return at ? at->text() : at.status().message();
}

TEST(Address, IsReadAndWritten) {
  EXPECT_EQ(read("127.0.0.1:0"), "127.0.0.1:0");
  EXPECT_EQ(read(":50051"), "127.0.0.1:50051");
  EXPECT_EQ(read("[::1]:65535"), "[::1]:65535");
  EXPECT_EQ(read("lights.example:80"), "lights.example:80");
}

// Each was taken as it stands by lpvd once, or refused without its name.
TEST(Address, WhatIsWrongIsNamed) {
  for (const char* port : {"99999", "65536", "-1", "", "http", "50051x", " 1"}) {
    const std::string text = "127.0.0.1:" + std::string(port);
    EXPECT_THAT(read(text), AllOf(HasSubstr("--listen is \"" + text + "\""),
                                  HasSubstr("\"" + std::string(port) + "\" is no port, allowed are 0 to 65535")));
  }
  EXPECT_THAT(read("nowhere"), HasSubstr("the form is HOST:PORT"));
  EXPECT_THAT(read("127.0.0.256:1"), HasSubstr("\"127.0.0.256\" is neither an address nor a name"));
  EXPECT_THAT(read("a b:1"), HasSubstr("\"a b\" is neither"));
  EXPECT_THAT(read("::1:50051"), HasSubstr("in brackets"));
  EXPECT_THAT(read("[::g]:1"), HasSubstr("\"::g\" is no IPv6 address"));
}

TEST(Address, LoopbackIsNotWhatOnlyBeginsLikeIt) {
  for (const char* host : {"127.0.0.1", "127.9.9.9", "::1", "localhost"}) EXPECT_TRUE(isLoopback(host)) << host;
  for (const char* host : {"127.example.org", "0.0.0.0", "::", "localhost.example.org"})
    EXPECT_FALSE(isLoopback(host)) << host;
}

}  // namespace
}  // namespace lpv
