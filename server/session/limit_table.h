#pragma once
// The limits that an operator sets, once: flag of lpvd, field of lpv.v1.Limits, range and help come from here.

#include <chrono>
#include <cstdint>
#include <tuple>

#include "session/limits.h"

namespace lpv {

/// `name` is the field of lpv.v1.Limits and the name in refusals; the flag is the same with dashes. `least` and `most`
/// are allowed, in the unit of `help`.
template <typename Value>
struct LimitRow {
  const char* name;
  Value Limits::*value;
  double least;
  double most;
  const char* help;
};

template <typename Value>
LimitRow(const char*, Value Limits::*, double, double, const char*) -> LimitRow<Value>;

inline constexpr std::tuple kLimitTable = {
    LimitRow{"max_sessions", &Limits::maxSessions, 1, 100'000, "sessions on this server"},
    LimitRow{"max_clients_per_session", &Limits::maxClientsPerSession, 1, 10'000, "joined clients of a session"},
    LimitRow{"max_subscribers_per_session", &Limits::maxSubscribersPerSession, 1, 10'000,
             "result streams of a session"},
    LimitRow{"max_lights", &Limits::maxLights, 1, 100'000, "lights of a session"},
    LimitRow{"max_surfaces", &Limits::maxSurfaces, 1, 100'000, "surfaces of a session"},
    LimitRow{"max_triangles", &Limits::maxTriangles, 1, 1e9, "triangles of a session"},
    LimitRow{"max_texels", &Limits::maxTexels, 1, 1e10, "texels of a session's textures"},
    LimitRow{"max_blob_bytes", &Limits::maxBlobBytes, 1, 1e9, "bytes of one blob"},
    LimitRow{"max_edits_per_second", &Limits::maxEditsPerSecond, 1, 100'000,
             "edits of one client, or of all that do not say who they are"},
    LimitRow{"max_presence_updates_per_second", &Limits::maxPresenceUpdatesPerSecond, 0.1, 1000,
             "presence updates of one client"},
    LimitRow{"max_tick_rate", &Limits::maxTickRate, 0.1, 240, "ticks of one session per second, on average"},
    LimitRow{"max_uploads", &Limits::maxUploads, 1, 1000, "uploads of blobs on their way at once"},
    LimitRow{"max_session_files", &Limits::maxSessionFiles, 1, 1000, "session files on their way in or out at once"},
    LimitRow{"max_answer_bytes", &Limits::maxAnswerBytes, 1e6, 1e12, "bytes that answers in progress hold together"},
    LimitRow{"max_answer_bytes_per_session", &Limits::maxAnswerBytesPerSession, 1e6, 1e12,
             "bytes that answers in progress of one session hold; a larger one is made alone"},
    LimitRow{"max_calls_per_second_per_address", &Limits::maxCallsPerSecondPerAddress, 1, 1e6,
             "calls that one address begins; --trusted-proxy has none"},
    LimitRow{"max_tick_seconds", &Limits::maxTickSeconds, 0.001, 86'400,
             "seconds of this device that a tick is predicted to take"},
    LimitRow{"upload_idle", &Limits::uploadIdle, 1, 86'400, "seconds without a part after which an upload is given up"},
    LimitRow{"first_message", &Limits::firstMessage, 1, 86'400, "seconds a new stream's first message may take"},
    LimitRow{"max_wait", &Limits::maxWait, 1, 86'400,
             "seconds that a call without a deadline of its own waits for its result"},
    LimitRow{"presence_idle", &Limits::presenceIdle, 1, 86'400,
             "seconds without a call after which a member is removed from presence"},
    LimitRow{"self_check", &Limits::selfCheck, 0, 86'400,
             "seconds between comparisons of a session's light with the truth; 0 = none"},
};

/// Calls `each(row)` in the order of the table.
template <typename Each>
void forEachLimit(Each each) {
  std::apply([&each](const auto&... row) { (each(row), ...); }, kLimitTable);
}

}  // namespace lpv
