#pragma once

namespace lpv::grpc_door {

/// Takes gRPC's own log lines, which it else writes to standard error as they come, into ours: its errors are warnings,
/// because bytes of strangers cause them. At most ten in ten seconds are written; the next says how many were left out.
void takeLibraryLog();

}  // namespace lpv::grpc_door
