#include "api/call/call_end.h"

#include <spdlog/spdlog.h>

#include <string_view>

#include "base/text.h"
#include "ops/audit.h"

namespace lpv::api {
namespace {

constexpr std::size_t kMostIdBytes = 80;
constexpr std::size_t kMostAuditText = 200;

/// Refusals that say something about who calls, not about what a call says.
bool concernsCaller(const Status& status) {
  return status.code() == Code::kUnauthenticated || status.code() == Code::kPermissionDenied ||
         status.code() == Code::kResourceExhausted;
}

}  // namespace

std::string shortId(const std::string& session) {
  constexpr std::string_view kPrefix = "sessions/";
  return truncatedUtf8(session.starts_with(kPrefix) ? session.substr(kPrefix.size()) : session, kMostIdBytes);
}

void recordEnd(const Context& context, const Method& method, const Status& status, bool sent,
               const google::protobuf::Message& response) {
  if (spdlog::should_log(spdlog::level::debug)) {
    spdlog::debug("{}: {}", method.shortName(), status.ok() ? "ok" : status.message());
  }
  if (status.ok()) {
    if (method.audited) ops::audit(method.audited, {{"session", shortId(textAt(response, method.made))}});
    return;
  }
  if (status.code() == Code::kCancelled || sent) return;
  context.counters->callsRefused.add(status);
  if (method.audited || concernsCaller(status)) {
    ops::auditRefusal({{"method", method.shortName()},
                       {"reason", kReasons[reasonOf(status)]},
                       {"why", truncatedUtf8(status.message(), kMostAuditText)}});
  }
}

}  // namespace lpv::api
