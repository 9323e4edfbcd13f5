#include "ops/audit.h"

#include <spdlog/logger.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <memory>
#include <optional>

#include "ops/line_limiter.h"

namespace lpv::ops {
namespace {

constexpr const char* kLogger = "audit";

}  // namespace

void startAudit(const std::vector<spdlog::sink_ptr>& sinks) {
  const auto logger = std::make_shared<spdlog::logger>(kLogger, sinks.begin(), sinks.end());
  logger->set_level(spdlog::level::info);
  spdlog::drop(kLogger);
  spdlog::register_logger(logger);
}

void audit(const std::string& event, const LogFields& fields) {
  const std::shared_ptr<spdlog::logger> logger = spdlog::get(kLogger);
  if (!logger) return;
  const EventScope scope(fields);
  logger->info("{}", event);
}

void auditRefusal(LogFields fields) {
  static LineLimiter limiter(kMostRefusals, std::chrono::seconds(1));
  const std::optional<std::int64_t> leftOut = limiter.take();
  if (!leftOut) return;
  if (*leftOut > 0) fields.emplace_back("left_out", std::to_string(*leftOut));
  audit("refusal", fields);
}

}  // namespace lpv::ops
