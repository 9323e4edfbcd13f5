#pragma once
// Many calls on one browser's socket (lpv/web/v1/socket.proto), each driven as the gRPC door drives its own. Knows no
// sockets: those are Boost.Beast's, in door.cpp.

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "api/call/context.h"
#include "lpv/web/v1/socket.pb.h"
#include "web/socket.h"

namespace lpv::web_door {

/// Open at once on a socket, as streams of a gRPC connection are.
inline constexpr std::size_t kMostCalls = 100;
/// Messages of a call that the server has not said `taken` of.
inline constexpr std::size_t kMostUntaken = 8;
/// Bytes of all of them after which a socket is not read until some were taken.
inline constexpr std::size_t kMostUntakenBytes = 8 * 1024 * 1024;

/// The calls of a socket. Its functions are called in the socket's turn.
class Calls : public std::enable_shared_from_this<Calls> {
 public:
  /// The server's context outlives this. `peer` as in api::CallOrigin. Holds the socket until lost().
  Calls(const api::Context& server, std::string peer, std::shared_ptr<Socket> socket);
  ~Calls();
  Calls(const Calls&) = delete;
  Calls& operator=(const Calls&) = delete;

  /// Takes a message of the page, whole. What is wrong with it closes the socket.
  void receive(std::string_view bytes);
  /// The page is ahead of us: nothing is to be read before Socket::roomAgain().
  bool full() const { return full_; }
  /// The socket has gone: its calls are cancelled, and go when they have ended.
  void lost();
  /// Open ones.
  std::size_t count() const { return calls_.size(); }

 private:
  class Call;
  using Step = web::v1::ToServer;

  void hello(const std::string& token);
  void begin(std::uint32_t id, const web::v1::Begin& begin);
  void pass(Call& call, Step& step);
  void refuse(std::uint32_t id, const Status& status);
  void say(
      const web::v1::ToClient& step, std::function<void(bool)> sent = [](bool) {});
  void counted(std::size_t came, std::size_t went);
  void forget(std::uint32_t id);

  const api::Context& server_;
  const std::string peer_;
  std::shared_ptr<Socket> socket_;
  std::map<std::uint32_t, std::shared_ptr<Call>> calls_;
  std::string token_;
  bool helloCame_ = false;
  bool full_ = false;
  std::uint32_t last_ = 0;        ///< the latest call that has begun
  std::size_t untakenBytes_ = 0;  ///< of all calls
};

}  // namespace lpv::web_door
