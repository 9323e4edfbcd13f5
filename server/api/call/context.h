#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "engine/engine.h"
#include "session/access.h"
#include "session/answer_room.h"
#include "session/registry.h"

namespace lpv::api {

class AddressLimit;  // api/call/address_limit.h
struct ResultCaches;  // api/results/result_caches.h
/// Empty ones.
std::shared_ptr<ResultCaches> makeResultCaches();

/// What a call can reach, and who makes it. The server's is copied for every call; what is pointed to outlives the
/// calls.
struct Context {
  Registry* registry = nullptr;
  WorkerPool* pool = nullptr;
  Timers* timers = nullptr;
  Counters* counters = nullptr;
  Limits limits;  ///< of when the call began
  DeviceInfo device;
  std::string version;
  std::chrono::system_clock::time_point started;
  Access* access = nullptr;
  Grant caller = {};
  bool hasDeadline = false;  ///< the call has one of its own
  std::shared_ptr<AnswerRoom> answers = std::make_shared<AnswerRoom>();
  std::shared_ptr<AddressLimit> addresses = nullptr;  ///< null: none
  WorkerPool* background = nullptr;  ///< for what takes long; null: the pool
  std::shared_ptr<ResultCaches> caches = makeResultCaches();  ///< encodings that calls share
};

/// PERMISSION_DENIED unless the caller may do in session `id` what `needed` may.
Status allow(const Context& context, const std::string& id, Role needed);
/// The access token of a new session's owner, whose position is after the session's own; an empty one where tokens are
/// off.
Expected<MintedToken> ownerToken(const Context& context, const std::string& id);
/// Calls `kept` once the session and its owner's token are.
void whenBothKept(const Context& context, const SessionPtr& session, const MintedToken& token,
                  std::function<void(const Status&)> kept);

}  // namespace lpv::api
