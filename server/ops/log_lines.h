#pragma once
// Formats log events as one line each; text of a message cannot start another line or be mistaken for a field.

#include <spdlog/formatter.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace lpv::ops {

enum class LogFormat {
  kText,  ///< local time, level, message, then the thread's LogContext as name=value
  kJson,  ///< an object: time (UTC), level, message or event, session, trace, peer, further fields
};

/// Makes the formatter; lines carry the thread's LogContext.
std::unique_ptr<spdlog::formatter> lineFormatter(LogFormat format);

using LogFields = std::vector<std::pair<std::string, std::string>>;

/// While an object of this class exists, lines of its thread are formatted as audit events: the message is the event's
/// name, followed by `fields`.
class EventScope {
 public:
  /// `fields` must outlive this.
  explicit EventScope(const LogFields& fields);
  ~EventScope();
  EventScope(const EventScope&) = delete;
  EventScope& operator=(const EventScope&) = delete;
};

}  // namespace lpv::ops
