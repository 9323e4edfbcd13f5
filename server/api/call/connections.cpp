#include "api/call/connections.h"

#include <netinet/in.h>
#include <sys/socket.h>

#include <charconv>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>

#include "api/call/address_limit.h"

namespace lpv::api {
namespace {

std::optional<int> numberIn(const std::string& text) {
  int out = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return out;
}

}  // namespace

std::string remoteAddress(int socket) {
  sockaddr_storage found{};
  socklen_t size = sizeof found;
  if (getpeername(socket, reinterpret_cast<sockaddr*>(&found), &size) != 0) return {};
  if (found.ss_family == AF_INET) {
    return ipv4Address(&reinterpret_cast<const sockaddr_in&>(found).sin_addr);
  }
  if (found.ss_family != AF_INET6) return {};
  const in6_addr& v6 = reinterpret_cast<const sockaddr_in6&>(found).sin6_addr;
  return {reinterpret_cast<const char*>(&v6), sizeof v6};
}

int familyOf(int socket) {
  sockaddr_storage found{};
  socklen_t size = sizeof found;
  return getsockname(socket, reinterpret_cast<sockaddr*>(&found), &size) == 0 ? found.ss_family : 0;
}

void shutDownConnectionsFrom(const std::string& address) {
  const std::string network = networkOf(address);
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", failed)) {
    const std::optional<int> file = numberIn(entry.path().filename());
    if (!file) continue;
    const std::string remote = remoteAddress(*file);
    if (!remote.empty() && networkOf(remote) == network) (void)shutdown(*file, SHUT_RDWR);
  }
}

}  // namespace lpv::api
