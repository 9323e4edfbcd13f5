#pragma once

#include <string>

#include "base/status.h"

namespace lpv::ops {

/// Sends the process's log to standard error, and the audit log with it. `level`: trace, debug, info, warn, error, off.
/// `format`: text, json (log_lines.h).
Status startLog(const std::string& level, const std::string& format);

}  // namespace lpv::ops
