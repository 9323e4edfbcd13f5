#include "api/call/context.h"

#include <utility>

#include "base/text.h"

namespace lpv::api {

Status allow(const Context& context, const std::string& id, Role needed) {
  const Grant& caller = context.caller;
  if (caller.role == Role::kAdmin) return {};
  if (caller.session != id) {
    return {Code::kPermissionDenied,
            "this access token is for session \"" + caller.session + "\", not for \"" + truncatedUtf8(id) + "\"",
            "authorization"};
  }
  if (caller.role >= needed) return {};
  return {Code::kPermissionDenied,
          std::string("this needs the role ") + roleName(needed) + ", the access token's is " + roleName(caller.role) +
              "; an owner can make another (lpvctl session share)",
          "authorization"};
}

Expected<MintedToken> ownerToken(const Context& context, const std::string& id) {
  if (!context.access->required()) return MintedToken();
  return context.access->mint(id, Role::kOwner, kDefaultTokenLife);
}

void whenBothKept(const Context& context, const SessionPtr& session, const MintedToken& token,
                  std::function<void(const Status&)> kept) {
  if (token.token.empty()) return session->whenDurable(std::move(kept));
  context.registry->whenDurable(session->id(), token.position, std::move(kept));
}

}  // namespace lpv::api
