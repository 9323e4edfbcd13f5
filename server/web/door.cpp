// The only file that includes Boost.Beast's WebSockets: they take a minute to compile.

#include "web/door.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/version.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <deque>
#include <list>
#include <optional>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "api/call/address_limit.h"
#include "api/call/connections.h"
#include "api/call/listener.h"
#include "base/mutex.h"
#include "session/registry.h"
#include "web/calls.h"
#include "web/places.h"
#include "wire/message_size.h"

namespace lpv::web_door {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace ssl = net::ssl;
namespace websocket = beast::websocket;
using Tcp = net::ip::tcp;
using Error = boost::system::error_code;
using Plain = beast::tcp_stream;
using Secured = beast::ssl_stream<beast::tcp_stream>;

constexpr int kThreads = 2;
/// Connections that are no sockets (yet); one more, and the oldest is cut off.
constexpr std::size_t kMostVisits = 256;
constexpr std::uint32_t kMostHeaderBytes = 8192;
constexpr std::chrono::seconds kHandshakeTime{5};
/// From the end of one answer to the end of the next request.
constexpr std::chrono::seconds kRequestTime{15};
constexpr std::chrono::seconds kAnswerTime{30};
/// A page whose machine has vanished is gone after twice as long.
constexpr std::chrono::seconds kIdleTime{10};
/// A page that does not answer a close is cut off.
constexpr std::chrono::seconds kCloseTime{2};
/// Before a good token was shown.
constexpr std::size_t kMostStrangerBytes = 64 * 1024;
/// A message of a call, and what is around it.
constexpr std::size_t kMostBytes = wire::kMaxMessageBytes + 1024;
/// Messages that wait to be sent. The page is not listened to until it has taken some: its calls have one each, and
/// more than those are answers to what it goes on asking.
constexpr std::size_t kMostQueued = 4 * kMostCalls;

constexpr const char* kText = "text/plain; charset=utf-8";
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
    "connect-src 'self'; worker-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";
constexpr const char* kNoPage =
    "This lpvd was built without its page: npm was missing, or could fetch nothing. Build it where npm is installed,\n"
    "or start it with --web-files DIR, the folder that client/web was built to.\n";

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

std::string_view viewOf(beast::string_view text) { return {text.data(), text.size()}; }

/// Whether a secret stands where addresses are logged and kept.
bool holdsToken(std::string_view query) {
  return query.find("token=") != std::string_view::npos || query.find("lpv_") != std::string_view::npos;
}

WebRefusal refusalOf(CloseCode code) {
  if (code == CloseCode::kNoToken) return WebRefusal::kToken;
  return code == CloseCode::kTooLarge ? WebRefusal::kSize : WebRefusal::kMessage;
}

/// Where a connection comes from and has come to.
struct Arrival {
  std::string peer;
  std::string network;  ///< api::networkOf()
  bool shared = false;  ///< many clients are behind it
  Origins::Local local;
};

/// A connection, seen from the door. Any thread.
class Guest {
 public:
  virtual ~Guest() = default;
  /// Closes it where no call is open.
  virtual void leaveIfIdle() = 0;
  virtual void leave() = 0;
  virtual void cut() = 0;
};

/// Everybody who is there. Thread-safe.
class Guests {
 public:
  void add(const std::shared_ptr<Guest>& guest, bool visit) {
    const MutexLock lock(mutex_);
    guests_.push_back({guest.get(), guest, visit});
  }
  void remove(const Guest* guest) {
    const MutexLock lock(mutex_);
    guests_.remove_if([guest](const Entry& each) { return each.address == guest; });
    gone_.notifyAll();
  }
  /// The oldest of the visits where there are too many.
  std::shared_ptr<Guest> tooMany() {
    const MutexLock lock(mutex_);
    if (std::size_t(std::count_if(guests_.begin(), guests_.end(), [](auto& e) { return e.visit; })) <= kMostVisits)
      return nullptr;
    const auto oldest = std::find_if(guests_.begin(), guests_.end(), [](auto& e) { return e.visit; });
    oldest->visit = false;
    return oldest->guest.lock();
  }
  std::vector<std::shared_ptr<Guest>> all() {
    const MutexLock lock(mutex_);
    std::vector<std::shared_ptr<Guest>> out;
    for (const Entry& each : guests_) {
      if (auto guest = each.guest.lock()) out.push_back(std::move(guest));
    }
    return out;
  }
  /// Waits until nobody is there; false at the deadline.
  bool waitEmpty(Clock::time_point deadline) {
    MutexLock lock(mutex_);
    while (!guests_.empty()) {
      if (!gone_.waitUntil(lock, deadline)) return guests_.empty();
    }
    return true;
  }

 private:
  struct Entry {
    const Guest* address;
    std::weak_ptr<Guest> guest;
    bool visit;
  };
  Mutex mutex_;
  ConditionVariable gone_;
  std::list<Entry> guests_ LPV_GUARDED_BY(mutex_);
};

/// What all connections share.
struct House {
  const api::Context& context;
  const Origins origins;
  const Files files;
  Places places{};
  Guests guests{};
};

/// Calls on one socket. Runs in turns of its strand; held by operations in progress and by its calls.
template <typename Stream>
class PageSocket final : public Socket, public Guest, public std::enable_shared_from_this<PageSocket<Stream>> {
 public:
  PageSocket(Stream stream, House& house, const Arrival& arrival, std::shared_ptr<void> place)
      : house_(house),
        stream_(std::move(stream)),
        peer_(arrival.peer),
        place_(std::move(place)),
        timer_(stream_.get_executor()) {}
  ~PageSocket() override {
    --house_.context.counters->webSockets;
    house_.guests.remove(this);
  }

  template <typename Request>
  void start(const Request& request) {
    ++house_.context.counters->webSockets;
    house_.guests.add(this->shared_from_this(), false);
    beast::get_lowest_layer(stream_).expires_never();
    stream_.set_option(websocket::stream_base::timeout{kHandshakeTime, 2 * kIdleTime, true});
    stream_.read_message_max(0);
    stream_.auto_fragment(false);
    stream_.binary(true);
    calls_ = std::make_shared<Calls>(house_.context, peer_, this->shared_from_this());
    const std::chrono::seconds first = house_.context.registry->limits().firstMessage;
    timer_.expires_after(first);
    timer_.async_wait([self = this->shared_from_this(), first](Error stopped) {
      if (!stopped) self->late(first);
    });
    stream_.async_accept(request, [self = this->shared_from_this()](Error error) {
      if (error) return self->gone();
      self->read();
    });
  }

  // Socket.
  void send(std::string message, std::function<void(bool)> sent) override {
    if (closing_ || gone_) return post([sent = std::move(sent)] { sent(false); });
    queue_.push_back({std::move(message), std::move(sent)});
    if (!writing_) write();
  }
  void close(CloseCode code, const std::string& reason) override {
    house_.context.counters->countWebRefusal(refusalOf(code));
    end(code, reason);
  }
  void greeted(bool good) override {
    if (!good || known_) return;
    known_ = true;
    timer_.cancel();
    place_.reset();
  }
  void roomAgain() override { readOn(); }
  void post(std::function<void()> job) override {
    net::post(stream_.get_executor(), [self = this->shared_from_this(), job = std::move(job)] { job(); });
  }

  // Guest.
  void leaveIfIdle() override {
    post([this] {
      if (!calls_ || calls_->count() == 0) end(CloseCode::kGoingAway, "the server is going away");
    });
  }
  void leave() override {
    post([this] { end(CloseCode::kGoingAway, "the server is going away"); });
  }
  void cut() override {
    post([this] { gone(); });
  }

 private:
  struct Outgoing {
    std::string message;
    std::function<void(bool)> sent;
  };

  /// The timer may have run out in the very turn in which a good token came.
  void late(std::chrono::seconds first) {
    if (known_) return;
    const std::string seconds = std::to_string(first.count());
    if (welcomed_) return close(CloseCode::kNoToken, "no good access token was shown within " + seconds + " s");
    house_.context.counters->countWebRefusal(WebRefusal::kFirstMessage);
    end(CloseCode::kPolicy, "first_message: no hello came within " + seconds + " s");
  }

  void read() {
    reading_ = true;
    stream_.async_read_some(in_, most() + 1 - in_.size(), [self = this->shared_from_this()](Error error, std::size_t) {
      self->reading_ = false;
      self->onRead(error);
    });
  }
  void readOn() {
    if (reading_ || closing_ || gone_ || calls_->full() || queue_.size() > kMostQueued) return;
    read();
  }
  void onRead(const Error& error) {
    if (error && !closing_) return gone();
    if (error || closing_) return;
    if (!stream_.got_binary()) {
      return close(CloseCode::kNotBinary, "text is refused; send lpv.web.v1.ToServer in binary messages");
    }
    if (in_.size() > most()) {
      return close(CloseCode::kTooLarge, "a message has more than " + std::to_string(most()) + " bytes, the most " +
                                             (known_ ? "that is allowed" : "before a good token was shown"));
    }
    if (stream_.is_message_done()) {
      welcomed_ = true;
      calls_->receive({static_cast<const char*>(in_.data().data()), in_.size()});
      in_.consume(in_.size());
      if (in_.capacity() > kMostStrangerBytes) in_ = beast::flat_buffer();
    }
    if (!gone_) readOn();
  }

  /// Bytes of a message of the page.
  std::size_t most() const { return known_ ? kMostBytes : kMostStrangerBytes; }

  void write() {
    writing_ = true;
    stream_.async_write(net::buffer(queue_.front().message),
                        [self = this->shared_from_this()](Error error, std::size_t) { self->onWritten(error); });
  }
  void onWritten(const Error& error) {
    writing_ = false;
    const Outgoing done = std::move(queue_.front());
    queue_.pop_front();
    done.sent(!error && !closing_);
    if (error && !closing_) return gone();
    if (closing_ || gone_) return drop();
    if (!queue_.empty()) write();
    readOn();
  }

  void end(CloseCode code, const std::string& reason) {
    if (closing_ || gone_) return;
    closing_ = true;
    drop();
    timer_.expires_after(kCloseTime);
    timer_.async_wait([self = this->shared_from_this()](Error stopped) {
      if (!stopped) self->gone();
    });
    stream_.async_close(websocket::close_reason(websocket::close_code(code), reason),
                        [self = this->shared_from_this()](Error) { self->gone(); });
  }
  /// Nothing that waits will be sent.
  void drop() {
    while (queue_.size() > (writing_ ? 1U : 0U)) {
      post([sent = std::move(queue_.back().sent)] { sent(false); });
      queue_.pop_back();
    }
  }
  void gone() {
    if (gone_) return;
    gone_ = true;
    timer_.cancel();
    place_.reset();
    beast::get_lowest_layer(stream_).close();
    if (!writing_) drop();
    const std::shared_ptr<Calls> calls = std::move(calls_);
    if (calls) calls->lost();
  }

  House& house_;
  websocket::stream<Stream> stream_;
  const std::string peer_;
  std::shared_ptr<void> place_;  ///< among those who have not shown a good token
  net::steady_timer timer_;
  std::shared_ptr<Calls> calls_;  ///< null once the socket has gone
  beast::flat_buffer in_;
  std::deque<Outgoing> queue_;             ///< the first is being written where writing_ is set
  bool known_ = false;  ///< has shown a good token
  bool welcomed_ = false;                  ///< a message has come
  bool reading_ = false;
  bool writing_ = false;
  bool closing_ = false;
  bool gone_ = false;
};

/// A connection that asks for files, until it asks for a socket. Runs in turns of its strand.
template <typename Stream>
class Visit final : public Guest, public std::enable_shared_from_this<Visit<Stream>> {
 public:
  Visit(Stream stream, House& house, Arrival arrival)
      : house_(house), stream_(std::move(stream)), arrival_(std::move(arrival)) {}
  ~Visit() override { house_.guests.remove(this); }

  void start() {
    house_.guests.add(this->shared_from_this(), true);
    if (const auto oldest = house_.guests.tooMany()) oldest->cut();
    if constexpr (std::is_same_v<Stream, Secured>) {
      beast::get_lowest_layer(stream_).expires_after(kHandshakeTime);
      stream_.async_handshake(ssl::stream_base::server, [self = this->shared_from_this()](Error error) {
        if (!error) self->read();
      });
    } else {
      read();
    }
  }

  void leaveIfIdle() override { cut(); }
  void leave() override { cut(); }
  void cut() override {
    net::post(executor_, [self = this->shared_from_this()] {
      if (!self->left_) beast::get_lowest_layer(self->stream_).close();
    });
  }

 private:
  void read() {
    parser_.emplace();
    parser_->header_limit(kMostHeaderBytes);
    parser_->body_limit(0);
    beast::get_lowest_layer(stream_).expires_after(kRequestTime);
    http::async_read(stream_, in_, *parser_, [self = this->shared_from_this()](Error error, std::size_t) {
      if (!error) return self->answer();
      if (error == http::error::header_limit)
        return self->refuse(431, "the request's header is longer than 8192 bytes\n");
      if (error == http::error::body_limit) return self->refuse(413, "requests here have no body\n");
      if (error.category() == make_error_code(http::error::end_of_stream).category() &&
          error != http::error::end_of_stream && error != http::error::partial_message)
        self->refuse(400, "not a request of HTTP/1.1\n");
    });
  }

  void answer() {
    const auto& request = parser_->get();
    const std::string_view target = viewOf(request.target());
    const std::size_t mark = std::min(target.find('?'), target.size());
    const std::string path(target.substr(0, mark));
    if (request.count(http::field::host) != 1) return refuse(400, "a request has one Host header\n");
    const Status host = house_.origins.checkHost(std::string(viewOf(request[http::field::host])), arrival_.local);
    if (!host.ok()) return refuse(421, host.message() + "\n", WebRefusal::kHost);
    if (holdsToken(target.substr(mark))) {
      return refuse(400,
                    "an address may hold no token, as addresses are logged and kept; a link has it behind #, and a "
                    "program sends it in lpv.web.v1.Hello\n",
                    WebRefusal::kTokenInAddress);
    }
    if (path == "/ws") return open();
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return refuse(405, "allowed are GET and HEAD\n");
    const File* file = house_.files.at(path);
    if (file == nullptr && path == "/") return say(503, kText, kNoPage);
    if (file == nullptr) return say(404, kText, "not found\n");
    serve(*file);
  }

  void serve(const File& file) {
    const std::string_view accepted = viewOf(parser_->get()[http::field::accept_encoding]);
    const bool packed = !file.packed.empty() && accepted.find("gzip") != std::string_view::npos;
    response_ = {};
    if (packed) response_.set(http::field::content_encoding, "gzip");
    response_.set(http::field::vary, "Accept-Encoding");
    response_.set(http::field::cache_control, file.named ? "public, max-age=31536000, immutable" : "no-store");
    write(200, file.type, packed ? file.packed : file.plain);
  }

  /// The socket that carries calls.
  void open() {
    const auto& request = parser_->get();
    if (!websocket::is_upgrade(request)) return refuse(426, "/ws is a WebSocket (RFC 6455): ask for an upgrade\n");
    const Status origin = house_.origins.checkOrigin(std::string(viewOf(request[http::field::origin])), arrival_.local);
    if (!origin.ok()) return refuse(403, origin.message() + "\n", WebRefusal::kOrigin);
    Expected<std::shared_ptr<void>> place = house_.places.take(arrival_.network, arrival_.shared);
    if (!place) return refuse(429, place.status().message() + "\n", WebRefusal::kPlaces);
    left_ = true;
    std::make_shared<PageSocket<Stream>>(std::move(stream_), house_, arrival_, std::move(*place))->start(request);
  }

  /// What is wrong ends the connection: nothing that follows it can be trusted to be a request.
  void refuse(int status, const std::string& text, WebRefusal why = WebRefusal::kRequest) {
    house_.context.counters->countWebRefusal(why);
    last_ = true;
    say(status, kText, text);
  }
  void say(int status, const std::string& type, std::string text) {
    response_ = {};
    text_ = std::move(text);
    response_.set(http::field::cache_control, "no-store");
    if (status == 405) response_.set(http::field::allow, "GET, HEAD");
    if (status == 426) response_.set(http::field::upgrade, "websocket");
    write(status, type, text_);
  }
  void write(int status, const std::string& type, std::string_view body) {
    const auto& request = parser_->get();
    const bool keep = !last_ && request.keep_alive();
    response_.version(11);
    response_.result(unsigned(status));
    response_.set(http::field::content_type, type);
    response_.set("Content-Security-Policy", kPolicy);
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("Cross-Origin-Opener-Policy", "same-origin");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.keep_alive(keep);
    response_.content_length(body.size());
    if (request.method() != http::verb::head) response_.body() = {body.data(), body.size()};
    beast::get_lowest_layer(stream_).expires_after(kAnswerTime);
    http::async_write(stream_, response_, [self = this->shared_from_this(), keep](Error error, std::size_t) {
      if (error) return;
      if (keep) return self->read();
      self->finish();
    });
  }

  /// What the client still sends is read for a while, so that closing does not reset the connection before it has read.
  void finish() {
    Error ignored;
    beast::get_lowest_layer(stream_).socket().shutdown(Tcp::socket::shutdown_send, ignored);
    beast::get_lowest_layer(stream_).expires_after(kCloseTime);
    leftOver();
  }
  void leftOver() {
    beast::get_lowest_layer(stream_).async_read_some(net::buffer(left_over_),
                                                     [self = this->shared_from_this()](Error error, std::size_t) {
                                                       if (!error) self->leftOver();
                                                     });
  }

  House& house_;
  Stream stream_;
  const net::any_io_executor executor_ = stream_.get_executor();
  const Arrival arrival_;
  beast::flat_buffer in_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  http::response<http::span_body<const char>> response_;
  std::string text_;  ///< that response_ may show
  std::array<char, 1024> left_over_{};
  bool last_ = false;  ///< the answer is
  bool left_ = false;  ///< the stream is a socket's now
};

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
