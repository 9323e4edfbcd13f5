#pragma once
// A session of one server, four writers, four readers, and faults in an order that a seed decides.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "rpc/faults/history.h"
#include "rpc/faults/reader.h"
#include "rpc/faults/writer.h"
#include "rpc/server_process.h"

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

struct RunOptions {
  std::uint64_t seed = 1;
  std::chrono::milliseconds length{10'000};  ///< of faults
  bool kills = true;  ///< else the server lives through it, and only connections and readers suffer
};

/// What a run did, for people.
struct Tally {
  int kills = 0;
  int otherFaults = 0;
  std::size_t accepted = 0;
  std::size_t unknown = 0;
  std::size_t repeated = 0;  ///< acknowledged again
  std::size_t reads = 0;
  void add(const Tally& other);
};

/// Runs in a session of its own and deletes it. `service` is running before and afterwards.
History run(Service& service, const RunOptions& options, Tally* tally);

}  // namespace lpv::rpc::faults
