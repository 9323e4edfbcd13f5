#pragma once
// What the sessions of a server share.

#include <functional>
#include <memory>
#include <string>

#include "base/timers.h"
#include "base/worker_pool.h"
#include "engine/engine.h"
#include "session/answer_room.h"
#include "session/counters.h"
#include "session/damaged_sessions.h"
#include "session/document/document.h"
#include "session/journal.h"
#include "session/limits.h"

namespace lpv {

class Access;

/// What happens to a session without a call, for logs.
enum class SessionEvent {
  kExpired,         ///< idle, and gone with what it held
  kEvicted,         ///< idle: on disk only
  kRetentionEnded,  ///< on disk only for longer than it is retained
  kTickFailed,
  kDamaged,  ///< kept, and cannot be brought back
};

/// Pointers outlive every session.
struct SessionServices {
  Limits limits;  ///< those that a session begins with
  Engine* engine = nullptr;
  WorkerPool* pool = nullptr;
  Timers* timers = nullptr;
  Counters* counters = nullptr;
  MeshHasher hasher;
  Journal* journal = nullptr;
  Access* access = nullptr;  ///< told of sessions that are gone; may be null
  /// Told of incidents with the session's id, and why where a reason is known; may be empty. Any thread.
  std::function<void(SessionEvent, const std::string& session, const std::string& why)> onEvent = nullptr;
  std::shared_ptr<AnswerRoom> answers = std::make_shared<AnswerRoom>();
  std::shared_ptr<DamagedSessions> damaged = std::make_shared<DamagedSessions>();
};

}  // namespace lpv
