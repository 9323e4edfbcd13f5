#pragma once
// The one thread that owns a device's context: takes jobs, and lets the ticks of different sessions take turns.

#include <condition_variable>
#include <deque>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <variant>

#include "lpv/clock.h"
#include "lpv/engine.h"
#include "lpv/pipeline.h"
#include "lpv/session_state.h"

namespace lpv {

struct SubmitJob {
  TickRequest request;
  TickDone done;
};
struct ForgetJob {
  SessionKey session;
  std::optional<std::uint64_t> view;  ///< nothing: the whole session
};
using Job = std::variant<SubmitJob, ForgetJob>;

/// Jobs from any thread to the GL thread.
class JobQueue {
 public:
  void push(Job job);
  void stop();
  /// All jobs there are; waits for one, or for stop(), when `mayWait`.
  std::deque<Job> take(bool mayWait);
  bool stopped() const;

 private:
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Job> jobs_;
  bool stopped_ = false;
};

class GlThread {
 public:
  GlThread(JobQueue& queue, bool software);
  /// Until the queue is stopped; ticks under way then end with CANCELLED.
  void run();

 private:
  /// A tick under way. Its address does not change: the coroutine refers to it.
  struct Tick {
    TickRequest request;
    TickDone done;
    TickResult result;
    std::shared_ptr<SessionState> session;
    std::optional<Pieces> story;
    bool told = false;       ///< its story has been told to the end: only fences are outstanding
  };

  void handle(SubmitJob job);
  void handle(const ForgetJob& job);
  void forgetNow(const ForgetJob& job);
  bool underway(SessionKey session) const;
  Tick* nextReady();
  static bool ready(const Tick& tick);
  void advance(Tick& tick);
  void fail(Tick& tick, const Status& status);
  void deliverFinished();
  void waitForGpu() const;

  JobQueue& queue_;
  Pipeline pipeline_;
  Timeline timeline_;
  std::map<SessionKey, std::shared_ptr<SessionState>> sessions_;
  std::list<Tick> ticks_;                ///< in the order of their turns
  std::deque<ForgetJob> forgetLater_;    ///< of sessions with a tick under way
};

}  // namespace lpv
