// lpvd on a device that is reset in the midst of every third tick. It is lpvd's own main with another engine under its
// feet; lpvd itself has no switch for it.

#include <atomic>
#include <memory>
#include <utility>

#include "engine/device_choice.h"
#include "lpv/device/engine_testing.h"

namespace lpv {

class LosingEngine final : public Engine {
 public:
  explicit LosingEngine(std::unique_ptr<Engine> engine) : engine_(std::move(engine)) {}

  void submit(TickRequest request, TickDone done) override {
    if (++ticks_ % 3 == 0) loseContext(*engine_, 1 + ticks_ / 3 % 7);
    engine_->submit(std::move(request), std::move(done));
  }

  const DeviceInfo& device() const override { return engine_->device(); }
  Prediction predict(const Workload& workload) const override { return engine_->predict(workload); }
  std::int64_t contextLosses() const override { return engine_->contextLosses(); }
  void abandon(SessionKey session) override { engine_->abandon(session); }
  void forget(SessionKey session) override { engine_->forget(session); }
  void forgetView(SessionKey session, std::uint64_t view) override { engine_->forgetView(session, view); }

 private:
  std::unique_ptr<Engine> engine_;
  std::atomic<std::uint64_t> ticks_{0};
};

Expected<std::unique_ptr<Engine>> startLosingEngine(const DeviceChoice& choice) {
  Expected<std::unique_ptr<Engine>> engine = startEngine(choice);
  if (!engine) return engine.status();
  return std::unique_ptr<Engine>(std::make_unique<LosingEngine>(std::move(*engine)));
}

}  // namespace lpv

#define startEngine startLosingEngine
#include "app/main.cpp"  // NOLINT(bugprone-suspicious-include): the same program
