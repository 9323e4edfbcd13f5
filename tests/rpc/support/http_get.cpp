#include "rpc/support/http_get.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdlib>

namespace lpv::rpc {
namespace {

constexpr timeval kPatience{20, 0};

/// All that comes back; empty where nobody is there.
std::string requestOn(int port, const std::string& request) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &kPatience, sizeof kPatience);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(std::uint16_t(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string out;
  if (connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
      send(socket, request.data(), request.size(), MSG_NOSIGNAL) == ssize_t(request.size())) {
    std::array<char, 4096> buffer{};
    for (ssize_t n = 0; (n = recv(socket, buffer.data(), buffer.size(), 0)) > 0;)
      out.append(buffer.data(), std::size_t(n));
  }
  close(socket);
  return out;
}

}  // namespace

HttpAnswer httpGet(int port, const std::string& path) {
  const std::string all = requestOn(port, "GET " + path + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  HttpAnswer out;
  const std::string version = "HTTP/1.1 ";
  const std::size_t end = all.find("\r\n\r\n");
  if (!all.starts_with(version) || end == std::string::npos) return out;
  out.status = std::atoi(all.c_str() + version.size());
  const std::string name = "Content-Type: ";
  const std::size_t type = all.find(name);
  if (type < end) out.type = all.substr(type + name.size(), all.find("\r\n", type) - type - name.size());
  out.body = all.substr(end + 4);
  return out;
}

}  // namespace lpv::rpc
