#include "ops/log.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "ops/audit.h"
#include "ops/log_lines.h"

namespace lpv::ops {

Status startLog(const std::string& level, const std::string& format) {
  const spdlog::level::level_enum parsed = spdlog::level::from_str(level);
  if (parsed == spdlog::level::off && level != "off") {
    return invalid("log-level", "--log-level is \"" + level + "\", allowed are trace, debug, info, warn, error, off");
  }
  if (format != "text" && format != "json") {
    return invalid("log-format", "--log-format is \"" + format + "\", allowed are text, json");
  }
  spdlog::set_default_logger(spdlog::stderr_color_mt("lpvd"));
  spdlog::set_formatter(lineFormatter(format == "json" ? LogFormat::kJson : LogFormat::kText));
  spdlog::set_level(parsed);
  startAudit(spdlog::default_logger()->sinks());
  return {};
}

}  // namespace lpv::ops
