#pragma once

#include <string>

namespace lpv::ops {

/// What log lines are about; empty fields are unknown.
struct LogContext {
  std::string session;  ///< id
  std::string trace;    ///< W3C trace id
  std::string peer;     ///< as gRPC writes addresses: "ipv4:127.0.0.1:50000"
};

/// Lines that this thread logs while a scope exists carry its context. Scopes nest; the innermost is used.
class LogScope {
 public:
  explicit LogScope(LogContext context);
  ~LogScope();
  LogScope(const LogScope&) = delete;
  LogScope& operator=(const LogScope&) = delete;

  /// The context of the calling thread.
  static const LogContext& now();

 private:
  LogContext before_;
};

}  // namespace lpv::ops
