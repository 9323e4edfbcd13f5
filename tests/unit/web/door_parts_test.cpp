// What the door for browsers is made of beside its sockets: names that it answers to, places, files of the page.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "web/files.h"
#include "web/origins.h"
#include "web/places.h"

namespace lpv::web_door {
namespace {

using testing::HasSubstr;

constexpr const char* kNoHost = "evil.example";

Origins::Local here(bool tls) { return {.address = "127.0.0.1:8080", .loopback = true, .tls = tls}; }

TEST(OriginsTest, AreOnesOwnAndThoseListed) {
  const Expected<Origins> read = Origins::read(" https://Light.example.org ,http://10.0.0.5:8080");
  ASSERT_TRUE(read.ok()) << read.status().message();
  for (const char* host : {"127.0.0.1:8080", "localhost:8080", "[::1]:8080", "light.example.org",
                           "LIGHT.example.org:443", "10.0.0.5:8080"})
    EXPECT_TRUE(read->checkHost(host, here(false)).ok()) << host;
  for (const char* host : {kNoHost, "", "127.0.0.1", "127.0.0.1:80", "light.example.org:8080", "10.0.0.5"})
    EXPECT_EQ(read->checkHost(host, here(false)).code(), Code::kPermissionDenied) << host;
  for (const char* origin : {"http://127.0.0.1:8080", "http://localhost:8080", "https://light.example.org",
                             "https://light.example.org:443", "http://10.0.0.5:8080"})
    EXPECT_TRUE(read->checkOrigin(origin, here(false)).ok()) << origin;
  for (const char* origin : {"", "null", "https://127.0.0.1:8080", "http://light.example.org", "http://evil.example"})
    EXPECT_EQ(read->checkOrigin(origin, here(false)).code(), Code::kPermissionDenied) << origin;
  EXPECT_TRUE(read->checkOrigin("https://localhost:8080", here(true)).ok());
}

TEST(OriginsTest, OfAnAddressThatIsNotLoopback) {
  const Origins none = *Origins::read("");
  const Origins::Local outside{.address = "192.168.1.7:443", .loopback = false, .tls = true};
  EXPECT_TRUE(none.checkHost("192.168.1.7", outside).ok()) << "browsers leave 443 out";
  EXPECT_TRUE(none.checkOrigin("https://192.168.1.7", outside).ok());
  EXPECT_FALSE(none.checkHost("localhost", outside).ok());
}

TEST(OriginsTest, WhatIsNoOriginIsRefusedByName) {
  for (const char* text : {"light.example.org", "https://", "ftp://a", "https://a/b", "https://a,,http://b", "*"}) {
    const Expected<Origins> read = Origins::read(text);
    ASSERT_FALSE(read.ok()) << text;
    EXPECT_EQ(read.status().field(), "web-origins");
    EXPECT_THAT(read.status().message(), HasSubstr("is no origin")) << text;
  }
}

TEST(PlacesTest, AreFewForAnAddressAndNotManyForAll) {
  Places places;
  std::vector<std::shared_ptr<void>> taken;
  for (std::size_t i = 0; i < Places::kMostOfAnAddress; ++i) taken.push_back(*places.take("a", false));
  EXPECT_EQ(places.take("a", false).status().code(), Code::kResourceExhausted);
  EXPECT_TRUE(places.take("b", false).ok());
  taken.pop_back();
  EXPECT_TRUE(places.take("a", false).ok());
  while (taken.size() < Places::kMost) taken.push_back(*places.take("proxy", true));
  EXPECT_EQ(places.take("c", false).status().code(), Code::kResourceExhausted);
  EXPECT_EQ(places.take("proxy", true).status().code(), Code::kResourceExhausted);
  taken.clear();
  EXPECT_TRUE(places.take("c", false).ok());
}

TEST(FilesTest, OfAFolder) {
  const std::string folder = testing::TempDir() + "lpv-page-files";
  std::filesystem::create_directories(folder + "/assets");
  std::ofstream(folder + "/notices.txt") << "licences";
  std::ofstream(folder + "/assets/page-1.js") << "script";
  std::ofstream(folder + "/assets/page-1.js.gz") << "packed";
  EXPECT_THAT(Files::of(folder).status().message(), HasSubstr("index.html"));
  std::ofstream(folder + "/index.html") << "document";
  const Expected<Files> files = Files::of(folder);
  ASSERT_TRUE(files.ok()) << files.status().message();
  ASSERT_TRUE(files->hasPage());
  EXPECT_EQ(files->at("/")->plain, "document");
  EXPECT_EQ(files->at("/")->type, "text/html; charset=utf-8");
  EXPECT_EQ(files->at("/notices.txt")->type, "text/plain; charset=utf-8");
  EXPECT_FALSE(files->at("/")->named);
  const File* script = files->at("/assets/page-1.js");
  ASSERT_NE(script, nullptr);
  EXPECT_EQ(script->plain, "script");
  EXPECT_EQ(script->packed, "packed");
  EXPECT_TRUE(script->named);
  EXPECT_EQ(files->at("/assets/../index.html"), nullptr);
  EXPECT_EQ(Files::of(folder + "/nowhere").status().field(), "web-files");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace lpv::web_door
