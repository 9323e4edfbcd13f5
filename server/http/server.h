#pragma once
// A small HTTP/1.1 server that clients cannot hold up. It knows nothing of what is served.

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "base/address.h"
#include "base/status.h"

namespace lpv::http {

/// A GET or HEAD request; handlers need not tell them apart.
struct Request {
  std::string path;   ///< without the query: "/live"
  std::string query;  ///< what follows the question mark, as sent; empty for none
};

struct Answer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
};

/// Makes an answer. Called on a thread of its path's own, one request at a time: a slow handler holds up requests for
/// its own path only. Must not throw.
using Handler = std::function<Answer(const Request&)>;

struct Limits {
  int connections = 256;                        ///< open at once; one more, and the oldest is cut off
  std::size_t headerBytes = 8192;               ///< of a request; longer ones are answered 431
  std::size_t bodyBytes = 0;                    ///< of a request's body, which is not looked at; longer: 413
  std::chrono::milliseconds request{5'000};     ///< from the connection to the last byte of its request
  std::chrono::milliseconds answer{10'000};  ///< from the answer's first byte to its last; slower readers are cut off
};

/// Answers one request on every connection, then closes it. Connections share one thread that never waits for any of
/// them, so idle and slow clients cost memory only, and that is bounded by Limits. Paths without a handler are 404,
/// methods but GET and HEAD 405, what is no HTTP 400.
class Server {
 public:
  /// Listens; the host is an IPv4 or IPv6 address. UNAVAILABLE, with the system's reason, if that fails.
  static Expected<std::unique_ptr<Server>> open(const HostPort& at, std::map<std::string, Handler> paths,
                                                const Limits& limits);
  /// Cuts connections off, waits for handlers that run.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const;

 private:
  class Parts;
  explicit Server(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace lpv::http
