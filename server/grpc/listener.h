#pragma once

#include <grpcpp/server_builder.h>

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/status.h"

namespace lpv::grpc_door {

/// Accepts connections and hands them to gRPC, whose own listener takes whoever comes.
class Listener {
 public:
  using Acceptor = grpc::experimental::ExternalConnectionAcceptor;
  /// Whether a connection from an address (api::addressOf()) is taken; called on the listener's thread.
  using Admits = std::function<bool(const std::string& address)>;

  /// Binds to "HOST:PORT", port 0 = any free one; a name is all its addresses, 0.0.0.0 and :: are all of IPv4 and IPv6.
  /// Connections wait until start(). UNAVAILABLE where that is not possible.
  static Expected<std::unique_ptr<Listener>> bind(const std::string& address);
  ~Listener() { stop(); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  int port() const { return port_; }
  void start(std::unique_ptr<Acceptor> acceptor, Admits admits);
  /// Closes the listening sockets; what was handed over stays.
  void stop();

 private:
  Listener() = default;
  Status bindTo(const std::string& host, int port);
  void run();
  bool acceptFrom(int listening);

  int port_ = 0;
  std::vector<int> listening_;
  int ending_ = -1;  ///< eventfd that ends the thread
  std::unique_ptr<Acceptor> acceptor_;
  Admits admits_;
  std::thread thread_;
};

}  // namespace lpv::grpc_door
