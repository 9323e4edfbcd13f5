#pragma once
// One gRPC call by hand over a plain socket: what no well-behaved library would send.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace lpv::rpc {

struct RawAnswer {
  bool ended = false;       ///< the server ended the call (trailers, reset or goodbye) before the patience ran out
  int grpcStatus = -1;      ///< of its trailers; -1 where it sent none
  std::size_t sent = 0;     ///< bytes of the message that the server's flow control let through
};

/// Sends `message` (with its five-byte prefix) to `path` on 127.0.0.1:`port` with `headers` beside the usual ones, as
/// far as the server's windows allow, and waits at most ten seconds for the end.
RawAnswer rawCall(int port, const std::string& path, const std::vector<std::pair<std::string, std::string>>& headers,
                  const std::string& message);

/// A gRPC message's prefix and payload.
std::string framed(bool compressed, const std::string& payload);

}  // namespace lpv::rpc
