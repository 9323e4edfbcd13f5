#include "ops/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace lpv::ops {

Status startLog(const std::string& level) {
  const spdlog::level::level_enum parsed = spdlog::level::from_str(level);
  if (parsed == spdlog::level::off && level != "off") {
    return invalid("log-level", "--log-level is \"" + level + "\", allowed are trace, debug, info, warn, error, off");
  }
  spdlog::set_default_logger(spdlog::stderr_color_mt("lpvd"));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
  spdlog::set_level(parsed);
  return {};
}

}  // namespace lpv::ops
