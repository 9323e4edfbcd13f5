// The only file that includes Boost.Beast's WebSockets: they take a minute to compile.

#include "web/door.h"

#include <algorithm>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "api/call/address_limit.h"
#include "api/call/connections.h"
#include "api/call/listener.h"
#include "base/mutex.h"
#include "web/house.h"
#include "web/streams.h"
#include "web/visit.h"

namespace lpv::web_door {
namespace {

constexpr int kThreads = 2;

std::string textOf(const net::ip::address& address) {
  if (address.is_v6() && address.to_v6().is_v4_mapped())
    return net::ip::make_address_v4(net::ip::v4_mapped, address.to_v6()).to_string();
  return address.to_string();
}

/// As gRPC writes a peer.
std::string peerOf(const Tcp::endpoint& end) {
  const std::string address = textOf(end.address());
  const std::string port = ":" + std::to_string(end.port());
  return address.find(':') == std::string::npos ? "ipv4:" + address + port : "ipv6:%5B" + address + "%5D" + port;
}

std::string addressOf(const Tcp::endpoint& end) {
  const std::string address = textOf(end.address());
  const std::string port = ":" + std::to_string(end.port());
  return address.find(':') == std::string::npos ? address + port : "[" + address + "]" + port;
}

bool isLoopback(const net::ip::address& address) {
  if (address.is_v6() && address.to_v6().is_v4_mapped())
    return net::ip::make_address_v4(net::ip::v4_mapped, address.to_v6()).is_loopback();
  return address.is_loopback();
}

/// What OpenSSL makes of the files.
Expected<std::shared_ptr<ssl::context>> contextOf(const tls::PemFiles& files) {
  auto out = std::make_shared<ssl::context>(ssl::context::tls_server);
  Error error;
  out->set_options(ssl::context::default_workarounds | ssl::context::no_tlsv1 | ssl::context::no_tlsv1_1, error);
  if (!error) out->use_certificate_chain(net::buffer(files.certificate), error);
  if (!error) out->use_private_key(net::buffer(files.key), ssl::context::pem, error);
  if (!error && !files.clientAuthorities.empty()) {
    out->add_certificate_authority(net::buffer(files.clientAuthorities), error);
    if (!error) out->set_verify_mode(ssl::verify_peer | ssl::verify_fail_if_no_peer_cert, error);
  }
  if (error) return invalid("tls-cert", "the TLS files cannot be used for browsers: " + error.message());
  return out;
}

}  // namespace

class Door::Parts {
 public:
  Parts(const api::Context& context, DoorOptions options)
      : house_{context, std::move(options.origins), std::move(options.files)}, certificates_(options.certificates) {}
  ~Parts() { shutdown(std::chrono::milliseconds(0)); }

  Status open(const std::string& address);
  int port() const { return listener_->port(); }
  void shutdown(std::chrono::milliseconds patience);

 private:
  void welcome(int file);
  void each(void (Guest::*what)()) {
    for (const auto& guest : house_.guests.all()) (guest.get()->*what)();
  }

  House house_;
  tls::Follower* const certificates_;
  Mutex mutex_;
  std::shared_ptr<ssl::context> tls_ LPV_GUARDED_BY(mutex_);  ///< for connections that come now; null: plain text
  std::shared_ptr<void> following_;
  net::io_context io_{kThreads};
  net::executor_work_guard<net::io_context::executor_type> work_{io_.get_executor()};
  std::vector<std::thread> threads_;
  std::unique_ptr<api::Listener> listener_;
};

Status Door::Parts::open(const std::string& address) {
  Expected<std::unique_ptr<api::Listener>> listener = api::Listener::bind("web", address);
  if (!listener) return listener.status();
  listener_ = std::move(*listener);
  if (certificates_ != nullptr) {
    Expected<std::shared_ptr<void>> following = certificates_->use([this](const tls::PemFiles& files) -> Status {
      Expected<std::shared_ptr<ssl::context>> made = contextOf(files);
      if (!made) return made.status();
      const MutexLock lock(mutex_);
      tls_ = std::move(*made);
      return {};
    });
    if (!following) return following.status();
    following_ = std::move(*following);
  }
  for (int i = 0; i < kThreads; ++i) threads_.emplace_back([this] { io_.run(); });
  listener_->start(house_.context.addresses, [this](int, int file) { welcome(file); });
  return {};
}

/// On the listener's thread.
void Door::Parts::welcome(int file) {
  Tcp::socket socket(net::make_strand(io_));
  Error error;
  const bool v4 = api::familyOf(file) == AF_INET;
  socket.assign(v4 ? Tcp::v4() : Tcp::v6(), file, error);
  const Tcp::endpoint from = error ? Tcp::endpoint() : socket.remote_endpoint(error);
  const Tcp::endpoint to = error ? Tcp::endpoint() : socket.local_endpoint(error);
  if (error) return;
  const std::string peer = peerOf(from);
  const std::string address = api::addressOf(peer);
  const api::AddressLimit* limit = house_.context.addresses.get();
  Arrival arrival{.peer = peer,
                  .network = api::networkOf(address),
                  .shared = limit == nullptr || limit->exempts(address),
                  .local = {addressOf(to), isLoopback(to.address()), certificates_ != nullptr}};
  std::shared_ptr<ssl::context> tls;
  {
    const MutexLock lock(mutex_);
    tls = tls_;
  }
  const auto strand = socket.get_executor();
  if (tls) {
    auto visit = std::make_shared<Visit<Secured>>(Secured(std::move(socket), *tls), house_, std::move(arrival));
    net::post(strand, [visit] { visit->start(); });
  } else {
    auto visit = std::make_shared<Visit<Plain>>(Plain(std::move(socket)), house_, std::move(arrival));
    net::post(strand, [visit] { visit->start(); });
  }
}

void Door::Parts::shutdown(std::chrono::milliseconds patience) {
  if (threads_.empty()) return;
  listener_->stop();
  following_.reset();
  const Clock::time_point deadline = Clock::now() + patience;
  while (Clock::now() < deadline) {
    each(&Guest::leaveIfIdle);
    if (house_.guests.waitEmpty(std::min(deadline, Clock::now() + std::chrono::milliseconds(20)))) break;
  }
  each(&Guest::leave);
  if (!house_.guests.waitEmpty(Clock::now() + kCloseTime)) each(&Guest::cut);
  // Calls that complete anyway are waited for, as the gRPC door does.
  while (!house_.guests.waitEmpty(Clock::now() + std::chrono::seconds(1))) each(&Guest::cut);
  work_.reset();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

Door::Door(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Door::~Door() = default;

Expected<std::unique_ptr<Door>> Door::open(const api::Context& context, DoorOptions options) {
  const std::string address = options.address;
  auto parts = std::make_unique<Parts>(context, std::move(options));
  if (Status s = parts->open(address); !s.ok()) return s;
  return std::unique_ptr<Door>(new Door(std::move(parts)));
}

int Door::port() const { return parts_->port(); }

void Door::shutdown(std::chrono::milliseconds patience) { parts_->shutdown(patience); }

}  // namespace lpv::web_door
