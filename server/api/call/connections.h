#pragma once

#include <string>

namespace lpv::api {

/// The address, as addressOf() has it, of a connected socket's other end; empty where that has none.
std::string remoteAddress(int socket);

/// AF_INET or AF_INET6 of a socket's own address; 0 where it has none.
int familyOf(int socket);

/// Shuts down this process's sockets whose other end is in the network (networkOf()) of `address`: gRPC has no way
/// to end a connection that floods, and finds its end here.
void shutDownConnectionsFrom(const std::string& address);

}  // namespace lpv::api
