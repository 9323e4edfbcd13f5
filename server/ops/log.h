#pragma once

#include <string>

#include "base/status.h"

namespace lpv::ops {

/// Directs the log and the audit log to standard error. `level`: trace, debug, info, warn, error, off.
/// `format`: text, json (log_lines.h).
Status startLog(const std::string& level, const std::string& format);

}  // namespace lpv::ops
