#include "web/origins.h"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <utility>
#include <vector>

#include "base/text.h"

namespace lpv::web_door {
namespace {

constexpr const char* kFlag = "web-origins";

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

/// Quoted for a message, without what a terminal would act on.
std::string shown(const std::string& text) { return "\"" + withHiddenEscaped(truncatedUtf8(text)) + "\""; }

/// The host without the scheme's default port.
std::string withoutDefaultPort(std::string host, bool tls) {
  const std::string port = tls ? ":443" : ":80";
  if (host.ends_with(port)) host.resize(host.size() - port.size());
  return host;
}

std::string schemeOf(bool tls) { return tls ? "https://" : "http://"; }

/// What the door is called where nothing is listed.
std::vector<std::string> ownHosts(const Origins::Local& local) {
  std::vector<std::string> out{withoutDefaultPort(local.address, local.tls)};
  const std::string port = local.address.substr(local.address.rfind(':'));
  if (local.loopback) {
    for (const char* name : {"localhost", "127.0.0.1", "[::1]"})
      out.push_back(withoutDefaultPort(name + port, local.tls));
  }
  return out;
}

bool isHost(const std::string& text) { return !text.empty() && text.find_first_of("/?#@ \t\"\\") == std::string::npos; }

}  // namespace

Expected<Origins> Origins::read(const std::string& listed) {
  Origins out;
  std::istringstream list(listed);
  for (std::string each; std::getline(list, each, ',');) {
    each.erase(0, each.find_first_not_of(" \t"));
    each.erase(each.find_last_not_of(" \t") + 1);
    each = lower(each);
    const bool tls = each.starts_with("https://");
    const bool plain = each.starts_with("http://");
    const std::string host = tls || plain ? each.substr(schemeOf(tls).size()) : std::string();
    if (!isHost(host)) {
      return invalid(kFlag, std::string("--") + kFlag + ": " + shown(each) +
                                " is no origin; give scheme and host, as in https://light.example.org or "
                                "http://10.0.0.5:8080, with commas between several");
    }
    out.hosts_.insert(withoutDefaultPort(host, tls));
    out.origins_.insert(schemeOf(tls) + withoutDefaultPort(host, tls));
  }
  return out;
}

Status Origins::checkHost(const std::string& host, const Local& local) const {
  const std::string canonical = lower(host);
  const std::vector<std::string> own = ownHosts(local);
  for (const bool tls : {true, false}) {
    const std::string name = withoutDefaultPort(canonical, tls);
    if (hosts_.contains(name) || (tls == local.tls && std::find(own.begin(), own.end(), name) != own.end())) return {};
  }
  return {Code::kPermissionDenied,
          "Host " + shown(host) + " is no name of this server; allowed are " + own.front() +
              " and the hosts of --web-origins",
          "host"};
}

Status Origins::checkOrigin(const std::string& origin, const Local& local) const {
  const std::string canonical = lower(origin);
  const bool tls = canonical.starts_with("https://");
  const std::string name = withoutDefaultPort(canonical, tls);
  if (origins_.contains(name)) return {};
  for (const std::string& host : ownHosts(local)) {
    if (name == schemeOf(local.tls) + host) return {};
  }
  return {Code::kPermissionDenied,
          (origin.empty() ? "no Origin header is there" : "Origin " + shown(origin) + " is not allowed") +
              "; pages of " + schemeOf(local.tls) + ownHosts(local).front() + " may call, and those of --web-origins",
          "origin"};
}

}  // namespace lpv::web_door
