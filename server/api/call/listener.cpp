#include "api/call/listener.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include "api/call/address_limit.h"
#include "api/call/connections.h"
#include "base/address.h"

namespace lpv::api {
namespace {

/// After a connection could not be accepted, as where the process has no file descriptors left.
constexpr std::chrono::milliseconds kAcceptPause{50};
/// How long the kernel waits for a client to confirm what was sent, milliseconds: as long as for a keepalive's answer.
constexpr unsigned kUserTimeout = 10'000;

bool isEverywhere(const std::string& host) { return host == "0.0.0.0" || host == "::"; }

/// False, with errno, where an option that matters cannot be set.
bool prepare(int file, const addrinfo& at) {
  constexpr int kOn = 1, kOff = 0;
  if (setsockopt(file, SOL_SOCKET, SO_REUSEADDR, &kOn, sizeof kOn) != 0) return false;
  if (at.ai_family == AF_INET6 && setsockopt(file, IPPROTO_IPV6, IPV6_V6ONLY, &kOff, sizeof kOff) != 0) return false;
  // Accepted sockets have these from the listening one.
  return setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &kOn, sizeof kOn) == 0 &&
         setsockopt(file, IPPROTO_TCP, TCP_USER_TIMEOUT, &kUserTimeout, sizeof kUserTimeout) == 0;
}

/// A listening socket; nothing, with errno, where there can be none.
std::optional<int> listenAt(const addrinfo& at, int port) {
  sockaddr_storage place{};
  std::memcpy(&place, at.ai_addr, at.ai_addrlen);
  // The port is at the same place in both families' addresses.
  reinterpret_cast<sockaddr_in&>(place).sin_port = htons(std::uint16_t(port));
  const int file = socket(at.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (file < 0) return std::nullopt;
  if (prepare(file, at) && ::bind(file, reinterpret_cast<sockaddr*>(&place), at.ai_addrlen) == 0 &&
      listen(file, SOMAXCONN) == 0) {
    return file;
  }
  const int why = errno;
  close(file);
  errno = why;
  return std::nullopt;
}

int portOf(int file) {
  sockaddr_storage place{};
  socklen_t size = sizeof place;
  if (getsockname(file, reinterpret_cast<sockaddr*>(&place), &size) != 0) return 0;
  return ntohs(reinterpret_cast<sockaddr_in&>(place).sin_port);
}

}  // namespace

Status Listener::cannotListen(const std::string& address, const char* why) const {
  return {Code::kUnavailable, "cannot listen on " + address + ": " + why, flag_};
}

Expected<std::unique_ptr<Listener>> Listener::bind(const std::string& flag, const std::string& address) {
  const Expected<HostPort> at = parseHostPort(flag, address);
  if (!at) return at.status();
  std::unique_ptr<Listener> listener(new Listener);
  listener->flag_ = flag;
  Status bound = isEverywhere(at->host) ? listener->bindTo("::", at->port) : Status(Code::kUnavailable, "");
  if (!bound.ok()) bound = listener->bindTo(at->host, at->port);  // 0.0.0.0 also where there is no IPv6
  if (!bound.ok()) return bound;
  return listener;
}

Status Listener::bindTo(const std::string& host, int port) {
  const std::string text = HostPort{host, port}.text();
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int failed = getaddrinfo(host.c_str(), nullptr, &hints, &found); failed != 0) {
    return cannotListen(text, gai_strerror(failed));
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owned(found, freeaddrinfo);
  int why = 0;
  for (const addrinfo* each = found; each != nullptr; each = each->ai_next) {
    const std::optional<int> file = listenAt(*each, port_ != 0 ? port_ : port);
    if (file) {
      listening_.push_back(*file);
      port_ = portOf(*file);
    } else {
      why = errno;
      if (why == EADDRINUSE) return cannotListen(text, std::strerror(why));
    }
  }
  return listening_.empty() ? cannotListen(text, std::strerror(why)) : Status();
}

void Listener::start(std::shared_ptr<const AddressLimit> limit, Take take) {
  limit_ = std::move(limit);
  take_ = std::move(take);
  ending_ = eventfd(0, EFD_CLOEXEC);
  thread_ = std::thread([this] { run(); });
}

void Listener::stop() {
  if (thread_.joinable()) {
    eventfd_write(ending_, 1);
    thread_.join();
    close(ending_);
  }
  for (const int file : listening_) close(file);
  listening_.clear();
}

void Listener::run() {
  std::vector<pollfd> waiting{{ending_, POLLIN, 0}};
  for (const int file : listening_) waiting.push_back({file, POLLIN, 0});
  while (true) {
    (void)poll(waiting.data(), waiting.size(), -1);
    if (waiting[0].revents != 0) return;
    bool room = true;
    for (std::size_t i = 1; i < waiting.size(); ++i) {
      if (waiting[i].revents != 0 && !acceptFrom(waiting[i].fd)) room = false;
    }
    if (!room) std::this_thread::sleep_for(kAcceptPause);
  }
}

/// False where the process can hold no more connections for now.
bool Listener::acceptFrom(int listening) {
  const int file = accept4(listening, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (file < 0) return errno != EMFILE && errno != ENFILE && errno != ENOBUFS && errno != ENOMEM;
  if (limit_ && limit_->banned(remoteAddress(file), Clock::now())) {
    close(file);
  } else {
    take_(listening, file);
  }
  return true;
}

}  // namespace lpv::api
