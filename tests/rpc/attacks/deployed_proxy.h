#pragma once
// HAProxy with the configuration that is deployed, before a server with TLS.

#include <map>
#include <memory>
#include <string>

#include "rpc/security/certificates.h"
#include "rpc/support/child_process.h"

namespace lpv::rpc {

/// A port of the loopback that was free a moment ago.
int freePort();

/// deploy/proxy/haproxy.cfg as a process, with the environment that it documents. Certificates are `authority`'s.
class DeployedProxy {
 public:
  /// `more`: further variables, or other values.
  DeployedProxy(const Authority& authority, int backendPort, int opsPort,
                const std::map<std::string, std::string>& more = {});
  ~DeployedProxy();
  DeployedProxy(const DeployedProxy&) = delete;
  DeployedProxy& operator=(const DeployedProxy&) = delete;

  int port() const { return port_; }
  std::string address() const { return "localhost:" + std::to_string(port_); }
  const ChildProcess& process() const { return *process_; }
  bool running() { return !process_->wait(std::chrono::milliseconds(0)); }
  std::string errors() const { return process_->output() + process_->errors(); }
  /// Memory in use now, bytes.
  std::int64_t residentBytes() const;

  /// What `haproxy -c` says of the configuration; 0 where it is valid.
  static int check(const Authority& authority, std::string* said);

 private:
  int port_ = 0;
  std::unique_ptr<ChildProcess> process_;
};

}  // namespace lpv::rpc
