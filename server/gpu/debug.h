#pragma once

namespace lpv::gpu {

/// Sends KHR_debug messages of the current context to spdlog: errors always, the rest too when `verbose` (the context
/// is then a debug context and messages arrive inside the call that caused them).
void installDebugOutput(bool verbose);

}  // namespace lpv::gpu
