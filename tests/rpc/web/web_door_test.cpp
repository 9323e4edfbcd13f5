// The door for browsers against those who do not mean well, and the page that it serves.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "rpc/attacks/bystander.h"
#include "rpc/security/certificates.h"
#include "rpc/web/browsers.h"

namespace lpv::rpc {
namespace {

using testing::HasSubstr;

constexpr int kText = 1, kBinary = 2;

std::string helloBytes(const std::string& token = {}) {
  web::v1::ToServer hello;
  hello.mutable_hello()->set_token(token);
  return hello.SerializeAsString();
}

Arrived lastOf(WebSocketClient& socket) {
  Arrived arrived = socket.receive();
  while (arrived.opcode == kBinary) arrived = socket.receive();
  return arrived;
}

TEST(WebDoor, OtherSitesAndOtherNamesAreRefused) {
  Browsers door({"--web-origins", "https://light.example.org, http://10.1.2.3:8080"});
  const std::string port = std::to_string(door.port());
  const auto status = [&](Knock knock) { return WebSocketClient(door.port(), std::move(knock)).status(); };
  EXPECT_EQ(status({}), 101);
  EXPECT_EQ(status({.host = "localhost:" + port, .origin = "http://localhost:" + port}), 101);
  EXPECT_EQ(status({.host = "light.example.org", .origin = "https://light.example.org"}), 101);
  EXPECT_EQ(status({.host = "LIGHT.example.org:443", .origin = "https://Light.example.org:443"}), 101);
  EXPECT_EQ(status({.host = "10.1.2.3:8080", .origin = "http://10.1.2.3:8080"}), 101);
  EXPECT_EQ(status({.host = "evil.example:" + port}), 421) << "DNS that points here";
  EXPECT_EQ(status({.origin = "http://evil.example"}), 403);
  EXPECT_EQ(status({.origin = "https://127.0.0.1:" + port}), 403) << "another scheme";
  EXPECT_EQ(status({.origin = "null"}), 403);
  EXPECT_EQ(status({.withOrigin = false}), 403);
  EXPECT_EQ(door.refused("host"), 1.0);
  EXPECT_EQ(door.refused("origin"), 4.0);
  const WebSocketClient refused(door.port(), {.origin = "http://evil.example"});
  EXPECT_THAT(refused.answer(), HasSubstr("Origin \"http://evil.example\" is not allowed"));
  EXPECT_THAT(refused.answer(), HasSubstr("--web-origins"));
}

TEST(WebDoor, ThePageComesWithItsPolicy) {
  const HttpAnswer page = httpGet(browsers().port(), "/");
  // httpGet's Host has no port.
  EXPECT_EQ(page.status, 421);
  const WebSocketClient asked(browsers().port(), {.path = "/"});
  EXPECT_THAT(asked.answer(), HasSubstr("default-src 'none'"));
  EXPECT_THAT(asked.answer(), HasSubstr("frame-ancestors 'none'"));
  EXPECT_THAT(asked.answer(), HasSubstr("X-Content-Type-Options: nosniff"));
  EXPECT_THAT(asked.answer(), HasSubstr("Referrer-Policy: no-referrer"));
  EXPECT_THAT(asked.answer(), HasSubstr("Cache-Control: no-store"));
  EXPECT_TRUE(asked.status() == 200 || asked.status() == 503) << asked.status() << ", 503 where npm is missing";
}

TEST(WebDoor, AnAddressWithATokenIsRefused) {
  for (const char* path : {"/ws?token=lpv_x", "/?access_token=lpv_x", "/ws?lpv_0123"}) {
    const WebSocketClient told(browsers().port(), {.path = path});
    EXPECT_EQ(told.status(), 400) << path;
    EXPECT_THAT(told.answer(), HasSubstr("an address may hold no token")) << path;
  }
  EXPECT_THAT(browsers().server().log(), testing::Not(HasSubstr("lpv_x")));
}

TEST(WebDoor, WhatIsNoToServerClosesItsSocketByName) {
  struct Case {
    const char* what;
    std::function<void(WebSocketClient&)> send;
    int code;
    const char* says;
  };
  web::v1::ToServer early;
  early.set_call(1);
  early.mutable_begin()->set_method("lpv.v1.ServerService/GetServerInfo");
  web::v1::ToServer ahead;
  ahead.set_call(7);
  ahead.set_message("");
  const std::vector<Case> cases = {
      {"text", [](auto& s) { s.send(kText, "hello"); }, 1003, "text is refused"},
      {"bytes", [](auto& s) { s.send(kBinary, "\xff\xff\xff\xff"); }, 1007, "no lpv.web.v1.ToServer"},
      {"no step", [](auto& s) { s.send(kBinary, ""); }, 1008, "step"},
      {"a call before hello", [&](auto& s) { s.send(kBinary, early.SerializeAsString()); }, 1008, "hello"},
      {"a call that has not begun",
       [&](auto& s) {
         s.send(kBinary, helloBytes());
         s.send(kBinary, ahead.SerializeAsString());
       },
       1008, "7 has not begun"},
      {"a number twice",
       [&](auto& s) {
         s.send(kBinary, helloBytes());
         s.send(kBinary, early.SerializeAsString());
         s.send(kBinary, early.SerializeAsString());
       },
       1008, "no new number"},
      {"a reserved opcode", [](auto& s) { s.send(5, ""); }, 1002, ""},
      {"a frame without a mask", [](auto& s) { s.sendRaw(std::string("\x82\x00", 2)); }, 1002, ""},
  };
  for (const Case& each : cases) {
    WebSocketClient socket(browsers().port());
    ASSERT_EQ(socket.status(), 101);
    each.send(socket);
    const Arrived end = lastOf(socket);
    EXPECT_EQ(end.closeCode(), each.code) << each.what << ": " << end.closeReason();
    EXPECT_THAT(end.closeReason(), HasSubstr(each.says)) << each.what;
  }
}

// Before a good token 64 KiB, then 1 MiB; what is announced is not allocated.
TEST(WebDoor, MessagesThatAreTooLargeAreRefusedAndNotHeld) {
  const std::int64_t before = browsers().server().residentBytes();
  {
    WebSocketClient announced(browsers().port());
    announced.send(kBinary, std::string(1000, 'x'), true, std::uint64_t(1) << 30U);
    WebSocketClient stranger(browsers().port());
    stranger.send(kBinary, std::string(70'000, 'x'));
    const Arrived end = lastOf(stranger);
    EXPECT_EQ(end.closeCode(), 1009);
    EXPECT_THAT(end.closeReason(), HasSubstr("65536 bytes, the most before a good token was shown"));
    PageClient known(browsers().port());
    web::v1::ToServer large;
    large.set_call(known.begin("SceneService/ApplyEdit"));
    large.set_message(std::string(900'000, '\n'));
    known.say(large);
    EXPECT_EQ(known.endOf(large.call()).code(), int(StatusCode::INVALID_ARGUMENT)) << "as far as it is no message";
    large.set_message(std::string(1'100'000, 'x'));
    known.say(large);
    while (known.pump()) {
    }
    EXPECT_EQ(known.closed()->closeCode(), 1009);
    EXPECT_LT(browsers().server().residentBytes() - before, 64 * kMiB);
  }
  EXPECT_GE(browsers().refused("size"), 2.0);
}

TEST(WebDoor, WhoSaysNothingDoesNotStay) {
  Browsers hasty({"--first-message", "1"});
  WebSocketClient silent(hasty.port());
  WebSocketClient half(hasty.port());
  half.send(kBinary, "x", false);
  for (WebSocketClient* each : {&silent, &half}) {
    const Arrived end = lastOf(*each);
    EXPECT_EQ(end.closeCode(), 1008);
    EXPECT_THAT(end.closeReason(), HasSubstr("first_message: no hello came within 1 s"));
  }
  EXPECT_EQ(hasty.refused("first_message"), 2.0);
}

TEST(WebDoor, SocketsWithoutATokenAreCounted) {
  Browsers door({"--trusted-proxy", "none"});
  std::vector<std::unique_ptr<WebSocketClient>> silent;
  for (int i = 0; i < 32; ++i) {
    silent.push_back(std::make_unique<WebSocketClient>(door.port()));
    EXPECT_EQ(silent.back()->status(), 101) << i;
  }
  const WebSocketClient more(door.port());
  EXPECT_EQ(more.status(), 429);
  EXPECT_THAT(more.answer(), HasSubstr("this address has 32 sockets"));
  // Whoever has said hello to a server without tokens has no place among them.
  silent[0]->send(kBinary, helloBytes());
  EXPECT_EQ(silent[0]->receive().opcode, kBinary);
  EXPECT_EQ(WebSocketClient(door.port()).status(), 101);
  silent.clear();
  EXPECT_TRUE(eventually([&] { return WebSocketClient(door.port()).status() == 101; }));
}

TEST(WebDoor, CertificatesAreTakenUpWhenTheyChange) {
  const Authority first("first authority"), second("second authority");
  const CertificateFiles old = first.issue("old");
  const CertificateFiles fresh = second.issue("fresh");
  const auto put = [&](const std::string& from, const std::string& to) {
    std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing);
  };
  const std::string certificate = first.folder() + "/now.pem", key = first.folder() + "/now.key";
  put(old.certificate, certificate);
  put(old.key, key);
  Browsers secured({"--tls-cert", certificate, "--tls-key", key});
  const auto opens = [&](const Authority& trusted) {
    return WebSocketClient(secured.port(), {.authority = trusted.file()}).status() == 101;
  };
  EXPECT_TRUE(opens(first));
  EXPECT_FALSE(opens(second));
  PageClient stays(secured.port(), {}, {.authority = first.file()});
  put(fresh.certificate, certificate);
  put(fresh.key, key);
  EXPECT_TRUE(eventually([&] { return opens(second); }));
  EXPECT_FALSE(opens(first));
  pb::GetServerInfoResponse info;
  EXPECT_EQ(stays.call("ServerService/GetServerInfo", pb::GetServerInfoRequest(), &info).code(), 0)
      << "open sockets stay";
}

// Broken by: an end of TCP alone, which strict clients take for an answer that was cut off.
TEST(WebDoor, AnswersOverTlsEndAsTlsDoes) {
  const Authority authority("authority");
  const CertificateFiles files = authority.issue("files");
  Browsers secured({"--tls-cert", files.certificate, "--tls-key", files.key});
  WebSocketClient refused(secured.port(), {.origin = "https://evil.example", .authority = authority.file()});
  EXPECT_EQ(refused.status(), 403);
  EXPECT_TRUE(refused.endsInOrder());
}

/// Sends as fast as the server takes, until it is told to stop or is cut off.
class Flood {
 public:
  Flood(int port, const std::string& frame, bool reads) : client_(port) {
    client_.send(kBinary, helloBytes());
    timeval patience{0, 200'000};
    setsockopt(client_.socket(), SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    writer_ = std::thread([this, frame] {
      while (!stopping_) sent_ += int(client_.send(kBinary, frame));
    });
    if (reads) {
      reader_ = std::thread([this] {
        while (!stopping_ && client_.receive().opcode != 0) {
        }
      });
    }
  }
  ~Flood() {
    stopping_ = true;
    shutdown(client_.socket(), SHUT_RDWR);
    writer_.join();
    if (reader_.joinable()) reader_.join();
  }
  int sent() const { return sent_; }

 private:
  WebSocketClient client_;
  std::atomic<bool> stopping_{false};
  std::atomic<int> sent_{0};
  std::thread writer_, reader_;
};

// Two floods of small messages, one of which never reads its answers, a gigabyte that is announced, and silent sockets:
// others' calls go on. Broken by: reading on although nothing is taken, which holds gigabytes.
TEST(WebDoor, AttacksCostTheirOwnSocketsOnly) {
  Browsers door;
  Stubs stubs(door.server().address());
  Bystander bystander(stubs.channel, makeLitSession(stubs));
  std::this_thread::sleep_for(std::chrono::seconds(1));
  const std::int64_t before = door.server().residentBytes();
  door.server().forgetPeak();
  (void)bystander.take();
  int sent = 0;
  {
    std::vector<std::unique_ptr<WebSocketClient>> silent;
    for (int i = 0; i < 100; ++i) silent.push_back(std::make_unique<WebSocketClient>(door.port()));
    silent[0]->send(kBinary, "x", true, std::uint64_t(1) << 30U);
    const Flood deaf(door.port(), helloBytes(), false);
    const Flood chatty(door.port(), helloBytes(), true);
    std::this_thread::sleep_for(std::chrono::seconds(std::getenv("LPV_ATTACK_SECONDS") ? 30 : 3));
    sent = deaf.sent() + chatty.sent();
  }
  const Calls calls = bystander.take();
  std::printf("%d messages; others: p95 %.1f ms of %zu calls, %d failed; memory %lld MB more at most\n", sent,
              calls.percentile(0.95), calls.milliseconds.size(), calls.failed,
              (long long)((door.server().peakBytes() - before) / 1'000'000));
  EXPECT_GT(sent, 10'000);
  EXPECT_EQ(calls.failed, 0) << calls.lastError;
  EXPECT_GT(calls.milliseconds.size(), 10U);
  if (!kSanitized) {
    EXPECT_LT(door.server().peakBytes() - before, 64 * kMiB);
  }
  EXPECT_TRUE(eventually([&] { return door.watched().metric("lpv_web_sockets") == 0.0; }));
}

// Pages that vanish in the midst of what they say, time and again: the server goes on. Broken by: a message that has
// come being read although writing has found the page gone, which ended the server.
TEST(WebDoor, PagesThatVanishWhileTheyTalkAreOnlyGone) {
  Browsers door;
  for (int i = 0; i < 100; ++i) {
    std::vector<std::unique_ptr<Flood>> floods;
    for (int k = 0; k < 8; ++k) floods.push_back(std::make_unique<Flood>(door.port(), helloBytes(), k % 2 == 0));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(WebSocketClient(door.port()).status(), 101);
  EXPECT_TRUE(eventually([&] { return door.watched().metric("lpv_web_sockets") == 0.0; }));
}

/// A texture of 12 MiB.
std::string largeTexture() {
  pb::Texture texture;
  texture.set_width(2048);
  texture.set_height(2048);
  texture.set_format(pb::TEXTURE_FORMAT_RGB8_SRGB);
  texture.set_texels(std::string(3 * 2048 * 2048, 'x'));
  return texture.SerializeAsString();
}

// A page that ends its side while answers wait for it: its socket goes, with those that wait behind what was being
// written. Broken by: dropping them only where nothing was being written when the socket went, which kept both for
// ever.
TEST(WebDoor, WhoLeavesWithAnswersWaitingIsForgotten) {
  Browsers door;
  Stubs stubs(door.server().address());
  pb::ReadBlobRequest read;
  read.set_session(makeLitSession(stubs));
  pb::UploadBlobResponse blob;
  ASSERT_THAT(upload(stubs, read.session(), pb::BLOB_KIND_TEXTURE, largeTexture(), &blob), IsOk());
  read.set_hash(blob.hash());
  PageClient page(door.port());
  for (int i = 0; i < 40; ++i) {  // a MiB of each is on its way, more than the kernel holds for who reads nothing
    const std::uint32_t call = page.begin("BlobService/ReadBlob");
    page.message(call, read);
    page.end(call);
  }
  const auto open = [&] { return door.watched().metric("lpv_web_sockets"); };
  EXPECT_EQ(open(), 1.0);
  std::this_thread::sleep_for(std::chrono::seconds(2));
  shutdown(page.socket().socket(), SHUT_WR);
  EXPECT_TRUE(eventually([&] { return open() == 0.0; }));
}

}  // namespace
}  // namespace lpv::rpc
