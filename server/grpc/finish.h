#pragma once
// What a call leaves behind: who it was for the log, a count of what was refused, an audit line.

#include <grpcpp/server_context.h>
#include <grpcpp/support/status.h>

#include <concepts>
#include <string>

#include "api/call/context.h"
#include "grpc/status.h"
#include "lpv/v1/session.pb.h"
#include "ops/log_scope.h"

namespace lpv::door {

/// The verb under which the audit log has calls with this request; null: only their refusals, if at all.
template <typename Request>
inline constexpr const char* kAudited = nullptr;
template <>
inline constexpr const char* kAudited<lpv::v1::CreateSessionRequest> = "create";
template <>
inline constexpr const char* kAudited<lpv::v1::DeleteSessionRequest> = "delete";
template <>
inline constexpr const char* kAudited<lpv::v1::ImportSessionRequest> = "import";
template <>
inline constexpr const char* kAudited<lpv::v1::CreateTokenRequest> = "share";
template <>
inline constexpr const char* kAudited<lpv::v1::RevokeTokenRequest> = "revoke";

/// What a message calls the session it is about, or wants or got: a resource name or an id; empty where it names none.
template <typename Message>
std::string sessionIn(const Message& m) {
  using Text = const std::string&;
  if constexpr (requires {
                  { m.subscription().session() } -> std::same_as<Text>;
                }) {
    return m.subscription().session();
  } else if constexpr (requires {
                         { m.header().session() } -> std::same_as<Text>;
                       }) {
    return m.header().session();
  } else if constexpr (requires {
                         { m.session().name() } -> std::same_as<Text>;
                       }) {
    return m.session().name();
  } else if constexpr (requires {
                         { m.session() } -> std::same_as<Text>;
                       }) {
    return m.session();
  } else if constexpr (requires {
                         { m.session_id() } -> std::same_as<Text>;
                       }) {
    return m.session_id();
  } else if constexpr (requires {
                         { m.name() } -> std::same_as<Text>;
                       }) {
    return m.name();
  } else {
    return {};
  }
}

/// Who calls, from where, as part of which trace. `session` as sessionIn() says it.
ops::LogContext contextOf(const grpc::CallbackServerContext& call, const std::string& session);
/// "sessions/room" without what is the same in all names, and not longer than ids can be.
std::string shortId(const std::string& session);

/// The end of a call as the wire has it, counted and logged. `answered`: it has sent something before, so that an error
/// is no refusal. `session` where the call made it. Within the call's LogScope.
grpc::Status record(const api::Context& context, const std::string& method, const char* audited,
                    const std::string& session, const Status& status, bool answered);
template <typename Request, typename Response>
grpc::Status finish(const api::Context& context, const Response& response, const Status& status,
                    bool answered = false) {
  const std::string& method = Request::descriptor()->name();
  return record(context, method, kAudited<Request>, sessionIn(response), status, answered);
}

}  // namespace lpv::door
