#pragma once

#include <grpcpp/support/server_callback.h>

#include "api/call/context.h"

namespace lpv::door {

/// The server's context with the limits of the moment and the call's caller in it, from its metadata "authorization:
/// Bearer TOKEN"; or why the call is refused: UNAUTHENTICATED.
Expected<api::Context> admit(const api::Context& server, const grpc::CallbackServerContext& call);

}  // namespace lpv::door
