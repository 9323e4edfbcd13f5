#pragma once
// Who may make a call, asked before its handler sees anything of it.

#include <string>

#include "api/call/method.h"

namespace lpv::api {

/// Makes a copy of the server's context one call's: puts in its caller, by the token that the call shows (empty for
/// none), and the limits of now. UNAUTHENTICATED without a good token where tokens are asked for.
Status admit(const Expected<std::string>& token, Context& call);

/// PERMISSION_DENIED unless the caller is an admin, for methods that only admins may call.
Status authorize(const Context& context, const Method& method);
/// PERMISSION_DENIED unless the caller has the method's role in the session that the call's first message names. What
/// names none, or none that could be, is left to the handler, which says what is wrong.
Status authorize(const Context& context, const Method& method, const google::protobuf::Message& first);

}  // namespace lpv::api
