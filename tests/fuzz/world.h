#pragma once
// A server without doors, a GPU or a disk, for one input: a registry with one session, "room", that has a light "Lamp",
// a surface "Wall", a camera "Front" and two members.

#include <google/protobuf/message_lite.h>
#include <memory>
#include <string>
#include <vector>

#include "api/call/context.h"
#include "session/memory_journal.h"
#include "unit/session/small_engine.h"

namespace lpv::fuzz {

inline constexpr const char* kAdminToken = "an admin's token of this test";

/// Limits that an input of a few hundred bytes can reach.
Limits smallLimits();

/// What every input shares. Work that a server gives to other threads is done by the fuzzer's own, one job after the
/// other: an input does the same every time, and no time is lost between threads.
struct Machinery {
  test::SmallEngine engine;
  Counters counters;
  Timers timers;
  WorkerPool pool{0};  ///< its jobs run in settle()
  MemoryJournal journal;

  /// Returns when everything that was posted, and what came of it, has run.
  void settle() { pool.runQueued(); }
};
Machinery& machinery();

class World {
 public:
  /// With `tokens` calls need one.
  explicit World(bool tokens);
  ~World();

  /// What a door has.
  api::Context serverContext() { return contextOf(Role::kAdmin); }
  /// A call's context; Role::kAdmin is everybody's where no tokens are asked for.
  api::Context contextOf(Role role);
  const ClientIdentity& a() const { return a_; }
  const ClientIdentity& b() const { return b_; }

  /// Everything that is kept of all sessions, members apart: the same bytes for the same content.
  std::string content() const;

 private:
  Access access_;
  const std::shared_ptr<api::ResultCaches> caches_ = api::makeResultCaches();
  SessionServices services_;
  Registry registry_;
  ClientIdentity a_;
  ClientIdentity b_;
};

/// The same bytes for the same message.
std::string deterministic(const google::protobuf::MessageLite& message);

}  // namespace lpv::fuzz
