#include "rpc/support/web_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <stdexcept>
#include <utility>

namespace lpv::rpc {
namespace {

constexpr timeval kSocketPatience{20, 0};
constexpr int kClose = 8, kPing = 9, kPong = 10;

int connectTo(int port) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  constexpr int kOn = 1;
  setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &kSocketPatience, sizeof kSocketPatience);
  setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &kSocketPatience, sizeof kSocketPatience);
  setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &kOn, sizeof kOn);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(std::uint16_t(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return socket;
  close(socket);
  return -1;
}

void append(std::string& out, std::uint64_t number, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) out.push_back(char((number >> (8 * i)) & 0xFFU));
}

}  // namespace

class WebSocketClient::Tls {
 public:
  Tls(int socket, const std::string& authority) : context_(SSL_CTX_new(TLS_client_method()), SSL_CTX_free) {
    if (SSL_CTX_load_verify_locations(context_.get(), authority.c_str(), nullptr) != 1)
      throw std::runtime_error("no authority in " + authority);
    SSL_CTX_set_verify(context_.get(), SSL_VERIFY_PEER, nullptr);
    ssl_.reset(SSL_new(context_.get()));
    SSL_set_fd(ssl_.get(), socket);
  }
  bool connect() { return SSL_connect(ssl_.get()) == 1; }
  ssize_t read(char* into, std::size_t size) { return SSL_read(ssl_.get(), into, int(size)); }
  ssize_t write(const char* from, std::size_t size) { return SSL_write(ssl_.get(), from, int(size)); }
  bool serverSaidItEnds() const { return (SSL_get_shutdown(ssl_.get()) & SSL_RECEIVED_SHUTDOWN) != 0; }

 private:
  std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context_;
  std::unique_ptr<SSL, decltype(&SSL_free)> ssl_{nullptr, SSL_free};
};

int Arrived::closeCode() const {
  if (opcode != kClose || payload.size() < 2) return 0;
  return (static_cast<unsigned char>(payload[0]) << 8) | static_cast<unsigned char>(payload[1]);
}

WebSocketClient::WebSocketClient(int port, Knock knock) : socket_(connectTo(port)) {
  if (socket_ < 0) return;
  const std::string own = "127.0.0.1:" + std::to_string(port);
  if (!knock.authority.empty()) {
    tls_ = std::make_unique<Tls>(socket_, knock.authority);
    if (!tls_->connect()) return;
  }
  if (knock.host.empty()) knock.host = own;
  if (knock.origin.empty()) knock.origin = (tls_ ? "https://" : "http://") + own;
  std::string request = "GET " + knock.path + " HTTP/1.1\r\nHost: " + knock.host +
                        "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
  if (knock.withOrigin) request += "Origin: " + knock.origin + "\r\n";
  if (!sendRaw(request + "\r\n")) return;
  std::size_t end = std::string::npos;
  while ((end = in_.find("\r\n\r\n")) == std::string::npos && fill(in_.size() + 1)) {
  }
  if (!in_.starts_with("HTTP/1.1 ")) return;
  status_ = std::atoi(in_.c_str() + 9);
  if (status_ == 101) {
    in_.erase(0, end + 4);
    return;
  }
  const std::string length = "Content-Length: ";
  const std::size_t stated = in_.find(length);
  if (stated < end) (void)fill(end + 4 + std::size_t(std::atoi(in_.c_str() + stated + length.size())));
  answer_ = std::exchange(in_, {});
}

WebSocketClient::~WebSocketClient() {
  if (socket_ >= 0) close(socket_);
}

bool WebSocketClient::endsInOrder() {
  while (fill(in_.size() + 1)) {
  }
  return tls_ != nullptr && tls_->serverSaidItEnds();
}

bool WebSocketClient::sendRaw(const std::string& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t n = tls_ ? tls_->write(bytes.data() + sent, bytes.size() - sent)
                           : ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (n <= 0) return false;
    sent += std::size_t(n);
  }
  return true;
}

/// Frames of clients are masked; this mask changes nothing.
bool WebSocketClient::send(int opcode, const std::string& payload, bool last, std::optional<std::uint64_t> announced) {
  const std::uint64_t size = announced.value_or(payload.size());
  std::string frame(1, char((last ? 0x80 : 0) | opcode));
  if (size < 126) {
    frame.push_back(char(0x80U | size));
  } else if (size < 65536) {
    frame.push_back(char(0x80U | 126U));
    append(frame, size, 2);
  } else {
    frame.push_back(char(0x80U | 127U));
    append(frame, size, 8);
  }
  frame.append(4, '\0');
  return sendRaw(frame + payload);
}

bool WebSocketClient::fill(std::size_t bytes) {
  std::array<char, 65536> buffer{};
  while (in_.size() < bytes) {
    const ssize_t n = tls_ ? tls_->read(buffer.data(), buffer.size()) : recv(socket_, buffer.data(), buffer.size(), 0);
    if (n <= 0) return false;
    in_.append(buffer.data(), std::size_t(n));
  }
  return true;
}

std::string WebSocketClient::take(std::size_t bytes) {
  std::string out = in_.substr(0, bytes);
  in_.erase(0, bytes);
  return out;
}

Arrived WebSocketClient::receive() {
  Arrived out;
  while (fill(2)) {
    const std::string head = take(2);
    const auto byte = [](char c) { return std::uint64_t(static_cast<unsigned char>(c)); };
    const bool last = (byte(head[0]) & 0x80U) != 0;
    const int opcode = int(byte(head[0]) & 0x0FU);
    std::uint64_t size = byte(head[1]) & 0x7FU;
    const std::size_t more = size == 126 ? 2 : size == 127 ? 8 : 0;
    if (!fill(more)) return {};
    if (more > 0) size = 0;
    for (const char c : take(more)) size = (size << 8U) | byte(c);
    if (!fill(size)) return {};
    const std::string payload = take(size);
    if (opcode == kPing) {
      send(kPong, payload);
      continue;
    }
    if (opcode == kPong) continue;
    if (opcode != 0) out.opcode = opcode;
    out.payload += payload;
    if (opcode == kClose) {
      send(kClose, payload);
      shutdown(socket_, SHUT_WR);
    }
    if (last) return out;
  }
  return {};
}

PageClient::PageClient(int port, const std::string& token, Knock knock) : socket_(port, std::move(knock)) {
  web::v1::ToServer hello;
  hello.mutable_hello()->set_token(token);
  say(hello);
  while (!welcomed_ && pump()) {
  }
}

void PageClient::say(const web::v1::ToServer& step) { socket_.send(2, step.SerializeAsString()); }

std::uint32_t PageClient::begin(const std::string& method, std::uint32_t timeoutMs) {
  web::v1::ToServer step;
  step.set_call(++last_);
  step.mutable_begin()->set_method("lpv.v1." + method);
  step.mutable_begin()->set_timeout_ms(timeoutMs);
  say(step);
  return last_;
}

void PageClient::message(std::uint32_t call, const google::protobuf::Message& message) {
  web::v1::ToServer step;
  step.set_call(call);
  step.set_message(message.SerializeAsString());
  say(step);
}

void PageClient::end(std::uint32_t call) {
  web::v1::ToServer step;
  step.set_call(call);
  step.set_end(true);
  say(step);
}

void PageClient::cancel(std::uint32_t call) {
  web::v1::ToServer step;
  step.set_call(call);
  step.set_cancel(true);
  say(step);
}

bool PageClient::pump() {
  if (closed_) return false;
  const Arrived arrived = socket_.receive();
  web::v1::ToClient step;
  if (arrived.opcode != 2 || !step.ParseFromString(arrived.payload)) {
    closed_ = arrived;
    return false;
  }
  if (step.has_welcome()) {
    welcome_ = step.welcome();
    welcomed_ = true;
    return true;
  }
  State& state = calls_[step.call()];
  if (step.has_message()) state.messages.push_back(step.message());
  if (step.has_taken()) state.taken += step.taken();
  if (step.has_end()) state.end = step.end();
  return true;
}

bool PageClient::next(std::uint32_t call, google::protobuf::Message* out) {
  State& state = calls_[call];
  while (state.messages.empty()) {
    if (state.end || !pump()) return false;
  }
  const bool parsed = out->ParseFromString(state.messages.front());
  state.messages.pop_front();
  return parsed;
}

v1::Status PageClient::endOf(std::uint32_t call) {
  State& state = calls_[call];
  while (!state.end) {
    if (pump()) continue;
    v1::Status lost;
    lost.set_code(14);
    lost.set_message("the socket has ended: " + closed_->closeReason());
    return lost;
  }
  return *state.end;
}

std::uint32_t PageClient::taken(std::uint32_t call) { return calls_[call].taken; }

v1::Status PageClient::call(const std::string& method, const google::protobuf::Message& request,
                            google::protobuf::Message* response, std::uint32_t timeoutMs) {
  const std::uint32_t number = begin(method, timeoutMs);
  message(number, request);
  next(number, response);
  return endOf(number);
}

}  // namespace lpv::rpc
