#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/status.h"

namespace lpv::api {

class AddressLimit;  // api/call/address_limit.h

/// Accepts connections for a door, but not from addresses that flood.
class Listener {
 public:
  /// Owns `file`, a connection that came to `listening`, from now on. Called on the listener's thread.
  using Take = std::function<void(int listening, int file)>;

  /// Binds to "HOST:PORT", port 0 = any free one; a name is all its addresses, 0.0.0.0 and :: are all of IPv4 and IPv6.
  /// Connections wait until start(). UNAVAILABLE, at `flag`, where that is not possible.
  static Expected<std::unique_ptr<Listener>> bind(const std::string& flag, const std::string& address);
  ~Listener() { stop(); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  int port() const { return port_; }
  /// `limit` may be null: then whoever comes is taken.
  void start(std::shared_ptr<const AddressLimit> limit, Take take);
  /// Closes the listening sockets; what was handed over stays.
  void stop();

 private:
  Listener() = default;
  Status bindTo(const std::string& host, int port);
  Status cannotListen(const std::string& address, const char* why) const;
  void run();
  bool acceptFrom(int listening);

  std::string flag_;
  int port_ = 0;
  std::vector<int> listening_;
  int ending_ = -1;  ///< eventfd that ends the thread
  std::shared_ptr<const AddressLimit> limit_;
  Take take_;
  std::thread thread_;
};

}  // namespace lpv::api
