#pragma once

#include <string>

namespace lpv::grpc_door {

/// The address, as api::addressOf() has it, of a connected socket's other end; empty where that has none.
std::string remoteAddress(int socket);

/// Shuts down this process's sockets whose other end is in the network (api::networkOf()) of `address`: gRPC has no way
/// to end a connection that floods, and finds its end here.
void shutDownConnectionsFrom(const std::string& address);

}  // namespace lpv::grpc_door
