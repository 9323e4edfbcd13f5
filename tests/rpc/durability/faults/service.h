#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "rpc/support/rpc.h"
#include "rpc/support/server_process.h"

namespace lpv::rpc::faults {

/// Servers on one state directory, one after the other.
class Service {
 public:
  /// `program`: instead of lpvd.
  explicit Service(std::string program = {});
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  void start();
  /// SIGKILL: what was not written is gone.
  void kill();
  /// SIGTERM: streams are told, everything is written.
  void drain();
  void pause() { server_->process().signal(SIGSTOP); }
  void resume() { server_->process().signal(SIGCONT); }

  int port() const { return server_->port(); }
  /// Calls past all proxies.
  Stubs& stubs() { return *stubs_; }
  std::int64_t residentBytes() const { return server_->residentBytes(); }
  /// Memory of each server before its end, bytes.
  const std::vector<std::int64_t>& lives() const { return lives_; }

 private:
  void end(int signal, int status);

  const std::string program_;
  const std::string directory_ = makeDirectory();
  std::unique_ptr<ServerProcess> server_;
  std::unique_ptr<Stubs> stubs_;
  std::vector<std::int64_t> lives_;
};

}  // namespace lpv::rpc::faults
