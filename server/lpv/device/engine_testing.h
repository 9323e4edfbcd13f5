#pragma once
// What tests do to an engine. Nothing that serves clients includes this.

#include "engine/engine.h"

namespace lpv {

/// The engine's graphics context is destroyed behind its back when it has begun `afterPieces` pieces more: in the midst
/// of a tick, as when a driver resets. `engine` comes from startEngine().
void loseContext(Engine& engine, std::uint64_t afterPieces);

}  // namespace lpv
