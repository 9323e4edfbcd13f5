#pragma once

#include <grpcpp/server.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "api/call/context.h"
#include "api/call/listener.h"
#include "base/status.h"
#include "grpc/certificates.h"

namespace lpv::grpc_door {

/// Where the door is, and what it looks like.
struct DoorOptions {
  std::string address;  ///< "host:port", port 0 = any free one
  tls::Follower* certificates = nullptr;  ///< outlives the door; null: plain text
  bool reflection = true;  ///< tells anybody what can be called
};

/// A listening gRPC server: health on, identity encoding only, no shared ports, messages of at most
/// 1 MiB (PROTOCOL.md, Doors).
class Door {
 public:
  /// Listens. UNAVAILABLE where that is not possible. `context` outlives the door.
  static Expected<std::unique_ptr<Door>> open(const api::Context& context, const DoorOptions& options);
  ~Door();

  int port() const;
  /// Answers NOT_SERVING to health checks from now on.
  void stopServing();
  /// Ends what is left at the deadline.
  void shutdown(std::chrono::milliseconds patience);

 private:
  Door() = default;
  std::unique_ptr<Certificates> certificates_;  ///< outlive the server, as services_ do; null for plain text
  std::vector<std::unique_ptr<grpc::Service>> services_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<api::Listener> listener_;
};

}  // namespace lpv::grpc_door
