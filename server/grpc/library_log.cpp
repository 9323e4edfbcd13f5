#include "grpc/library_log.h"

#include <grpc/support/log.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/text.h"
#include "ops/line_limiter.h"

namespace lpv::grpc_door {
namespace {

constexpr int kMostLines = 10;
constexpr std::chrono::seconds kEach{10};
constexpr std::size_t kMostBytes = 400;

spdlog::level::level_enum levelOf(gpr_log_severity severity) {
  if (severity == GPR_LOG_SEVERITY_ERROR) return spdlog::level::warn;
  return severity == GPR_LOG_SEVERITY_INFO ? spdlog::level::debug : spdlog::level::trace;
}

void write(gpr_log_func_args* line) {
  static ops::LineLimiter limiter(kMostLines, kEach);
  const spdlog::level::level_enum level = levelOf(line->severity);
  if (!spdlog::should_log(level)) return;
  std::string_view message(line->message);
  message.remove_prefix(std::min(message.find_first_not_of(' '), message.size()));
  const std::string text = truncatedUtf8(std::string(message), kMostBytes);
  // The last words before an abort.
  if (message.starts_with("assertion failed")) return spdlog::critical("gRPC: {}", text);
  const std::optional<std::int64_t> leftOut = limiter.take();
  if (!leftOut) return;
  if (*leftOut == 0) return spdlog::log(level, "gRPC: {}", text);
  spdlog::log(level, "gRPC: {} ({} lines of gRPC were left out before)", text, *leftOut);
}

}  // namespace

void takeLibraryLog() { gpr_set_log_function(write); }

}  // namespace lpv::grpc_door
