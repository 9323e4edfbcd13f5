#include "base/address.h"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>

#include "base/text.h"

namespace lpv {
namespace {

constexpr int kMostPort = 65535;

bool isIpv6(const std::string& host) {
  in6_addr address{};
  return inet_pton(AF_INET6, host.c_str(), &address) == 1;
}

bool isIpv4(const std::string& host) {
  in_addr address{};
  return inet_pton(AF_INET, host.c_str(), &address) == 1;
}

/// Letters, digits, dashes and dots (RFC 1123, section 2.1). Numbers with dots are an address or nothing.
bool isName(const std::string& host) {
  const auto allowed = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '.'; };
  const auto numeric = [](unsigned char c) { return std::isdigit(c) != 0 || c == '.'; };
  return !host.empty() && host.size() <= 253 && std::all_of(host.begin(), host.end(), allowed) &&
         !std::all_of(host.begin(), host.end(), numeric);
}

std::optional<int> portOf(const std::string& text) {
  int port = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, port);
  if (error != std::errc() || rest != end || port < 0 || port > kMostPort) return std::nullopt;
  return port;
}

Status wrong(const std::string& flag, const std::string& text, const std::string& what) {
  return invalid(flag, "--" + flag + " is \"" + truncatedUtf8(text) + "\": " + what);
}

}  // namespace

std::string HostPort::text() const {
  return (host.find(':') == std::string::npos ? host : "[" + host + "]") + ":" + std::to_string(port);
}

Expected<HostPort> parseHostPort(const std::string& flag, const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return wrong(flag, text, "the form is HOST:PORT, [IPV6]:PORT or :PORT");
  const std::optional<int> port = portOf(text.substr(colon + 1));
  if (!port)
    return wrong(flag, text, "\"" + truncatedUtf8(text.substr(colon + 1)) + "\" is no port, allowed are 0 to 65535");
  std::string host = text.substr(0, colon);
  if (host.empty()) return HostPort{"127.0.0.1", *port};
  if (host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
    if (isIpv6(host)) return HostPort{host, *port};
    return wrong(flag, text, "\"" + truncatedUtf8(host) + "\" is no IPv6 address");
  }
  if (isIpv6(host))
    return wrong(flag, text, "an IPv6 address stands in brackets, as in [::1]:" + std::to_string(*port));
  if (isIpv4(host) || isName(host)) return HostPort{host, *port};
  return wrong(flag, text, "\"" + truncatedUtf8(host) + "\" is neither an address nor a name");
}

bool isLoopback(const std::string& host) {
  return host == "localhost" || host == "::1" || (isIpv4(host) && host.starts_with("127."));
}

}  // namespace lpv
