// How lpv_client comes by its connection.

#include <arpa/inet.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <thread>

#include "rpc/support/rpc.h"

namespace lpv::rpc {
namespace {

/// A port of the loopback on which nobody listens: bound, so that the system gives it to nobody else, but to a server
/// that shares it, as gRPC's do.
class QuietPort {
 public:
  QuietPort() : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    const int yes = 1;
    sockaddr_in bound{};
    bound.sin_family = AF_INET;
    bound.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof bound;
    EXPECT_EQ(setsockopt(socket_, SOL_SOCKET, SO_REUSEPORT, &yes, sizeof yes), 0);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&bound), size), 0);
    EXPECT_EQ(getsockname(socket_, reinterpret_cast<sockaddr*>(&bound), &size), 0);
    address = "127.0.0.1:" + std::to_string(ntohs(bound.sin_port));
  }
  ~QuietPort() { close(socket_); }
  QuietPort(const QuietPort&) = delete;
  QuietPort& operator=(const QuietPort&) = delete;

  std::string address;

 private:
  int socket_;
};

// The first attempt is refused, a later one is not; what answers has none of lpvd's calls. Broken by: calls that end
// with the first attempt to connect.
TEST(Connection, ServersThatAreAboutToListenAreReached) {
  const QuietPort port;
  client::Client client = clientOf(port.address);
  auto answer = std::async(std::launch::async, [&client] { return client.serverInfo().status().code(); });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  pb::ResultService::Service service;
  const std::unique_ptr<grpc::Server> server = grpc::ServerBuilder()
                                                   .AddListeningPort(port.address, grpc::InsecureServerCredentials())
                                                   .RegisterService(&service)
                                                   .BuildAndStart();
  ASSERT_NE(server, nullptr);
  EXPECT_EQ(answer.get(), Code::kUnimplemented);
}

TEST(Connection, NobodyListens) {
  const QuietPort port;
  EXPECT_EQ(clientOf(port.address).serverInfo().status().code(), Code::kUnavailable);
}

}  // namespace
}  // namespace lpv::rpc
