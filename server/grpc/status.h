#pragma once

#include <grpcpp/support/status.h>

#include "base/status.h"

namespace lpv::grpc_door {

/// The same error on the wire: code, message, and google.rpc.Status with the field in grpc-status-details-bin.
grpc::Status toGrpc(const Status& status);

}  // namespace lpv::grpc_door
