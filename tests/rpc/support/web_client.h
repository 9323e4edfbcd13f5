#pragma once
// A browser's socket, by hand: WebSocket frames (RFC 6455) over TCP or TLS, whole or broken, and the calls on it.

#include <google/protobuf/message.h>

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lpv/v1/status.pb.h"
#include "lpv/web/v1/socket.pb.h"

namespace lpv::rpc {

/// How to knock. What is empty is not sent.
struct Knock {
  std::string host{};            ///< Host; by default 127.0.0.1:PORT
  std::string origin{};          ///< Origin; by default http(s)://127.0.0.1:PORT
  std::string path = "/ws";
  bool withOrigin = true;
  std::string authority{};       ///< PEM file of who vouches for the server; given: TLS
};

/// What has come: a message, or the server's close.
struct Arrived {
  int opcode = 0;  ///< 1 text, 2 binary, 8 close, 9 ping, 10 pong; 0: nothing came, the connection has ended
  std::string payload;

  int closeCode() const;
  std::string closeReason() const { return payload.size() > 2 ? payload.substr(2) : std::string(); }
};

class WebSocketClient {
 public:
  /// Connects to 127.0.0.1 and asks for a socket. status() says how that went.
  WebSocketClient(int port, Knock knock = {});
  ~WebSocketClient();
  WebSocketClient(const WebSocketClient&) = delete;
  WebSocketClient& operator=(const WebSocketClient&) = delete;

  int status() const { return status_; }  ///< of HTTP; 101: open
  const std::string& answer() const { return answer_; }  ///< HTTP's header and body where it is not open
  /// Over TLS: reads to the end, and whether the server said that it is the end (close_notify).
  bool endsInOrder();
  /// Bytes as they are.
  bool sendRaw(const std::string& bytes);
  /// A frame; `announced` instead of the payload's size where it is given.
  bool send(int opcode, const std::string& payload, bool last = true, std::optional<std::uint64_t> announced = {});
  /// The next message or close, 20 s at most; answers pings.
  Arrived receive();
  /// Reads nothing any longer, for a while or for ever.
  int socket() const { return socket_; }

 private:
  class Tls;
  bool fill(std::size_t bytes);
  std::string take(std::size_t bytes);

  int socket_ = -1;
  std::unique_ptr<Tls> tls_;
  int status_ = 0;
  std::string answer_;
  std::string in_;
};

/// Calls as the page makes them.
class PageClient {
 public:
  /// Opens a socket and says hello.
  explicit PageClient(int port, const std::string& token = {}, Knock knock = {});

  WebSocketClient& socket() { return socket_; }
  /// Begins a call; `method` as "SceneService/EditScene". Its number.
  std::uint32_t begin(const std::string& method, std::uint32_t timeoutMs = 0);
  void message(std::uint32_t call, const google::protobuf::Message& message);
  void end(std::uint32_t call);
  void cancel(std::uint32_t call);
  void say(const web::v1::ToServer& step);

  /// The next message of a call into `*out`; false at its end, of which endOf() tells more.
  bool next(std::uint32_t call, google::protobuf::Message* out);
  /// How a call has ended; waits for it.
  v1::Status endOf(std::uint32_t call);
  /// What has been taken of the call's messages until now.
  std::uint32_t taken(std::uint32_t call);
  /// A unary call to its end.
  v1::Status call(const std::string& method, const google::protobuf::Message& request,
                  google::protobuf::Message* response, std::uint32_t timeoutMs = 0);
  const web::v1::Welcome& welcome() const { return welcome_; }
  /// The server's close, where it has come.
  const std::optional<Arrived>& closed() const { return closed_; }
  /// Reads one message of whichever call; false where the socket has ended.
  bool pump();

 private:
  struct State {
    std::deque<std::string> messages;
    std::uint32_t taken = 0;
    std::optional<v1::Status> end;
  };
  WebSocketClient socket_;
  web::v1::Welcome welcome_;
  bool welcomed_ = false;
  std::optional<Arrived> closed_;
  std::uint32_t last_ = 0;
  std::map<std::uint32_t, State> calls_;
};

}  // namespace lpv::rpc
