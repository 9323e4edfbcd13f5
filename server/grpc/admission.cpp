#include "grpc/admission.h"

#include <grpcpp/grpcpp.h>

#include <string>

namespace lpv::door {
namespace {

constexpr const char* kHeader = "authorization";
constexpr const char* kScheme = "Bearer ";

/// The token that the call shows, once; empty for none.
Expected<std::string> shownToken(const grpc::CallbackServerContext& call) {
  const auto [first, last] = call.client_metadata().equal_range(kHeader);
  if (first == last) return std::string();
  const std::string text(first->second.data(), first->second.size());
  if (std::next(first) != last || !text.starts_with(kScheme)) {
    return Status(Code::kUnauthenticated,
                  "authorization is given more than once, or is not of the form \"Bearer TOKEN\"", kHeader);
  }
  return text.substr(std::string(kScheme).size());
}

}  // namespace

Expected<api::Context> admit(const api::Context& server, const grpc::CallbackServerContext& call) {
  api::Context own = server;
  own.limits = server.registry->limits();
  const Expected<std::string> token = shownToken(call);
  if (!token) return server.access->required() ? Expected<api::Context>(token.status()) : own;
  Expected<Grant> caller = server.access->verify(*token);
  if (!caller) return caller.status();
  own.caller = std::move(*caller);
  return own;
}

}  // namespace lpv::door
