#include "engine/engine.h"

#include <atomic>
#include <future>
#include <thread>

#include "engine/device_choice.h"
#include "gpu/context.h"
#include "lpv/device/admission_cost.h"
#include "lpv/device/engine_testing.h"
#include "lpv/device/gl_thread.h"
#include "lpv/device/open_device.h"

namespace lpv {

namespace {

DeviceInfo infoOf(const gpu::Context& context) {
  const gpu::Capabilities& c = context.capabilities();
  return {context.device().index,   c.renderer, c.vendor, c.version, context.device().platform,
          context.device().software};
}

class GlEngine final : public Engine {
 public:
  ~GlEngine() override {
    queue_.stop();
    if (thread_.joinable()) thread_.join();
  }

  /// Returns when the thread has a context and its programs' home, or the reason why not.
  Status start(const DeviceChoice& choice) {
    auto started = std::make_shared<std::promise<Expected<DeviceInfo>>>();
    std::future<Expected<DeviceInfo>> answer = started->get_future();
    thread_ = std::thread([this, choice, started] { run(choice, *started); });
    Expected<DeviceInfo> info = answer.get();
    if (info.ok()) device_ = *info;
    return info.status();
  }

  const DeviceInfo& device() const override { return device_; }
  void submit(TickRequest request, TickDone done) override {
    queue_.push(SubmitJob{std::move(request), std::move(done)});
  }
  void abandon(SessionKey session) override { queue_.push(AbandonJob{session}); }
  Prediction predict(const Workload& workload) const override { return lpv::predict(*costs_, workload); }
  std::int64_t contextLosses() const override { return losses_; }
  void loseContext(std::uint64_t afterPieces) { queue_.push(LoseContextJob{afterPieces}); }
  void forget(SessionKey session) override { queue_.push(ForgetJob{session, std::nullopt}); }
  void forgetView(SessionKey session, std::uint64_t view) override { queue_.push(ForgetJob{session, view}); }

 private:
  void run(const DeviceChoice& choice, std::promise<Expected<DeviceInfo>>& started) {
    Expected<gpu::Context> context = openFirst(choice);
    if (!context.ok()) {
      started.set_value(context.status());
      return;
    }
    const DeviceInfo info = infoOf(*context);
    std::unique_ptr<GlThread> loop;
    try {
      costs_ = std::make_shared<CostModel>(info.software);
      loop = std::make_unique<GlThread>(queue_, std::move(*context), costs_, losses_);
    } catch (const std::exception& failure) {
      started.set_value(Status(Code::kUnavailable, failure.what()));
      return;
    }
    started.set_value(info);
    loop->run();
  }

  JobQueue queue_;
  std::shared_ptr<CostModel> costs_;  ///< made by the GL thread before start() returns
  DeviceInfo device_;
  std::atomic<std::int64_t> losses_{0};
  std::thread thread_;
};

}  // namespace

void loseContext(Engine& engine, std::uint64_t afterPieces) {
  dynamic_cast<GlEngine&>(engine).loseContext(afterPieces);
}

Expected<std::unique_ptr<Engine>> startEngine(const DeviceChoice& choice) {
  auto engine = std::make_unique<GlEngine>();
  const Status status = engine->start(choice);
  if (!status.ok()) return status;
  return std::unique_ptr<Engine>(std::move(engine));
}

}  // namespace lpv
