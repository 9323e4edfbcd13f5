#include "bench/service_load.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>

#include "bench/load_seen.h"
#include "bench/load_session.h"
#include "lpv/client.h"
#include "lpv/editor.h"
#include "lpv/watch.h"
#include "rpc/support/server_process.h"

namespace lpv::bench {
namespace {

using Steady = std::chrono::steady_clock;

constexpr double kMoreWarmUp = 0.2;  // seconds at a time, until a result has come
constexpr std::chrono::minutes kWarmUpPatience{2};
constexpr std::chrono::minutes kStillPatience{1};

v1::FrameSubscription frameSubscription(const Load& load, const client::Editor& editor) {
  v1::FrameSubscription subscription;
  subscription.set_session("sessions/" + client::sessionId(editor.session()));
  *subscription.mutable_client() = editor.identity();
  subscription.set_width(load.width);
  subscription.set_height(load.height);
  if (load.orbit) {
    subscription.set_camera_name(kCamera);
  } else if (load.camera.size() == 6) {
    v1::Camera* camera = subscription.mutable_camera()->mutable_camera();
    setVec(camera->mutable_eye(), load.camera[0], load.camera[1], load.camera[2]);
    setVec(camera->mutable_target(), load.camera[3], load.camera[4], load.camera[5]);
    camera->set_fov_degrees(kFov);
  }
  return subscription;
}

/// What the stream shows of the light on its place, linear, and what references of that need: frame.exr and scene.json.
Status writeStill(const Load& load, LoadSession& session, const client::Editor& editor) {
  const auto ack = session.client().applyEdit(session.id(), session.stillEdit());
  if (!ack) return ack.status();
  v1::FrameSubscription subscription = frameSubscription(load, editor);
  subscription.set_format(v1::FRAME_FORMAT_EXR);
  std::promise<std::string> shown;
  bool seen = false;
  {
    const client::FrameWatcher watcher(session.client(), subscription, [&](const client::FrameResult& frame) {
      if (seen || frame.header.result().revision() < ack->revision()) return;
      seen = true;
      shown.set_value(frame.file);
    });
    auto file = shown.get_future();
    if (file.wait_for(kStillPatience) != std::future_status::ready)
      return Status(Code::kDeadlineExceeded, "no still frame came");
    std::filesystem::create_directories(load.stillFolder);
    const std::filesystem::path folder = load.stillFolder;
    std::ofstream(folder / "frame.exr", std::ios::binary) << file.get();
    std::ofstream(folder / "scene.json") << session.stillScene();
  }
  return {};
}

/// A load under way: its watchers, and the edits it sends.
class Run {
 public:
  Run(const Load& load, LoadSession& session, const client::Editor& editor)
      : load_(load),
        session_(session),
        edits_(
            editor, [this](const v1::EditAck& ack) { seen_.acknowledged(ack.revision()); }, {}, latency_) {
    if (load.watchFrames) {
      frames_.emplace(
          session.client(), frameSubscription(load, editor),
          [this](const client::FrameResult& frame) { seen_.frame(frame); }, hooks());
    }
    if (!load.watchVolume) return;
    v1::VolumeSubscription subscription;
    subscription.set_session("sessions/" + session.id());
    volumes_.emplace(session.client(), subscription, [this](const client::VolumeResult&) { seen_.volume(); });
  }

  /// Sends edits at the wanted rate for `seconds`; returns how many.
  Expected<int> drive(double seconds) {
    const auto begin = Steady::now();
    const auto interval = std::chrono::duration<double>(1.0 / load_.rate);
    int sent = 0;
    while (Steady::now() - begin < std::chrono::duration<double>(seconds)) {
      const auto ack = edits_.send(session_.step(step_++));
      if (!ack) return ack.status();
      ++sent;
      std::this_thread::sleep_until(begin + interval * sent);
    }
    return sent;
  }

  /// The same load, uncounted, until the server has all that a new session needs once.
  Status warmUp() {
    const auto end = Steady::now() + kWarmUpPatience;
    Expected<int> sent = drive(load_.warmUpSeconds);
    while (sent && !seen_.any() && Steady::now() < end) sent = drive(kMoreWarmUp);
    if (!sent) return sent.status();
    return seen_.any() ? Status() : Status(Code::kDeadlineExceeded, "nothing came");
  }

  Expected<Measured> measure() {
    const auto before = session_.client().stats();
    if (!before) return before.status();
    const int warmUpEdits = step_;
    seen_.start();
    const auto begin = Steady::now();
    const auto sent = drive(load_.seconds);
    if (!sent) return sent.status();
    Measured out;
    out.seconds = std::chrono::duration<double>(Steady::now() - begin).count();
    const auto after = session_.client().stats();
    if (!after) return after.status();
    out.edits = *sent;
    out.ticks = double(after->ticks() - before->ticks());
    seen_.report(&out);
    reportLatency(std::size_t(warmUpEdits), &out);
    return out;
  }

 private:
  client::WatchHooks hooks() const {
    client::WatchHooks hooks;
    hooks.latency = latency_;
    return hooks;
  }

  /// Every edit has one latency, in the order in which they were sent.
  void reportLatency(std::size_t warmUpEdits, Measured* out) const {
    out->samples = latency_->seconds();
    out->warmUpSamples = std::min(warmUpEdits, out->samples.size());
    const auto counted = out->samples.begin() + std::ptrdiff_t(out->warmUpSamples);
    out->warmUpLatency = client::summarize({out->samples.begin(), counted});
    out->latency = client::summarize({counted, out->samples.end()});
  }

  const Load& load_;
  LoadSession& session_;
  LoadSeen seen_;
  std::shared_ptr<client::LatencyLog> latency_ = std::make_shared<client::LatencyLog>();
  int step_ = 0;
  client::EditStream edits_;
  std::optional<client::FrameWatcher> frames_;
  std::optional<client::VolumeWatcher> volumes_;
};

Expected<Measured> measure(const Load& load, const std::string& address) {
  client::ConnectOptions options;
  options.address = address;
  const auto client = client::Client::connect(options);
  if (!client) return client.status();
  LoadSession session(load, *client, address);
  if (Status s = session.prepare(); !s.ok()) return s;
  const auto editor = client::Editor::join(session.client(), session.id(), "bench");
  if (!editor) return editor.status();
  Run run(load, session, *editor);
  if (Status s = run.warmUp(); !s.ok()) return s;
  Expected<Measured> out = run.measure();
  if (!out) return out;
  if (!load.stillFolder.empty()) {
    if (Status s = writeStill(load, session, *editor); !s.ok()) return s;
  }
  const auto info = session.client().serverInfo();
  const auto scene = session.client().session(session.id());
  if (!info || !scene) return Status(Code::kUnavailable, "the server went away");
  out->device = info->device().name();
  out->version = "lpvd " + info->version();
  out->lightTriangles = session.lightTriangles();
  out->surfaceTriangles = scene->triangle_count() - out->lightTriangles;
  return out;
}

}  // namespace

Expected<Measured> run(const Load& load) {
  if (!load.server.empty()) return measure(load, load.server);
  try {
    const rpc::ServerProcess own({"--log-level", "warn"});
    return measure(load, own.address());
  } catch (const std::runtime_error& error) {
    return Status(Code::kUnavailable, error.what());
  }
}

}  // namespace lpv::bench
