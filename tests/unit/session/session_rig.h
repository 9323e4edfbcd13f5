#pragma once
// Sessions without a GPU, a network or a wait: ticks end at once and answer with an empty volume of their revision.

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "session/memory_journal.h"
#include "session/registry.h"

namespace lpv::test {

/// A name for a mesh's content that is as good as a hash for the few meshes of a test.
BlobHash nameOfContent(const Mesh& mesh);

/// Operations, shortly.
Operation createLight(const std::string& name);
Operation createSurface(const std::string& name);
Operation setRadiance(const std::string& light, double value);
Operation moveLight(const std::string& light, const glm::dvec3& translation);
Edit editOf(std::vector<Operation> operations, std::uint64_t sequence = 0);

/// Ends every tick inside submit(), but for patient ones while they are held.
class InstantEngine final : public Engine {
 public:
  const DeviceInfo& device() const override { return device_; }
  void submit(TickRequest request, TickDone done) override;
  void abandon(SessionKey) override;
  void forget(SessionKey) override {}
  void forgetView(SessionKey, std::uint64_t) override {}

  Prediction predict(const Workload& workload) const override {
    return {secondsPerCell * workload.cells + secondsPerLight * workload.lights, Stage::kPropagate};
  }

  std::int64_t contextLosses() const override { return 0; }

  int ticks() const { return ticks_; }
  int reducedFrames() const { return reducedFrames_; }  ///< asked for so far
  /// The ticks from now on fail with this; ok ends that.
  void failWith(const Status& status);
  /// Patient ticks from now on stay under way until they are abandoned.
  void holdPatientOnes() { holds_ = true; }
  bool holdsOne() const;
  int abandoned() const { return abandoned_; }
  /// Runs in the next submit() of a patient tick, before the engine knows of it.
  void whenSubmitted(std::function<void()> act) { whenSubmitted_ = std::move(act); }
  /// The last request for a patient tick.
  TickRequest patient() const;

  /// What ticks are predicted to take.
  std::atomic<double> secondsPerCell{0.0}, secondsPerLight{0.0};

 private:
  DeviceInfo device_;
  std::atomic<int> ticks_{0}, reducedFrames_{0}, abandoned_{0};
  std::atomic<bool> holds_{false};
  mutable std::mutex mutex_;
  Status failure_;
  TickRequest patient_;
  TickDone held_;
  std::function<void()> whenSubmitted_;
};

/// Keeps what it is offered.
class Inbox final : public ResultSink {
 public:
  void offer(const Result& result) override;
  void prepare(const Result& result) override;
  void close(Closing why) override;

  std::size_t count() const;
  Result last() const;
  /// What was to be prepared, in order.
  std::vector<Result> prepared() const;
  std::optional<Closing> closed() const;

 private:
  mutable std::mutex mutex_;
  std::vector<Result> results_;
  std::vector<Result> prepared_;
  std::optional<Closing> closed_;
};

/// What sessions need around them. One worker: jobs run in the order they were posted.
class Rig {
 public:
  explicit Rig(Limits limits = quick());
  ~Rig();

  /// Limits whose rates, of ticks and edits, ask for no waiting.
  static Limits quick();

  std::shared_ptr<Session> session(SessionPolicy policy = {});
  /// Returns when everything that was posted, and what came of it, has run.
  void settle();

  InstantEngine engine;
  Counters counters;
  Timers timers;
  WorkerPool pool{1};
  MemoryJournal journal;
  SessionServices services;
};

/// Polls until `true`, for at most 20 s.
bool eventually(const std::function<bool()>& condition);

}  // namespace lpv::test
