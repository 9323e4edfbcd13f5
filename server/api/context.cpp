#include "api/context.h"

#include "scene/text.h"

namespace lpv::api {

Status allow(const Context& context, const std::string& id, Role needed) {
  const Grant& caller = context.caller;
  if (caller.role == Role::kAdmin) return {};
  if (caller.session != id) {
    return {Code::kPermissionDenied,
            "this access token is for session \"" + caller.session + "\", not for \"" + shortened(id) + "\"",
            "authorization"};
  }
  if (caller.role >= needed) return {};
  return {Code::kPermissionDenied,
          std::string("this needs the role ") + roleName(needed) + ", the access token's is " + roleName(caller.role) +
              "; an owner can make another (lpvctl session share)",
          "authorization"};
}

Status allowAdmin(const Context& context, const char* what) {
  if (context.caller.role == Role::kAdmin) return {};
  return {Code::kPermissionDenied,
          std::string(what) + " needs the admin token, the access token's role is " + roleName(context.caller.role),
          "authorization"};
}

Expected<std::string> ownerToken(const Context& context, const std::string& id) {
  if (!context.access->required()) return std::string();
  const Expected<MintedToken> minted = context.access->mint(id, Role::kOwner, kDefaultTokenLife);
  return minted ? Expected<std::string>(minted->token) : Expected<std::string>(minted.status());
}

}  // namespace lpv::api
