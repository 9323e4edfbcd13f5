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

/// A port of the loopback on which nobody listens.
int freePort() {
  const int s = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  EXPECT_EQ(bind(s, reinterpret_cast<const sockaddr*>(&address), size), 0);
  EXPECT_EQ(getsockname(s, reinterpret_cast<sockaddr*>(&address), &size), 0);
  close(s);
  return ntohs(address.sin_port);
}

// The first attempt is refused, a later one is not; what answers has none of lpvd's calls. Broken by: calls that end
// with the first attempt to connect.
TEST(Connection, ServersThatAreAboutToListenAreReached) {
  const std::string address = "127.0.0.1:" + std::to_string(freePort());
  client::Client client = clientOf(address);
  auto answer = std::async(std::launch::async, [&client] { return client.serverInfo().status().code(); });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  pb::ResultService::Service service;
  const std::unique_ptr<grpc::Server> server = grpc::ServerBuilder()
                                                   .AddListeningPort(address, grpc::InsecureServerCredentials())
                                                   .RegisterService(&service)
                                                   .BuildAndStart();
  ASSERT_NE(server, nullptr);
  EXPECT_EQ(answer.get(), Code::kUnimplemented);
}

TEST(Connection, NobodyListens) {
  EXPECT_EQ(clientOf("127.0.0.1:" + std::to_string(freePort())).serverInfo().status().code(), Code::kUnavailable);
}

}  // namespace
}  // namespace lpv::rpc
