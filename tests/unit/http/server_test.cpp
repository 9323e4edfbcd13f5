// The HTTP server: what it answers, and that clients cannot hold it up. The clients are plain sockets.

#include "http/server.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <future>
#include <thread>
#include <utility>
#include <vector>

namespace lpv::http {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;
using namespace std::chrono_literals;

constexpr timeval kPatience{60, 0};  // ends a hang

/// A connection to 127.0.0.1.
class Socket {
 public:
  explicit Socket(int port, int receiveBytes = 0) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &kPatience, sizeof kPatience);
    if (receiveBytes > 0) setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receiveBytes, sizeof receiveBytes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(std::uint16_t(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  Socket(Socket&& other) noexcept : socket_(std::exchange(other.socket_, -1)), connected_(other.connected_) {}
  Socket& operator=(Socket&&) = delete;
  ~Socket() {
    if (socket_ >= 0) close(socket_);
  }

  bool connected() const { return connected_; }
  bool send(const std::string& text) const {
    return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == ssize_t(text.size());
  }
  /// All until the server closes.
  std::string rest() const {
    std::string out;
    std::array<char, 4096> buffer{};
    for (ssize_t n = 0; (n = recv(socket_, buffer.data(), buffer.size(), 0)) > 0;)
      out.append(buffer.data(), std::size_t(n));
    return out;
  }

 private:
  int socket_;
  bool connected_ = false;
};

std::string get(const std::string& path) { return "GET " + path + " HTTP/1.1\r\nHost: here\r\n\r\n"; }

std::string ask(const Server& server, const std::string& request) {
  const Socket socket(server.port());
  EXPECT_TRUE(socket.send(request));
  return socket.rest();
}

std::unique_ptr<Server> serve(std::map<std::string, Handler> paths, const Limits& limits = {}) {
  Expected<std::unique_ptr<Server>> made = Server::open({"127.0.0.1", 0}, std::move(paths), limits);
  EXPECT_TRUE(made.ok()) << made.status().message();
  return std::move(*made);
}

Handler hello() {
  return [](const Request&) { return Answer{200, "text/plain", "hello\n"}; };
}

TEST(HttpServer, AnswersByPath) {
  const auto server = serve({{"/hello", hello()}, {"/query", [](const Request& request) {
                                                     return Answer{503, "text/x", request.path + "|" + request.query};
                                                   }}});
  EXPECT_THAT(ask(*server, get("/hello")),
              AllOf(StartsWith("HTTP/1.1 200 OK\r\n"), HasSubstr("\r\nContent-Length: 6\r\n"),
                    HasSubstr("\r\nConnection: close\r\n"), HasSubstr("\r\nCache-Control: no-store\r\n"),
                    EndsWith("\r\n\r\nhello\n")));
  EXPECT_THAT(
      ask(*server, get("/query?a=b?c")),
      AllOf(StartsWith("HTTP/1.1 503 "), HasSubstr("Content-Type: text/x\r\n"), EndsWith("\r\n\r\n/query|a=b?c")));
  for (const char* path : {"/", "/hello/on", "/hell", "/../hello"})
    EXPECT_THAT(ask(*server, get(path)), StartsWith("HTTP/1.1 404 ")) << path;
  EXPECT_THAT(ask(*server, "HEAD /hello HTTP/1.1\r\n\r\n"),
              AllOf(HasSubstr("Content-Length: 6\r\n"), EndsWith("\r\n\r\n")));
  EXPECT_THAT(ask(*server, "POST /hello HTTP/1.1\r\nContent-Length: 0\r\n\r\n"),
              AllOf(StartsWith("HTTP/1.1 405 "), HasSubstr("\r\nAllow: GET, HEAD\r\n")));
}

TEST(HttpServer, RefusesWhatIsTooLongOrNoHttp) {
  const auto server = serve({{"/hello", hello()}}, {.headerBytes = 1000, .bodyBytes = 10});
  const std::string body = "GET /hello HTTP/1.1\r\nContent-Length: ";
  EXPECT_THAT(ask(*server, body + "10\r\n\r\n0123456789"), StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(ask(*server, body + "11\r\n\r\n0123456789a"), StartsWith("HTTP/1.1 413 "));
  EXPECT_THAT(ask(*server, get("/" + std::string(2000, 'x'))), StartsWith("HTTP/1.1 431 "));
  EXPECT_THAT(ask(*server, "\x16\x03\x01 this is something else\r\n\r\n"), StartsWith("HTTP/1.1 400 "));
}

/// Connections that never send a whole request.
std::vector<Socket> idle(const Server& server, int count, const std::string& sent = {}) {
  std::vector<Socket> out;
  for (int i = 0; i < count; ++i) {
    out.emplace_back(server.port());
    EXPECT_TRUE(out.back().send(sent));
  }
  return out;
}

/// The limit of a test that is to end by an answer and not by a time limit.
constexpr Limits kPatient{.request = 1h, .answer = 1h};

// Broken by: a thread per connection; refusing the newest connection.
TEST(HttpServer, IdleConnectionsHoldNobodyUp) {
  rlimit files{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &files), 0);
  files.rlim_cur = std::min<rlim_t>(files.rlim_max, 4096);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &files), 0);
  const auto server = serve({{"/hello", hello()}}, kPatient);
  const auto few = idle(*server, 16);
  EXPECT_THAT(ask(*server, get("/hello")), EndsWith("hello\n"));
  const auto many = idle(*server, 1000, "GET /hello HTTP/1.1\r\n");
  EXPECT_TRUE(many.back().connected());
  EXPECT_THAT(ask(*server, get("/hello")), EndsWith("hello\n"));
  EXPECT_EQ(many.front().rest(), "") << "the oldest gave way";
}

// Broken by: a time limit for every read, which a trickle of bytes never meets.
TEST(HttpServer, ARequestThatTakesTooLongIsCutOff) {
  const auto server = serve({{"/hello", hello()}}, {.request = 200ms});
  const Socket silent(server->port());
  EXPECT_EQ(silent.rest(), "");
  const Socket trickle(server->port());
  while (trickle.send("x")) std::this_thread::sleep_for(20ms);
  SUCCEED() << "the loop ends";
}

TEST(HttpServer, AnAnswerThatIsNotReadIsCutOff) {
  const std::string large(64 << 20, 'x');
  const std::map<std::string, Handler> paths{{"/large", [&](const Request&) {
                                                return Answer{200, "text/plain", large};
                                              }}};
  const auto server = serve(paths, {.answer = 200ms});
  const Socket slow(server->port(), 4096);
  ASSERT_TRUE(slow.send(get("/large")));
  std::this_thread::sleep_for(1s);
  EXPECT_LT(slow.rest().size(), large.size());
  const auto patient = serve(paths, kPatient);
  EXPECT_GT(ask(*patient, get("/large")).size(), large.size()) << "who reads gets it all";
}

// Broken by: one thread for all handlers.
TEST(HttpServer, AHandlerThatWaitsHoldsUpItsOwnPathOnly) {
  std::promise<void> go;
  std::promise<void> asked;
  const auto server = serve({{"/hello", hello()},
                             {"/waits",
                              [&](const Request&) {
                                asked.set_value();
                                go.get_future().wait();
                                return Answer{200, "text/plain", "waited\n"};
                              }}},
                            kPatient);
  const Socket waiting(server->port());
  ASSERT_TRUE(waiting.send(get("/waits")));
  asked.get_future().wait();
  EXPECT_THAT(ask(*server, get("/hello")), EndsWith("hello\n"));
  go.set_value();
  EXPECT_THAT(waiting.rest(), EndsWith("waited\n"));
}

// Broken by: asking the handler for connections that gave way.
TEST(HttpServer, AFloodOfRequestsCostsTheHandlerNoMoreThanTheOpenConnections) {
  std::promise<void> go;
  std::atomic<int> calls = 0;
  const auto server = serve({{"/hello", hello()},
                             {"/waits",
                              [&, held = go.get_future().share()](const Request&) {
                                held.wait();
                                ++calls;
                                return Answer{};
                              }}},
                            {.connections = 8, .request = 1h, .answer = 1h});
  const auto flood = idle(*server, 200, get("/waits"));
  EXPECT_THAT(ask(*server, get("/hello")), EndsWith("hello\n")) << "all are read, and most were cut off";
  go.set_value();
  EXPECT_THAT(flood.back().rest(), StartsWith("HTTP/1.1 200 "));
  EXPECT_LE(calls, 1 + 8);
}

TEST(HttpServer, EndsWithConnectionsAndRequestsOpen) {
  std::promise<void> asked;
  std::promise<void> go;
  auto server = serve({{"/waits",
                        [&](const Request&) {
                          asked.set_value();
                          go.get_future().wait();
                          return Answer{};
                        }}},
                      kPatient);
  const auto open = idle(*server, 20);
  const auto waiting = idle(*server, 3, get("/waits"));
  asked.get_future().wait();
  const auto ended = std::async(std::launch::async, [&] { server.reset(); });
  EXPECT_EQ(open.front().rest(), "") << "before the handler is done";
  go.set_value();
  ended.wait();
}

TEST(HttpServer, SaysWhyItCannotListen) {
  const auto first = serve({});
  const auto taken = Server::open({"127.0.0.1", first->port()}, {}, {});
  EXPECT_EQ(taken.status().code(), Code::kUnavailable);
  EXPECT_THAT(taken.status().message(), AllOf(HasSubstr("127.0.0.1:"), HasSubstr("in use")));
  EXPECT_FALSE(Server::open({"not.an.address", 0}, {}, {}).ok());
}

}  // namespace
}  // namespace lpv::http
