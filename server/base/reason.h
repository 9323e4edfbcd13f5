#pragma once
// Why something was refused, as one name of a fixed set, for programs: clients, metrics and the audit log. This is the
// only table: a limit's refusal, its metric label and its name on the wire (google.rpc.ErrorInfo.reason, listed as
// lpv.v1.ErrorReason with the same numbers) all come from here.

#include <array>
#include <cstddef>
#include <string_view>

namespace lpv {

/// X(enumerator, name on the wire, number on the wire). Numbers are never used again.
#define LPV_REASONS(X)                                                   \
  X(kDraining, "DRAINING", 1)                                            \
  X(kEvicting, "EVICTING", 2)                                            \
  X(kFirstMessage, "FIRST_MESSAGE", 3)                                   \
  X(kUploadIdle, "UPLOAD_IDLE", 4)                                       \
  X(kSequenceOld, "SEQUENCE_OLD", 5)                                     \
  X(kRevisionChanged, "REVISION_CHANGED", 7)                             \
  X(kNameTaken, "NAME_TAKEN", 8)                                         \
  X(kLocked, "LOCKED", 9)                                                \
  X(kNothingToUndo, "NOTHING_TO_UNDO", 10)                               \
  X(kFixedBounds, "FIXED_BOUNDS", 11)                                    \
  X(kUnknownClient, "UNKNOWN_CLIENT", 12)                                \
  X(kSessionDeleted, "SESSION_DELETED", 13)                              \
  X(kStateUnwritable, "STATE_UNWRITABLE", 14)                            \
  X(kEncodingFailed, "ENCODING_FAILED", 15)                              \
  X(kMaxWait, "MAX_WAIT", 19)                                            \
  X(kMaxBlobBytes, "MAX_BLOB_BYTES", 32)                                 \
  X(kMaxCameras, "MAX_CAMERAS", 33)                                      \
  X(kMaxClientsPerSession, "MAX_CLIENTS_PER_SESSION", 34)                \
  X(kMaxEditsPerSecond, "MAX_EDITS_PER_SECOND", 35)                      \
  X(kMaxGroups, "MAX_GROUPS", 36)                                        \
  X(kMaxLights, "MAX_LIGHTS", 37)                                        \
  X(kMaxLocks, "MAX_LOCKS", 38)                                          \
  X(kMaxPresenceUpdatesPerSecond, "MAX_PRESENCE_UPDATES_PER_SECOND", 39) \
  X(kMaxProbePoints, "MAX_PROBE_POINTS", 40)                             \
  X(kMaxSessionFileBytes, "MAX_SESSION_FILE_BYTES", 41)                  \
  X(kMaxSessionFiles, "MAX_SESSION_FILES", 42)                           \
  X(kMaxSessions, "MAX_SESSIONS", 43)                                    \
  X(kMaxSubscribersPerSession, "MAX_SUBSCRIBERS_PER_SESSION", 44)        \
  X(kMaxSurfaces, "MAX_SURFACES", 45)                                    \
  X(kMaxTexels, "MAX_TEXELS", 46)                                        \
  X(kMaxTickSeconds, "MAX_TICK_SECONDS", 47)                             \
  X(kMaxTriangles, "MAX_TRIANGLES", 48)                                  \
  X(kMaxUploads, "MAX_UPLOADS", 49)                                      \
  X(kMaxAnswerBytes, "MAX_ANSWER_BYTES", 50)                             \
  X(kMaxAnswerBytesPerSession, "MAX_ANSWER_BYTES_PER_SESSION", 51)       \
  X(kMaxCallsPerSecondPerAddress, "MAX_CALLS_PER_SECOND_PER_ADDRESS", 52)

#define LPV_REASON_ENUMERATOR(enumerator, name, number) enumerator = number,
/// kNone: the code says all there is to say.
enum class Reason { kNone = 0, LPV_REASONS(LPV_REASON_ENUMERATOR) };
#undef LPV_REASON_ENUMERATOR

struct ReasonName {
  Reason reason;
  std::string_view name;  ///< in upper case
};
#define LPV_REASON_ROW(enumerator, name, number) ReasonName{Reason::enumerator, name},
inline constexpr std::array kReasonNames = {LPV_REASONS(LPV_REASON_ROW)};
#undef LPV_REASON_ROW

/// "MAX_LIGHTS"; empty for kNone.
constexpr std::string_view nameOf(Reason reason) {
  for (const ReasonName& row : kReasonNames) {
    if (row.reason == reason) return row.name;
  }
  return {};
}

/// Whether it is the limit of that name that was reached.
constexpr bool isLimit(Reason reason) { return nameOf(reason).substr(0, 4) == "MAX_"; }

/// kNone for a name that this version does not know.
constexpr Reason reasonNamed(std::string_view name) {
  for (const ReasonName& row : kReasonNames) {
    if (row.name == name) return row.reason;
  }
  return Reason::kNone;
}

}  // namespace lpv
