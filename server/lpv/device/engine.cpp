#include "engine/engine.h"

#include <spdlog/spdlog.h>

#include <future>
#include <thread>

#include "gpu/context.h"
#include "lpv/device/admission_cost.h"
#include "lpv/device/engine_testing.h"
#include "lpv/device/gl_thread.h"

namespace lpv {

namespace {

DeviceInfo infoOf(const gpu::Context& context) {
  const gpu::Capabilities& c = context.capabilities();
  return {context.device().index,   c.renderer, c.vendor, c.version, context.device().platform,
          context.device().software};
}

bool wanted(const gpu::Device& device, const DeviceChoice& choice) {
  switch (choice.kind) {
    case DeviceChoice::Kind::kIndex:
      return device.index == choice.index;
    case DeviceChoice::Kind::kSoftware:
      return device.software || device.platform == "surfaceless";
    case DeviceChoice::Kind::kAuto:
      break;
  }
  return true;
}

/// Surfaceless may be hardware or software: only its context tells.
Expected<gpu::Context> openWanted(const gpu::Device& device, const DeviceChoice& choice) {
  Expected<gpu::Context> context = gpu::Context::make(device);
  if (context.ok() && choice.kind == DeviceChoice::Kind::kSoftware && !context->device().software)
    return Status(Code::kUnavailable, "not a software device");
  return context;
}

std::string describe(const gpu::Device& device) {
  return "device " + std::to_string(device.index) + " (" + device.platform + ", " + device.name + ")";
}

/// The first device that works, in order of preference; the reasons of all that do not.
Expected<gpu::Context> openFirst(const DeviceChoice& choice) {
  std::string reasons;
  for (const gpu::Device& device : gpu::preferredOrder(gpu::listDevices())) {
    if (!wanted(device, choice)) continue;
    Expected<gpu::Context> context = openWanted(device, choice);
    if (context.ok()) return context;
    reasons += (reasons.empty() ? "" : "; ") + describe(device) + ": " + context.status().message();
  }
  if (reasons.empty()) reasons = "no device " + std::to_string(choice.index) + "; see --list-devices";
  return Status(Code::kUnavailable, "no OpenGL 4.5 context: " + reasons);
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

Expected<DeviceChoice> parseDeviceChoice(const std::string& text) {
  if (text == "auto") return DeviceChoice{};
  if (text == "software") return DeviceChoice{DeviceChoice::Kind::kSoftware, 0};
  const bool digits = !text.empty() && text.size() < 4 && text.find_first_not_of("0123456789") == std::string::npos;
  if (digits) return DeviceChoice{DeviceChoice::Kind::kIndex, std::stoi(text)};
  return invalid("device", "device is \"" + text + "\"; want auto, software or an index of --list-devices");
}

std::vector<std::string> describeDevices(const DeviceChoice& choice) {
  std::vector<gpu::Device> devices = gpu::listDevices();
  std::vector<std::string> lines(devices.size());
  bool chosen = false;
  for (const gpu::Device& device : gpu::preferredOrder(devices)) {
    std::string& line = lines[std::size_t(device.index)];
    line = describe(device) + ": ";
    const Expected<gpu::Context> context = openWanted(device, choice);
    if (!context.ok()) {
      line += "not usable: " + context.status().message();
      continue;
    }
    line += context->capabilities().renderer + ", OpenGL " + context->capabilities().version;
    line += context->device().software ? ", software" : ", hardware";
    const bool used = !chosen && wanted(device, choice);
    chosen = chosen || used;
    line += used                     ? ": would be used"
            : wanted(device, choice) ? ": works, comes after another"
                                     : ": works, not asked for";
  }
  return lines;
}

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
