#pragma once

#include <functional>
#include <utility>

#include "api/call/context.h"
#include "api/call/deadline.h"

namespace lpv::api {

/// Ends a wait for a result that has no end of its own: a call without a deadline, for max_wait. Thread-safe.
class LongestWait {
 public:
  explicit LongestWait(const Context& context)
      : limit_(context.limits.maxWait), bounded_(context.hasDeadline), deadline_(*context.timers) {}

  /// Calls `end` with DEADLINE_EXCEEDED unless stop() comes first.
  void start(std::function<void(const Status&)> end) {
    if (bounded_) return;
    deadline_.restart(limit_, [end = std::move(end), seconds = limit_.count()] {
      end(Status(Code::kDeadlineExceeded, Reason::kMaxWait,
                 "max_wait: no result at or after min_revision came within " + std::to_string(seconds) +
                     " s; give the call a deadline to wait longer, or ask for a revision that the session has",
                 "min_revision"));
    });
  }
  void stop() { deadline_.stop(); }

 private:
  const std::chrono::seconds limit_;
  const bool bounded_;
  Deadline deadline_;
};

}  // namespace lpv::api
