#pragma once

#include <string>

namespace lpv::ops {

/// Whom log lines are about; what is empty is not known.
struct LogContext {
  std::string session;  ///< id
  std::string trace;    ///< W3C trace id
  std::string peer;     ///< as gRPC writes addresses: "ipv4:127.0.0.1:50000"
};

/// Every line that this thread logs while a scope is open carries its context. Scopes nest; the innermost counts.
class LogScope {
 public:
  explicit LogScope(LogContext context);
  ~LogScope();
  LogScope(const LogScope&) = delete;
  LogScope& operator=(const LogScope&) = delete;

  /// Of the calling thread.
  static const LogContext& now();

 private:
  LogContext before_;
};

}  // namespace lpv::ops
