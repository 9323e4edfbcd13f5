#pragma once
// Ctrl-C and SIGTERM: the first cancels calls in flight so that a command can clean up; the second ends the process.

#include "lpv/client.h"

namespace lpv::cli {

/// Starts handling the signals. Call it before starting any thread.
void watchInterrupts();

/// Registers `client`: its calls are cancelled when the process is interrupted.
void cancelOnInterrupt(const client::Client& client);

bool interrupted();

}  // namespace lpv::cli
