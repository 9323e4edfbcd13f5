#pragma once
// Engines that make results as large as they are asked for, without a GPU: volumes of the scene's grid, frames of the
// size that was wished.

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include "engine/engine.h"

namespace lpv::test {

/// Cells of a volume at most; a tick of a larger grid fails.
inline constexpr std::size_t kSmallCells = 4096;

/// What a tick answers with: one layer for each group of lights, a ramp whose height is the revision; a grey frame.
Expected<TickResult> smallResult(const TickRequest& request);

/// What engines without a device have in common.
class DevicelessEngine : public Engine {
 public:
  const DeviceInfo& device() const override { return device_; }
  void abandon(SessionKey) override {}
  void forget(SessionKey) override {}
  void forgetView(SessionKey, std::uint64_t) override {}
  /// Sessions of a few lights are cheap, thousands of them too dear (Limits::maxTickSeconds).
  Prediction predict(const Workload& workload) const override { return {0.05 * workload.lights, Stage::kGather}; }
  std::int64_t contextLosses() const override { return 0; }

 private:
  DeviceInfo device_;
};

/// Ends every tick inside submit().
class SmallEngine final : public DevicelessEngine {
 public:
  void submit(TickRequest request, TickDone done) override { done(smallResult(request)); }
};

/// Ends ticks one after another on a thread of its own, as the GL thread does.
class ThreadedEngine final : public DevicelessEngine {
 public:
  ThreadedEngine();
  ~ThreadedEngine() override;

  void submit(TickRequest request, TickDone done) override;

  int ticks() const { return ticks_; }

 private:
  void run();

  std::atomic<int> ticks_{0};
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::pair<TickRequest, TickDone>> queue_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace lpv::test
