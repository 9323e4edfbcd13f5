#include "grpc/finish.h"

#include <spdlog/spdlog.h>

#include <iterator>
#include <string_view>

#include "base/text.h"
#include "ops/audit.h"
#include "ops/trace.h"

namespace lpv::door {
namespace {

constexpr std::size_t kMostIdBytes = 80;
constexpr std::size_t kMostAuditText = 200;

/// Refusals that say something about who calls, not about what a call says.
bool concernsCaller(const Status& status) {
  return status.code() == Code::kUnauthenticated || status.code() == Code::kPermissionDenied ||
         status.code() == Code::kResourceExhausted;
}

/// "CreateSessionRequest" is CreateSession's.
std::string methodOf(const std::string& request) {
  constexpr std::string_view kSuffix = "Request";
  return request.ends_with(kSuffix) ? request.substr(0, request.size() - kSuffix.size()) : request;
}

}  // namespace

std::string shortId(const std::string& session) {
  constexpr std::string_view kPrefix = "sessions/";
  return truncatedUtf8(session.starts_with(kPrefix) ? session.substr(kPrefix.size()) : session, kMostIdBytes);
}

ops::LogContext contextOf(const grpc::CallbackServerContext& call, const std::string& session) {
  ops::LogContext out;
  out.session = shortId(session);
  out.peer = call.peer();
  const auto [first, last] = call.client_metadata().equal_range("traceparent");
  // Two of them are as good as none (W3C Trace Context, section 3.2.1).
  if (first != last && std::next(first) == last) {
    out.trace = ops::traceIdOf({first->second.data(), first->second.size()});
  }
  return out;
}

grpc::Status record(const api::Context& context, const std::string& method, const char* audited,
                    const std::string& session, const Status& status, bool answered) {
  const bool refused = !status.ok() && status.code() != Code::kCancelled && !answered;
  if (spdlog::should_log(spdlog::level::debug)) {
    spdlog::debug("{}: {}", methodOf(method), status.ok() ? "ok" : status.message());
  }
  if (status.ok() && audited) ops::audit(audited, {{"session", shortId(session)}});
  if (!refused) return toGrpc(status);
  context.counters->callsRefused.add(status);
  if (audited || concernsCaller(status)) {
    ops::auditRefusal({{"method", methodOf(method)},
                       {"reason", kReasons[reasonOf(status)]},
                       {"why", truncatedUtf8(status.message(), kMostAuditText)}});
  }
  return toGrpc(status);
}

}  // namespace lpv::door
