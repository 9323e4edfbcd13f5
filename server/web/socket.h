#pragma once

#include <functional>
#include <memory>
#include <string>

namespace lpv::web_door {

/// Why a socket is closed: RFC 6455, section 7.4.1, and one of our own.
enum class CloseCode {
  kGoingAway = 1001,
  kNotBinary = 1003,
  kNotAMessage = 1007,
  kPolicy = 1008,
  kTooLarge = 1009,
  kNoToken = 4401,  ///< no access token that is good here was shown; asking again with the same one is of no use
};

/// The connection to a page as the calls on it see it. Unless it says so, a function is called in the socket's turn:
/// one at a time, never from inside another.
class Socket {
 public:
  virtual ~Socket() = default;
  /// Sends a binary message behind those before it, then calls `sent` in a later turn with whether it has gone out.
  virtual void send(std::string message, std::function<void(bool)> sent) = 0;
  /// Refuses what the page has done, and ends the socket. The reason names what, and the way out, in at most 123 bytes.
  virtual void close(CloseCode code, const std::string& reason) = 0;
  /// The page has shown who it is; `good`: by a token that is good here, or none is asked for.
  virtual void greeted(bool good) = 0;
  /// Calls::full() is no longer true.
  virtual void roomAgain() = 0;
  /// Any thread: runs `job` in a later turn, also where the connection has gone.
  virtual void post(std::function<void()> job) = 0;
};

}  // namespace lpv::web_door
