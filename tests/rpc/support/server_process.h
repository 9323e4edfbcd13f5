#pragma once
// A real lpvd on a free port of the loopback, started and ended by the test or bench.

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rpc/support/child_process.h"

namespace lpv::rpc {

/// Built with a sanitizer: memory bounds of the server are looser there.
#if defined(LPV_ADDRESS_SANITIZER)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

inline constexpr std::int64_t kMiB = 1024 * 1024;

/// lpvd, listening. The constructor throws std::runtime_error with the log where it does not come up.
class ServerProcess {
 public:
  /// `program`: instead of the lpvd of this build.
  explicit ServerProcess(const std::vector<std::string>& arguments = {}, const std::string& listen = "127.0.0.1:0",
                         const std::string& program = {});
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  /// Those that are there now.
  static const std::vector<const ServerProcess*>& live();

  int port() const { return port_; }
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  ChildProcess& process() { return *process_; }
  bool running() { return !process_->wait(std::chrono::milliseconds(0)); }
  /// Memory in use now, bytes.
  std::int64_t residentBytes() const;
  /// Starts a new record of the largest memory in use, which peakBytes() then tells.
  void forgetPeak() const;
  std::int64_t peakBytes() const;
  std::string log() const { return process_->output() + process_->errors(); }

 private:
  std::int64_t statusBytes(const std::string& key) const;

  std::string portFile_;
  std::unique_ptr<ChildProcess> process_;
  int port_ = 0;
};

/// The test binary's own server, started at the first use with default options, but for the rate of edits: tests send
/// as many as they can.
ServerProcess& server();

/// lpvd run to its end.
struct Finished {
  std::optional<int> status;  ///< nothing: it was still running after `patience` and was killed
  std::string output;
  std::string errors;
};
Finished runServer(const std::vector<std::string>& arguments, std::chrono::milliseconds patience = kPatience);

}  // namespace lpv::rpc
