#pragma once

#include <csignal>
#include <functional>

namespace lpv::app {

/// The signals that say something to the process. Waited for, never handled: made before any thread starts, for they
/// are blocked from then on. A broken pipe and a file at its limit are errors of the write that meets them.
class Signals {
 public:
  Signals();

  /// Waits for SIGTERM or SIGINT and returns its number; calls `reload` for every SIGHUP before. A second SIGTERM or
  /// SIGINT ends the process at once.
  int waitForEnd(const std::function<void()>& reload);

 private:
  sigset_t ends_{};
  sigset_t all_{};
};

}  // namespace lpv::app
