#pragma once
// What a tick reports of its session besides times.

#include "engine/engine.h"
#include "lpv/session_state.h"
#include "shaders/layout.h"

namespace lpv {

/// `counts`: what the inject and volume stages counted last.
void fillReport(const SessionState& session, const LightingSettings& options, const layout::Counters& counts,
                TickReport& report);

}  // namespace lpv
