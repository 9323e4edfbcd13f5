#pragma once
// The audit log: who created, removed or shared what, and who was refused. One line each, by the logger "audit", at
// level info regardless of --log-level. Session, trace and peer come from the thread's LogScope unless `fields` have
// them. Never log secrets here: no token, no client secret.

#include <spdlog/common.h>

#include <string>
#include <vector>

#include "ops/log_lines.h"

namespace lpv::ops {

/// Writes one line. `event` is a verb: "create", "delete", "import", "share", "expire". Thread-safe.
void audit(const std::string& event, const LogFields& fields = {});

/// Writes the event "refusal". At most kMostRefusals a second are written, so that a client in a loop cannot fill the
/// disk; the next line has the number of refusals left out.
void auditRefusal(LogFields fields);
inline constexpr int kMostRefusals = 20;

/// Sets the sinks of audit lines; lines written before are lost.
void startAudit(const std::vector<spdlog::sink_ptr>& sinks);

}  // namespace lpv::ops
