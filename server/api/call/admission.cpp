#include "api/call/admission.h"

#include "convert/session.h"

namespace lpv::api {

Status admit(const Expected<std::string>& token, Context& call) {
  call.limits = call.registry->limits();
  if (!call.access->required()) return {};
  if (!token) return token.status();
  Expected<Grant> caller = call.access->verify(*token);
  if (!caller) return caller.status();
  call.caller = std::move(*caller);
  return {};
}

Status authorize(const Context& context, const Method& method) {
  if (method.needs != Role::kAdmin || context.caller.role == Role::kAdmin) return {};
  return {Code::kPermissionDenied,
          method.shortName() + " needs the admin token, the access token's role is " + roleName(context.caller.role),
          "authorization"};
}

Status authorize(const Context& context, const Method& method, const google::protobuf::Message& first) {
  if (Status s = authorize(context, method); !s.ok()) return s;
  if (method.needs == Role::kAdmin || *method.session == '\0') return {};
  const Expected<std::string> id = sessionId("session", textAt(first, method.session));
  return id ? allow(context, *id, method.needs) : Status();
}

}  // namespace lpv::api
