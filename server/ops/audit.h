#pragma once
// Who made, removed or shared what, and who was refused: one line each in the log, by the logger "audit", at level info
// whatever --log-level says. Session, trace and peer come from the thread's LogScope where `fields` do not say them.
// Nothing secret belongs here: no token, no client secret.

#include <spdlog/common.h>

#include <string>
#include <vector>

#include "ops/log_lines.h"

namespace lpv::ops {

/// `event` is a verb: "create", "delete", "import", "share", "expire". Any thread.
void audit(const std::string& event, const LogFields& fields = {});

/// The event "refusal". Whoever is refused in a loop does not fill the disk: beyond kMostRefusals a second they are
/// counted, and the next line says how many were left out.
void auditRefusal(LogFields fields);
inline constexpr int kMostRefusals = 20;

/// Where audit lines go; before, they go nowhere.
void startAudit(const std::vector<spdlog::sink_ptr>& sinks);

}  // namespace lpv::ops
