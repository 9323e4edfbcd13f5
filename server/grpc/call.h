#pragma once

#include <grpcpp/impl/service_type.h>

#include <memory>
#include <vector>

#include "api/call/context.h"
#include "api/call/method_table.h"

namespace lpv::grpc_door {

/// The method table as gRPC services, one each, in their order: they are registered with a grpc::ServerBuilder and
/// outlive its server, and `context` outlives them.
std::vector<std::unique_ptr<grpc::Service>> makeServices(const api::Context& context);

}  // namespace lpv::grpc_door
