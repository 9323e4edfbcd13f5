#pragma once
// One event, one line: what a message says cannot begin a second one, or be taken for a field.

#include <spdlog/formatter.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace lpv::ops {

enum class LogFormat {
  kText,  ///< local time, level, message, then the thread's LogContext as name=value
  kJson,  ///< an object: time (UTC), level, message or event, session, trace, peer and what else is known
};

/// Lines with the thread's LogContext.
std::unique_ptr<spdlog::formatter> lineFormatter(LogFormat format);

using LogFields = std::vector<std::pair<std::string, std::string>>;

/// The lines of this thread are events of the audit log while this is there: the message is the event's name, and
/// `fields` follow it.
class EventScope {
 public:
  /// `fields` outlive this.
  explicit EventScope(const LogFields& fields);
  ~EventScope();
  EventScope(const EventScope&) = delete;
  EventScope& operator=(const EventScope&) = delete;
};

}  // namespace lpv::ops
