#pragma once
// A real lpvd on a free port of the loopback, started and ended by the test.

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lpv::rpc {

/// Built with a sanitizer: memory bounds of the server are looser there.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

inline constexpr std::int64_t kMiB = 1024 * 1024;

/// A child process. Dies with its owner, and with the test however that ends.
class ChildProcess {
 public:
  ChildProcess(const std::string& program, const std::vector<std::string>& arguments);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  void signal(int number) const;
  /// The exit status, or minus the signal that ended it; nothing while it runs after `patience`.
  std::optional<int> wait(std::chrono::milliseconds patience);
  /// What it has written so far.
  std::string output() const;
  std::string errors() const;
  /// A folder that lives as long as this.
  const std::string& directory() const { return directory_; }

 private:
  std::string directory_;  // of its own, with the files "out" and "err"
  pid_t pid_ = -1;
  std::optional<int> ended_;
};

/// lpvd, listening. The constructor throws std::runtime_error with the log where it does not come up.
class ServerProcess {
 public:
  explicit ServerProcess(const std::vector<std::string>& arguments = {}, const std::string& listen = "127.0.0.1:0");
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

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

/// The test binary's own server, started with default options at the first use.
ServerProcess& server();

/// lpvd run to its end.
struct Finished {
  std::optional<int> status;  ///< nothing: it was still running after `patience` and was killed
  std::string output;
  std::string errors;
};
Finished runServer(const std::vector<std::string>& arguments,
                   std::chrono::milliseconds patience = std::chrono::seconds(20));

}  // namespace lpv::rpc
