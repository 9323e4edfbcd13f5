#pragma once
// Browsers that ask for the page's files, over HTTP. Included by door.cpp alone, as page_socket.h is.

#include <array>
#include <boost/beast/http.hpp>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "web/house.h"
#include "web/page_socket.h"
#include "web/streams.h"

namespace lpv::web_door {

namespace http = beast::http;

inline constexpr std::uint32_t kMostHeaderBytes = 8192;
/// From the end of one answer to the end of the next request.
inline constexpr std::chrono::seconds kRequestTime{15};
inline constexpr std::chrono::seconds kAnswerTime{30};

inline constexpr const char* kText = "text/plain; charset=utf-8";
inline constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
    "connect-src 'self'; worker-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";
inline constexpr const char* kNoPage =
    "This lpvd was built without its page: npm was missing, or could fetch nothing. Build it where npm is installed,\n"
    "or start it with --web-files DIR, the folder that client/web was built to.\n";

/// Whether a secret stands where addresses are logged and kept.
inline bool holdsToken(std::string_view query) {
  return query.find("token=") != std::string_view::npos || query.find("lpv_") != std::string_view::npos;
}

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

  /// Over TLS the client hears that this is all (RFC 8446, section 6.1: close_notify), and need not take it for one
  /// that was cut off.
  void finish() {
    beast::get_lowest_layer(stream_).expires_after(kCloseTime);
    if constexpr (std::is_same_v<Stream, Secured>) {
      stream_.async_shutdown([self = this->shared_from_this()](Error) { self->endSending(); });
    } else {
      endSending();
    }
  }
  /// What the client still sends is read for a while, so that closing does not reset the connection before it has read.
  void endSending() {
    Error ignored;
    beast::get_lowest_layer(stream_).socket().shutdown(Tcp::socket::shutdown_send, ignored);
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

}  // namespace lpv::web_door
