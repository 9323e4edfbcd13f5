#include "rpc/support/tcp_proxy.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <utility>
#include <vector>

namespace lpv::rpc {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kRoom = std::size_t(4) << 20U;       // bytes on their way in one direction
constexpr std::size_t kRoomHeld = std::size_t(64) << 10U;  // while nothing arrives
constexpr std::size_t kRead = std::size_t(64) << 10U;

sockaddr_in loopback(int port) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_port = htons(std::uint16_t(port));
  out.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return out;
}

void prepare(int socket) {
  const int on = 1;
  setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  fcntl(socket, F_SETFL, fcntl(socket, F_GETFL) | O_NONBLOCK);
}

/// A connection, or -1.
int connectTo(int port) {
  if (port == 0) return -1;
  const int out = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_in to = loopback(port);
  if (connect(out, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) {
    prepare(out);
    return out;
  }
  ::close(out);
  return -1;
}

bool wouldBlock() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

/// Reads what has come; false where the connection is broken.
template <typename Lane>
bool receive(Lane& lane, std::size_t room, std::chrono::milliseconds delay, double rate) {
  std::array<char, kRead> buffer{};
  while (!lane.ended && lane.size < room) {
    const ssize_t count = recv(lane.from, buffer.data(), buffer.size(), 0);
    if (count < 0) return wouldBlock();
    lane.ended = count == 0;
    if (count == 0) break;
    lane.freeAt = std::max(lane.freeAt, Clock::now());
    if (rate > 0.0) {
      lane.freeAt += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(double(count) / rate));
    }
    lane.chunks.push_back({lane.freeAt + delay, std::string(buffer.data(), std::size_t(count)), 0});
    lane.size += std::size_t(count);
  }
  return true;
}

/// Sends what is due; false where the connection is broken.
template <typename Lane>
bool deliver(Lane& lane) {
  while (!lane.chunks.empty() && lane.chunks.front().due <= Clock::now()) {
    auto& chunk = lane.chunks.front();
    const ssize_t count = send(lane.to, chunk.bytes.data() + chunk.sent, chunk.bytes.size() - chunk.sent, MSG_NOSIGNAL);
    if (count < 0) return wouldBlock();
    chunk.sent += std::size_t(count);
    lane.size -= std::size_t(count);
    if (chunk.sent == chunk.bytes.size()) lane.chunks.pop_front();
  }
  if (lane.ended && lane.chunks.empty() && !lane.passedOn) {
    shutdown(lane.to, SHUT_WR);
    lane.passedOn = true;
  }
  return true;
}

}  // namespace

TcpProxy::TcpProxy(int target) {
  settings_.target = target;
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  sockaddr_in here = loopback(0);
  socklen_t size = sizeof here;
  if (bind(listener_, reinterpret_cast<const sockaddr*>(&here), size) != 0 || listen(listener_, SOMAXCONN) != 0 ||
      getsockname(listener_, reinterpret_cast<sockaddr*>(&here), &size) != 0) {
    throw std::runtime_error("the proxy cannot listen on the loopback");
  }
  prepare(listener_);
  port_ = ntohs(here.sin_port);
  thread_ = std::thread([this] { run(); });
}

TcpProxy::~TcpProxy() {
  change([](Settings& settings) { settings.stopping = true; });
  thread_.join();
  for (Connection& connection : connections_) close(connection, true);
  for (Connection& connection : lost_) close(connection, true);
  ::close(listener_);
  ::close(wake_);
}

template <typename Change>
void TcpProxy::change(Change how) {
  {
    const std::lock_guard lock(mutex_);
    how(settings_);
  }
  eventfd_write(wake_, 1);
}

void TcpProxy::setTarget(int port) {
  change([port](Settings& settings) { settings.target = port; });
}
void TcpProxy::setDelay(std::chrono::milliseconds oneWay) {
  change([oneWay](Settings& settings) { settings.delay = oneWay; });
}
void TcpProxy::setAnswerRate(double bytesPerSecond) {
  change([bytesPerSecond](Settings& settings) { settings.answerRate = bytesPerSecond; });
}
void TcpProxy::holdRequests(bool hold) {
  change([hold](Settings& settings) { settings.holdRequests = hold; });
}
void TcpProxy::holdAnswers(bool hold) {
  change([hold](Settings& settings) { settings.holdAnswers = hold; });
}
void TcpProxy::cut() {
  change([](Settings& settings) { settings.cut = true; });
}

void TcpProxy::lose() {
  change([](Settings& settings) { settings.lose = true; });
}

/// The settings now; a cut is done once, and so is a loss.
TcpProxy::Settings TcpProxy::take() {
  const std::lock_guard lock(mutex_);
  Settings out = settings_;
  settings_.cut = settings_.lose = false;
  return out;
}

void TcpProxy::run() {
  while (true) {
    const Settings settings = take();
    if (settings.stopping) return;
    if (settings.cut) {
      for (Connection& connection : connections_) close(connection, true);
      connections_.clear();
    }
    if (settings.lose) lost_.splice(lost_.end(), connections_);
    accept(settings);
    for (Connection& connection : connections_) move(connection, settings);
    connections_.remove_if([](Connection& connection) {
      const bool over = connection.requests.passedOn && connection.answers.passedOn;
      if (connection.broken || over) close(connection, connection.broken);
      return connection.broken || over;
    });
    wait(settings);
  }
}

void TcpProxy::accept(const Settings& settings) {
  while (true) {
    const int client = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (client < 0) return;
    prepare(client);
    const int server = connectTo(settings.target);
    if (server < 0) {
      ::close(client);
      continue;
    }
    Connection& connection = connections_.emplace_back();
    connection.requests.from = connection.answers.to = client;
    connection.requests.to = connection.answers.from = server;
  }
}

void TcpProxy::move(Connection& connection, const Settings& settings) {
  const auto one = [&](Lane& lane, bool held, double rate) {
    const bool alive = receive(lane, held ? kRoomHeld : kRoom, settings.delay, rate) && (held || deliver(lane));
    connection.broken = connection.broken || !alive;
  };
  one(connection.requests, settings.holdRequests, 0.0);
  one(connection.answers, settings.holdAnswers, settings.answerRate);
}

/// Until something can be read or written, is due, or was asked for.
void TcpProxy::wait(const Settings& settings) {
  std::vector<pollfd> fds{{listener_, POLLIN, 0}, {wake_, POLLIN, 0}};
  const Clock::time_point now = Clock::now();
  Clock::time_point next = Clock::time_point::max();
  const auto watch = [&](const Lane& lane, bool held) {
    if (!lane.ended && lane.size < (held ? kRoomHeld : kRoom)) fds.push_back({lane.from, POLLIN, 0});
    if (held || lane.chunks.empty()) return;
    if (lane.chunks.front().due <= now) fds.push_back({lane.to, POLLOUT, 0});
    if (lane.chunks.front().due > now) next = std::min(next, lane.chunks.front().due);
  };
  for (const Connection& connection : connections_) {
    watch(connection.requests, settings.holdRequests);
    watch(connection.answers, settings.holdAnswers);
  }
  int patience = -1;
  if (next != Clock::time_point::max()) {
    patience = int(std::chrono::ceil<std::chrono::milliseconds>(next - now).count());
  }
  poll(fds.data(), nfds_t(fds.size()), patience);
  eventfd_t ignored = 0;
  eventfd_read(wake_, &ignored);
}

/// With a reset where bytes may be lost.
void TcpProxy::close(Connection& connection, bool reset) {
  const linger hard{1, 0};
  for (const int socket : {connection.requests.from, connection.requests.to}) {
    if (reset) setsockopt(socket, SOL_SOCKET, SO_LINGER, &hard, sizeof hard);
    ::close(socket);
  }
}

}  // namespace lpv::rpc
