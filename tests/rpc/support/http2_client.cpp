#include "rpc/support/http2_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

namespace lpv::rpc {
namespace {

// RFC 9113, 6 and 6.5.2.
enum FrameType : std::uint8_t {
  kData = 0,
  kHeaders = 1,
  kReset = 3,
  kSettings = 4,
  kPing = 6,
  kGoAway = 7,
  kWindow = 8
};
constexpr std::uint8_t kAck = 1;
constexpr std::uint8_t kEndStream = 1;
constexpr std::uint8_t kEndHeaders = 4;
constexpr std::uint16_t kInitialWindowSetting = 4;
constexpr std::size_t kFrameLimit = 16384;
constexpr std::int64_t kFirstWindow = 65535;
constexpr std::uint32_t kStream = 1;

std::uint32_t big32(const std::string& bytes, std::size_t at) {
  std::uint32_t out = 0;
  for (std::size_t i = 0; i < 4; ++i) out = out << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return out;
}

void put(std::string* out, std::uint64_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) out->push_back(char(value >> (8 * i)));
}

/// A string with a seven-bit length (RFC 7541, 5.1 and 5.2), not Huffman-coded.
void putText(std::string* out, const std::string& text) {
  if (text.size() < 127) {
    out->push_back(char(text.size()));
  } else {
    out->push_back(127);
    std::size_t rest = text.size() - 127;
    for (; rest >= 128; rest /= 128) out->push_back(char(128 | (rest % 128)));
    out->push_back(char(rest));
  }
  *out += text;
}

class Connection {
 public:
  explicit Connection(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(std::uint16_t(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{0, 100'000};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    open_ = connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~Connection() { close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void sendBytes(const std::string& bytes) {
    std::size_t done = 0;
    while (open_ && done < bytes.size()) {
      const ssize_t n = send(socket_, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
      open_ = n > 0;
      if (open_) done += std::size_t(n);
    }
  }
  void sendFrame(FrameType type, std::uint8_t flags, std::uint32_t stream, const std::string& payload) {
    std::string frame;
    put(&frame, payload.size(), 3);
    frame.push_back(char(type));
    frame.push_back(char(flags));
    put(&frame, stream, 4);
    sendBytes(frame + payload);
  }
  /// One frame that has arrived completely; false where there is none now.
  bool readFrame(FrameType* type, std::uint8_t* flags, std::uint32_t* stream, std::string* payload) {
    constexpr std::size_t kHead = 9;
    if (!complete()) receive();
    if (!complete()) return false;
    const std::size_t size = big32(buffer_, 0) >> 8;
    *type = FrameType(buffer_[3]);
    *flags = std::uint8_t(buffer_[4]);
    *stream = big32(buffer_, 5) & 0x7FFFFFFFU;
    *payload = buffer_.substr(kHead, size);
    buffer_.erase(0, kHead + size);
    return true;
  }
  bool open() const { return open_; }

 private:
  bool complete() const { return buffer_.size() >= 9 && buffer_.size() >= 9 + (big32(buffer_, 0) >> 8); }
  void receive() {
    char bytes[4096];
    const ssize_t n = recv(socket_, bytes, sizeof bytes, 0);
    if (n > 0) buffer_.append(bytes, std::size_t(n));
    if (n == 0) open_ = false;
  }
  int socket_;
  bool open_ = false;
  std::string buffer_;
};

/// The call's view of its connection.
struct Exchange {
  Connection connection;
  std::int64_t connectionWindow = kFirstWindow;
  std::int64_t streamWindow = kFirstWindow;
  std::int64_t initialWindow = kFirstWindow;
  std::string headerBlocks{};
  bool ended = false;

  void settings(const std::string& payload) {
    for (std::size_t at = 0; at + 6 <= payload.size(); at += 6) {
      if ((big32(payload, at) >> 16) != kInitialWindowSetting) continue;
      const std::int64_t next = big32(payload, at + 2);
      streamWindow += next - initialWindow;
      initialWindow = next;
    }
    connection.sendFrame(kSettings, kAck, 0, "");
  }

  /// Handles one frame; false where none came.
  bool step() {
    FrameType type{};
    std::uint8_t flags = 0;
    std::uint32_t stream = 0;
    std::string payload;
    if (!connection.readFrame(&type, &flags, &stream, &payload)) return false;
    if (type == kSettings && (flags & kAck) == 0) settings(payload);
    if (type == kPing && (flags & kAck) == 0) connection.sendFrame(kPing, kAck, 0, payload);
    if (type == kWindow) (stream == 0 ? connectionWindow : streamWindow) += big32(payload, 0) & 0x7FFFFFFFU;
    if (type == kHeaders) headerBlocks += payload;
    ended = ended || type == kReset || type == kGoAway || (type <= kHeaders && (flags & kEndStream) != 0);
    return true;
  }

  std::size_t room() const {
    const std::int64_t window = std::min(connectionWindow, streamWindow);
    return std::min(kFrameLimit, std::size_t(std::max<std::int64_t>(0, window)));
  }
};

int statusIn(const std::string& headerBlocks) {
  static const std::string kName = "grpc-status";
  const std::size_t at = headerBlocks.find(kName);
  if (at == std::string::npos) return -1;
  const std::size_t length = std::uint8_t(headerBlocks[at + kName.size()]);
  return std::stoi(headerBlocks.substr(at + kName.size() + 1, length));
}

}  // namespace

std::string framed(bool compressed, const std::string& payload) {
  std::string out(1, compressed ? '\1' : '\0');
  put(&out, payload.size(), 4);
  return out + payload;
}

RawAnswer rawCall(int port, const std::string& path, const std::vector<std::pair<std::string, std::string>>& headers,
                  const std::string& message) {
  Exchange call{Connection(port)};
  call.connection.sendBytes("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n");
  call.connection.sendFrame(kSettings, 0, 0, "");
  std::vector<std::pair<std::string, std::string>> all = {{":method", "POST"}, {":scheme", "http"},
                                                          {":path", path},     {":authority", "localhost"},
                                                          {"te", "trailers"},  {"content-type", "application/grpc"}};
  all.insert(all.end(), headers.begin(), headers.end());
  std::string block;
  for (const auto& [name, value] : all) {
    block.push_back(0);  // literal, not indexed, new name
    putText(&block, name);
    putText(&block, value);
  }
  call.connection.sendFrame(kHeaders, kEndHeaders, kStream, block);
  RawAnswer answer;
  bool closed = false;
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!call.ended && call.connection.open() && std::chrono::steady_clock::now() < until) {
    const std::size_t count = std::min(call.room(), message.size() - answer.sent);
    if (count == 0 && (closed || answer.sent < message.size())) {
      call.step();
      continue;
    }
    closed = answer.sent + count == message.size();
    call.connection.sendFrame(kData, closed ? kEndStream : 0, kStream, message.substr(answer.sent, count));
    answer.sent += count;
    call.connectionWindow -= std::int64_t(count);
    call.streamWindow -= std::int64_t(count);
  }
  while (call.step()) {
  }
  answer.ended = call.ended || !call.connection.open();
  answer.grpcStatus = statusIn(call.headerBlocks);
  return answer;
}

}  // namespace lpv::rpc
