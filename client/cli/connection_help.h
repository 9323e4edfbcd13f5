#pragma once
// Why a server could not be reached, where a look at it says more than gRPC does: TLS on one side only, a certificate
// that nothing vouches for.

#include "command.h"

namespace lpv::cli {

/// `status`, an UNAVAILABLE, with a sentence about what to do where there is one; unchanged where nobody answers.
/// Connects to the server once, for some seconds at most.
Status withConnectionHelp(const Status& status, const Globals& globals);

}  // namespace lpv::cli
