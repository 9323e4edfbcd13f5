#include "ops/log_scope.h"

#include <utility>

namespace lpv::ops {
namespace {

LogContext& current() {
  thread_local LogContext context;
  return context;
}

}  // namespace

LogScope::LogScope(LogContext context) : before_(std::exchange(current(), std::move(context))) {}

LogScope::~LogScope() { current() = std::move(before_); }

const LogContext& LogScope::now() { return current(); }

}  // namespace lpv::ops
