#pragma once

#include <string>

#include "scene/status.h"

namespace lpv::ops {

/// Sends the process's log to standard error. `level`: trace, debug, info, warn, error, off.
Status startLog(const std::string& level);

}  // namespace lpv::ops
