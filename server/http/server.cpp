#include "http/server.h"

#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <list>
#include <optional>
#include <thread>
#include <utility>

namespace lpv::http {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
using Tcp = net::ip::tcp;
using Error = boost::system::error_code;
using HttpError = beast::http::error;

/// After the answer: what the client still sends is read for so long, so that closing does not reset the connection
/// before the client has read.
constexpr std::chrono::seconds kLinger{1};
constexpr std::size_t kMostLeftOver = 64 * 1024;
/// After a connection could not be accepted.
constexpr std::chrono::milliseconds kAcceptPause{50};

/// A handler with its thread.
struct Path {
  explicit Path(Handler made) : handler(std::move(made)) {}
  Handler handler;
  net::thread_pool thread{1};
};

/// What a request that cannot be read is answered with; nothing where nobody waits for an answer.
std::optional<Answer> answerOf(const Error& error) {
  if (error == HttpError::header_limit)
    return Answer{431, "text/plain; charset=utf-8", "the request's header is too long\n"};
  if (error == HttpError::body_limit)
    return Answer{413, "text/plain; charset=utf-8", "the request's body is too long\n"};
  if (error == HttpError::end_of_stream || error == HttpError::partial_message) return std::nullopt;
  if (error.category() != make_error_code(HttpError::end_of_stream).category()) return std::nullopt;
  return Answer{400, "text/plain; charset=utf-8", "not a request of HTTP/1.1\n"};
}

Request requestOf(std::string_view target) {
  const std::size_t mark = target.find('?');
  if (mark == std::string_view::npos) return {std::string(target), {}};
  return {std::string(target.substr(0, mark)), std::string(target.substr(mark + 1))};
}

}  // namespace

/// Everything runs on the one thread of `io_`, but for handlers.
class Server::Parts {
 public:
  Parts(std::map<std::string, Handler> paths, const Limits& limits) : limits_(limits) {
    for (auto& [path, handler] : paths) paths_.try_emplace(path, std::move(handler));
  }
  ~Parts();

  Error listen(const HostPort& at);
  void run();
  int port() const { return port_; }

 private:
  class Connection;
  using Connections = std::list<Connection*>;

  void accept();
  void welcome(Tcp::socket socket);
  void cutOldest();

  const Limits limits_;
  Connections open_;                   ///< the oldest first; outlives the connections, which io_ holds
  net::io_context io_{1};              ///< outlives the sockets, which paths_ may hold as well
  std::map<std::string, Path> paths_;
  Tcp::acceptor acceptor_{io_};
  net::steady_timer pause_{io_};
  int port_ = 0;
  std::thread thread_;
};

/// Reads one request, has it answered, closes. Held by the operation in progress.
class Server::Parts::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Tcp::socket socket, Parts& parts) : parts_(parts), stream_(std::move(socket)) {
    place_ = parts_.open_.insert(parts_.open_.end(), this);
  }
  ~Connection() { leave(); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void start() {
    parser_.header_limit(std::uint32_t(parts_.limits_.headerBytes));
    parser_.body_limit(parts_.limits_.bodyBytes);
    stream_.expires_after(parts_.limits_.request);
    beast::http::async_read(stream_, buffer_, parser_,
                            [self = shared_from_this()](Error error, std::size_t) { self->onRead(error); });
  }
  void cut() {
    leave();
    stream_.close();
  }

 private:
  void leave() {
    if (!cut_.exchange(true)) parts_.open_.erase(place_);
  }

  void onRead(const Error& error) {
    if (!error) return dispatch();
    if (const std::optional<Answer> refusal = answerOf(error)) write(*refusal);
  }

  void dispatch() {
    const auto& request = parser_.get();
    const auto target = request.target();
    Request asked = requestOf({target.data(), target.size()});
    const auto found = parts_.paths_.find(asked.path);
    if (found == parts_.paths_.end()) return write({404, "text/plain; charset=utf-8", "not found\n"});
    if (request.method() != beast::http::verb::get && request.method() != beast::http::verb::head)
      return write({405, "text/plain; charset=utf-8", "allowed are GET and HEAD\n"});
    net::post(found->second.thread,
              [self = shared_from_this(), &handler = found->second.handler, asked = std::move(asked)]() mutable {
                askHandler(std::move(self), handler, asked);
              });
  }

  /// On the path's thread. The connection goes back to its own thread, which alone may end it.
  static void askHandler(std::shared_ptr<Connection> self, const Handler& handler, const Request& asked) {
    // Nobody waits for an answer on a connection that was cut off: a flood of requests costs no work.
    Answer answer = self->cut_ ? Answer{} : handler(asked);
    net::io_context& io = self->parts_.io_;
    net::post(io, [self = std::move(self), answer = std::move(answer)] { self->write(answer); });
  }

  void write(const Answer& answer) {
    answer_.version(11);
    answer_.result(unsigned(answer.status));
    answer_.set(beast::http::field::content_type, answer.type);
    answer_.set(beast::http::field::cache_control, "no-store");
    if (answer.status == 405) answer_.set(beast::http::field::allow, "GET, HEAD");
    answer_.keep_alive(false);
    answer_.content_length(answer.body.size());
    if (parser_.get().method() != beast::http::verb::head) answer_.body() = answer.body;
    stream_.expires_after(parts_.limits_.answer);
    beast::http::async_write(stream_, answer_, [self = shared_from_this()](Error error, std::size_t) {
      if (!error) self->linger();
    });
  }

  void linger() {
    Error ignored;
    stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    stream_.expires_after(kLinger);
    readLeftOver();
  }

  void readLeftOver() {
    stream_.async_read_some(net::buffer(leftOver_), [self = shared_from_this()](Error error, std::size_t bytes) {
      self->leftOverBytes_ += bytes;
      if (!error && self->leftOverBytes_ < kMostLeftOver) self->readLeftOver();
    });
  }

  Parts& parts_;
  beast::tcp_stream stream_;
  Connections::iterator place_;
  std::atomic<bool> cut_{false};  ///< no longer among the open ones
  beast::flat_buffer buffer_;
  beast::http::request_parser<beast::http::string_body> parser_;
  beast::http::response<beast::http::string_body> answer_;
  std::array<char, 1024> leftOver_{};
  std::size_t leftOverBytes_ = 0;
};

Server::Parts::~Parts() {
  io_.stop();
  if (thread_.joinable()) thread_.join();
  for (auto& [path, served] : paths_) served.thread.stop();
  while (!open_.empty()) cutOldest();
  for (auto& [path, served] : paths_) served.thread.join();
}

Error Server::Parts::listen(const HostPort& at) {
  Error error;
  const Tcp::endpoint place(net::ip::make_address(at.host, error), std::uint16_t(at.port));
  if (!error) acceptor_.open(place.protocol(), error);
  if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
  if (!error) acceptor_.bind(place, error);
  if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
  if (!error) port_ = acceptor_.local_endpoint(error).port();
  return error;
}

void Server::Parts::run() {
  accept();
  thread_ = std::thread([this] { io_.run(); });
}

void Server::Parts::accept() {
  acceptor_.async_accept([this](Error error, Tcp::socket socket) {
    if (!error) {
      welcome(std::move(socket));
      return accept();
    }
    // The process may be out of descriptors: one is freed, and time passes.
    cutOldest();
    pause_.expires_after(kAcceptPause);
    pause_.async_wait([this](Error) { accept(); });
  });
}

void Server::Parts::welcome(Tcp::socket socket) {
  std::make_shared<Connection>(std::move(socket), *this)->start();
  if (open_.size() > std::size_t(limits_.connections)) cutOldest();
}

void Server::Parts::cutOldest() {
  if (!open_.empty()) open_.front()->cut();
}

Server::Server(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Server::~Server() = default;

Expected<std::unique_ptr<Server>> Server::open(const HostPort& at, std::map<std::string, Handler> paths,
                                               const Limits& limits) {
  auto parts = std::make_unique<Parts>(std::move(paths), limits);
  if (const Error error = parts->listen(at))
    return Status(Code::kUnavailable, "cannot listen on " + at.text() + ": " + error.message());
  parts->run();
  return std::unique_ptr<Server>(new Server(std::move(parts)));
}

int Server::port() const { return parts_->port(); }

}  // namespace lpv::http
