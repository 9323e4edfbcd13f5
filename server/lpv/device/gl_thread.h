#pragma once
// The one thread that owns a device's context: takes jobs, and lets the ticks of different sessions take turns.

#include <atomic>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "base/mutex.h"
#include "engine/engine.h"
#include "gpu/context.h"
#include "lpv/device/fair_queue.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/pacing/timeline.h"
#include "lpv/pipeline.h"
#include "lpv/session_state.h"

namespace lpv {

struct SubmitJob {
  TickRequest request;
  TickDone done;
};
struct AbandonJob {
  SessionKey session;
};
struct ForgetJob {
  SessionKey session;
  std::optional<std::uint64_t> view;  ///< nothing: the whole session
};
/// Tests only: the context goes when that many more pieces have been begun.
struct LoseContextJob {
  std::uint64_t afterPieces;
};
using Job = std::variant<SubmitJob, AbandonJob, ForgetJob, LoseContextJob>;

/// Jobs from any thread to the GL thread.
class JobQueue {
 public:
  void push(Job job);
  void stop();
  /// All jobs there are, in the place of `jobs`; waits for one, or for stop(), when `mayWait`.
  void take(bool mayWait, std::vector<Job>& jobs);
  bool stopped() const;

 private:
  mutable Mutex mutex_;
  ConditionVariable arrived_;
  std::vector<Job> jobs_ LPV_GUARDED_BY(mutex_);
  bool stopped_ LPV_GUARDED_BY(mutex_) = false;
};

class GlThread {
 public:
  /// Works in `context`, which is current on this thread, and in others of its device when it is lost. `losses` counts.
  GlThread(JobQueue& queue, gpu::Context context, std::shared_ptr<CostModel> costs, std::atomic<std::int64_t>& losses);
  /// Until the queue is stopped; ticks under way then end with CANCELLED.
  void run();

 private:
  /// A tick under way. Its address does not change: the coroutine refers to it.
  struct Tick {
    TickRequest request;
    TickDone done;
    TickResult result;
    std::shared_ptr<SessionState> session;
    std::optional<GpuTask> story;
    bool storyEnded = false;  ///< the coroutine has run to its end: only fences are outstanding
    bool abandoned = false;  ///< the coroutine is gone
    std::uint64_t piecesBefore = 0;  ///< begun on the device before this tick
    int losses = 0;  ///< of the context, while it was under way
  };

  void handle(SubmitJob job);
  void handle(const AbandonJob& job);
  void handle(const ForgetJob& job);
  void handle(const LoseContextJob& job) { loseAt_ = piecesBegun_ + job.afterPieces; }
  void begin(Tick& tick);
  void recover();
  Status remake();
  void forgetNow(const ForgetJob& job);
  bool underway(SessionKey session) const;
  std::size_t piecesAhead() const;
  Tick* nextReady();
  static bool ready(const Tick& tick);
  void takeEnded();
  Tick* tickOf(const StageClock& clock);
  void advance(Tick& tick);
  void queued(Tick& tick, Timeline::Clock::time_point begin);
  void fail(Tick& tick, const Status& status);
  void deliverFinished();
  void waitForGpu() const;

  JobQueue& queue_;
  std::optional<gpu::Context> context_;
  std::atomic<std::int64_t>& losses_;
  const gpu::Device device_;
  const bool software_;
  std::shared_ptr<CostModel> costs_;
  std::unique_ptr<Pipeline> pipeline_;  ///< null while there is no context
  Timeline timeline_;
  std::map<SessionKey, std::shared_ptr<SessionState>> sessions_;
  std::list<Tick> ticks_;  ///< in the order of their arrival
  FairQueue fairQueue_;
  std::uint64_t piecesBegun_ = 0;
  std::optional<std::uint64_t> loseAt_;
  std::vector<ForgetJob> forgetLater_;  ///< of sessions with a tick under way
};

}  // namespace lpv
