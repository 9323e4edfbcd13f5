#pragma once
// A page's WebSocket. Included by door.cpp alone: Beast's WebSockets take a minute to compile.

#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "session/registry.h"
#include "web/calls.h"
#include "web/house.h"
#include "web/socket.h"
#include "web/streams.h"
#include "wire/message_size.h"

namespace lpv::web_door {

namespace websocket = beast::websocket;

/// A page whose machine has vanished is gone after twice as long.
inline constexpr std::chrono::seconds kIdleTime{10};
/// Before a good token was shown.
inline constexpr std::size_t kMostStrangerBytes = 64 * 1024;
/// A message of a call, and what is around it.
inline constexpr std::size_t kMostBytes = wire::kMaxMessageBytes + 1024;
/// Messages that wait to be sent. The page is not listened to until it has taken some: its calls have one each, and
/// more than those are answers to what it goes on asking.
inline constexpr std::size_t kMostQueued = 4 * kMostCalls;

inline WebRefusal refusalOf(CloseCode code) {
  if (code == CloseCode::kNoToken) return WebRefusal::kToken;
  return code == CloseCode::kTooLarge ? WebRefusal::kSize : WebRefusal::kMessage;
}

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
  /// A message may have come before writing found the page gone.
  void onRead(const Error& error) {
    if (error && !closing_) return gone();
    if (error || closing_ || gone_) return;
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
    if (error && !closing_) gone();
    if (closing_ || gone_) return drop();  // gone() leaves what waits behind a message that is being written
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
}  // namespace lpv::web_door
