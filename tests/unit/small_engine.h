#pragma once
// Engines that make results as large as they are asked for, without a GPU: volumes of the scene's grid, frames of the
// size that was wished.

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include "lpv/engine.h"

namespace lpv::test {

/// Cells of a volume at most; a tick of a larger grid fails.
inline constexpr std::size_t kSmallCells = 4096;

/// What a tick answers with: one layer for each group of lights, a ramp whose height is the revision; a grey frame.
Expected<TickResult> smallResult(const TickRequest& request);

/// Ends every tick inside submit().
class SmallEngine final : public Engine {
 public:
  const DeviceInfo& device() const override { return device_; }
  void submit(TickRequest request, TickDone done) override { done(smallResult(request)); }
  void forget(SessionKey) override {}
  void forgetView(SessionKey, std::uint64_t) override {}

 private:
  DeviceInfo device_;
};

/// Ends ticks one after another on a thread of its own, as the GL thread does.
class ThreadedEngine final : public Engine {
 public:
  ThreadedEngine();
  ~ThreadedEngine() override;

  const DeviceInfo& device() const override { return device_; }
  void submit(TickRequest request, TickDone done) override;
  void forget(SessionKey) override {}
  void forgetView(SessionKey, std::uint64_t) override {}

  int ticks() const { return ticks_; }

 private:
  void run();

  DeviceInfo device_;
  std::atomic<int> ticks_{0};
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::pair<TickRequest, TickDone>> queue_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace lpv::test
