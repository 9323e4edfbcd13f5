#pragma once

#include <grpcpp/server.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "api/call/context.h"
#include "base/status.h"
#include "grpc/certificates.h"

namespace lpv::grpc_door {

class Listener;  // grpc/listener.h

/// Where the door is, and what it looks like.
struct DoorOptions {
  std::string address;      ///< "host:port", port 0 = any free one
  TlsFiles tls;             ///< checked, and followed when they change
  OnTlsTrouble onTlsTrouble = [](const Status&) {};  ///< called on a thread of the door
  bool reflection = true;   ///< tells anybody what can be called
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
  std::unique_ptr<Listener> listener_;
};

}  // namespace lpv::grpc_door
