#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace lpv::rpc {

/// How long a test waits for what must come. No measure of speed: it is long enough for the slowest machine, one that
/// builds, tests and makes its driver's programs for the first time, all at once.
constexpr std::chrono::seconds kPatience{60};

/// A new, empty folder for temporary files.
std::string makeDirectory();

/// Where `built`, a program of this build, is now: beside the running one, if the build's programs were carried
/// elsewhere.
std::string whereItIs(const std::string& built);

/// A child process. Dies with its owner, and with the process that started it however that ends.
class ChildProcess {
 public:
  ChildProcess(const std::string& program, const std::vector<std::string>& arguments);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  void signal(int number) const;
  /// The exit status, or minus the signal that ended it; nothing while it runs after `patience`.
  std::optional<int> wait(std::chrono::milliseconds patience = kPatience);
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

}  // namespace lpv::rpc
