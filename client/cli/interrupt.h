#pragma once
// Ctrl-C and SIGTERM: the first ends the calls in flight so that a command can clean up, the second ends the process.

#include "lpv/client.h"

namespace lpv::cli {

/// To be called before any thread is started.
void watchInterrupts();

/// `client`'s calls end when the process is interrupted.
void cancelOnInterrupt(const client::Client& client);

bool interrupted();

}  // namespace lpv::cli
