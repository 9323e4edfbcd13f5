#include "ops/audit.h"

#include <spdlog/logger.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "base/mutex.h"

namespace lpv::ops {
namespace {

constexpr const char* kLogger = "audit";

/// Limits the refusals written in each second.
class RefusalLimiter {
 public:
  using Clock = std::chrono::steady_clock;

  /// Returns the number left out since the last one written; nothing if this one is to be left out too.
  std::optional<std::int64_t> take() {
    const MutexLock lock(mutex_);
    const Clock::time_point now = Clock::now();
    if (now - since_ >= std::chrono::seconds(1)) {
      since_ = now;
      written_ = 0;
    }
    if (written_ == kMostRefusals) {
      ++leftOut_;
      return std::nullopt;
    }
    ++written_;
    return std::exchange(leftOut_, 0);
  }

 private:
  Mutex mutex_;
  Clock::time_point since_ LPV_GUARDED_BY(mutex_){};
  int written_ LPV_GUARDED_BY(mutex_) = 0;
  std::int64_t leftOut_ LPV_GUARDED_BY(mutex_) = 0;
};

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
  static RefusalLimiter limiter;
  const std::optional<std::int64_t> leftOut = limiter.take();
  if (!leftOut) return;
  if (*leftOut > 0) fields.emplace_back("left_out", std::to_string(*leftOut));
  audit("refusal", fields);
}

}  // namespace lpv::ops
