#pragma once
// Kept sessions that cannot be brought back: what operators are told of them, from the start on.

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "base/mutex.h"
#include "base/status.h"
#include "base/worker_pool.h"
#include "session/journal.h"

namespace lpv {

struct SessionServices;

/// By id, with what is wrong. Thread-safe; acquires no other lock.
class DamagedSessions {
 public:
  /// True where that is news.
  bool note(const std::string& id, const std::string& why);
  /// The session is gone, or was read.
  void forget(const std::string& id);
  std::size_t count() const;
  /// For people; empty where there is none: "state directory: 2 sessions are damaged: ...".
  std::string warning() const;

 private:
  mutable Mutex mutex_;
  std::map<std::string, std::string> why_ LPV_GUARDED_BY(mutex_);
};

/// Notes what became of reading a kept session, and reports damage that is news (SessionEvent::kDamaged).
void noteRead(const SessionServices& services, const std::string& id, const Status& read);

/// Reads every kept session to its end, one after the other as jobs of `background`: damage is known before somebody
/// asks for the session. Calls `checked` with their number after the last.
void checkKeptSessions(const SessionServices& services, WorkerPool& background,
                       std::function<void(std::size_t)> checked);

}  // namespace lpv
