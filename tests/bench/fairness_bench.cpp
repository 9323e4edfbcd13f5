// Sessions side by side on one device: how often a small session (a quad as light, 32^3, GATHER, a frame of 640x360)
// gets its ticks alone, and beside a large one whose light moves every tick. "back to back": its next tick is asked for
// when the last one is there; "paced": as sessions do, at most 30 a second. Intervals are medians; beside them the
// longest piece of the large one, which is how long the device was away at a stretch, and how its ticks were predicted.
// "largest admitted": as many lights as admission lets a session have on this device (--max-tick-seconds), statues all.
//
//   fairness_bench [--large NAME] [--ticks N] [--rows FILE]
//
// LPV_BENCH_LUCY names the PLY file of Stanford's Lucy; a bumpy sphere of as many triangles takes its place.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <future>
#include <mutex>
#include <thread>
#include <vector>

#include "bench/rows.h"
#include "core_scene.h"
#include "reference/meshes.h"
#include "scene/error_goal.h"
#include "scene/workload.h"
#include "session/limits.h"

namespace {

using namespace lpv;
using SteadyClock = std::chrono::steady_clock;

constexpr std::chrono::microseconds kPace{33333};
constexpr SessionKey kSmall = 1, kLarge = 2;
const Limits kLimits;  // lpvd's own

glm::dvec3 position(int step) {
  return {0.5 * std::cos(0.1 * step), 1.4 + 0.2 * std::sin(0.07 * step), 0.5 * std::sin(0.1 * step)};
}

struct Load {
  std::string name;
  MeshPtr mesh;
  int cells = 32;
  Transport transport = Transport::kGather;
  bool volume = false;
  glm::ivec2 frame{0};
  int lights = 1;
  bool mostLights = false;  ///< as many as are admitted
};

/// The stage of a tick's longest piece.
const char* longestOf(const TickReport& report) { return report.longestStage ? nameOf(*report.longestStage) : "other"; }

Scene sceneOf(const Load& load) {
  Scene scene = bench::roomWith(load.mesh, position(0), load.cells);
  for (int i = 1; i < load.lights; ++i) {
    auto light = std::make_shared<Light>(*scene.lights.at("light"));
    light->name += std::to_string(i);
    scene.lights[light->name] = light;
  }
  LightingSettings options;
  options.transport = load.transport;
  if (load.transport != Transport::kPropagate) options.followTransport();
  options.grid = scene.options.grid;
  options.visibility = Visibility::kOff;  // with shadows and bounces one tick of the largest frame takes four minutes
  options.bounces = 0;
  scene.options = options;
  return scene;
}

TickRequest requestOf(const Load& load, const Scene& scene, SessionKey session, int step) {
  TickRequest request;
  request.session = session;
  request.scene = bench::movedTo(scene, position(step));
  request.transported = load.volume;
  if (load.frame.x == 0) return request;
  FrameRequest frame;
  frame.view = 1;
  frame.camera.eye = {1.8, 1.6, 1.8};
  frame.camera.target = {0.0, 1.2, 0.0};
  frame.size = load.frame;
  request.frames = {frame};
  return request;
}

std::vector<Load> largeOnes() {
  const MeshPtr statue = bench::statue();
  return {{"propagate 128, flux statue, volume", statue, 128, Transport::kPropagate, true},
          {"gather 128, flux statue, volume", statue, 128, Transport::kGather, true},
          {"gather 128, flux statue, frame 4096x4096", statue, 128, Transport::kGather, false, glm::ivec2(4096)},
          {"direct 128, quad, frame 4096x4096", reference::quad(), 128, Transport::kDirect, false, glm::ivec2(4096)},
          {"gather 32, statue, frame 640x360", statue, 32, Transport::kGather, false, {640, 360}},
          {"largest admitted, gather 128", statue, 128, Transport::kGather, true, {}, 1, true}};
}

double predictedSeconds(const Load& load) {
  const Scene scene = sceneOf(load);
  Workload workload(resolved(scene.options), scene.grid);
  for (const auto& [name, light] : scene.lights) workload.add(*light);
  for (const auto& [name, surface] : scene.surfaces) workload.add(*surface);
  return bench::engine().predict(workload).seconds;
}

/// `load` with as many lights as admission lets it have, by what the device has been seen to take.
Load largestAdmitted(Load load) {
  int refused = kLimits.maxLights + 1;
  for (int step = kLimits.maxLights; step > 0; step /= 2) {
    Load more = load;
    more.lights = load.lights + step;
    if (more.lights >= refused) continue;
    if (predictedSeconds(more) <= kLimits.maxTickSeconds) {
      load = more;
    } else {
      refused = more.lights;
    }
  }
  return load;
}

/// Ticks of the large session, one after the other, until told to stop.
class Neighbour {
 public:
  explicit Neighbour(const Load& load) : load_(load), scene_(sceneOf(load)), thread_([this] { run(); }) {}
  ~Neighbour() {
    stop_ = true;
    thread_.join();
    bench::engine().forget(kLarge);
  }
  /// Its ticks that have ended, and the one with the longest piece.
  std::pair<int, TickReport> seen() const {
    const std::lock_guard lock(mutex_);
    return {ticks_, worst_};
  }

 private:
  void run() {
    for (int step = 0; !stop_; ++step) {
      const TickReport report = bench::tick(requestOf(load_, scene_, kLarge, step)).report;
      const std::lock_guard lock(mutex_);
      if (step == 0 || report.longestPiece > worst_.longestPiece) worst_ = report;
      ++ticks_;
    }
  }

  const Load load_;
  const Scene scene_;
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;
  int ticks_ = 0;  ///< that have ended
  TickReport worst_;
  std::thread thread_;
};

struct Intervals {
  double median = 0.0;
  double longest = 0.0;
};

/// Seconds from one result of the small session to the next.
Intervals intervals(const Load& small, int ticks, bool paced) {
  const Scene scene = sceneOf(small);
  std::vector<double> out;
  auto last = SteadyClock::now();
  for (int step = 0; step <= ticks; ++step) {
    const auto begin = SteadyClock::now();
    bench::tick(requestOf(small, scene, kSmall, step));
    const auto now = SteadyClock::now();
    if (step > 0) out.push_back(std::chrono::duration<double>(now - last).count());
    last = now;
    if (paced) std::this_thread::sleep_until(begin + kPace);
  }
  return {bench::medianOf(out), *std::max_element(out.begin(), out.end())};
}

/// The large session by itself: its first tick, which compiles programs, and its second.
void alone(const Load& large, bench::Rows* rows) {
  const Scene scene = sceneOf(large);
  for (int step = 0; step < 2; ++step) {
    const auto begin = SteadyClock::now();
    const TickReport report = bench::tick(requestOf(large, scene, kLarge, step)).report;
    const double seconds = std::chrono::duration<double>(SteadyClock::now() - begin).count();
    rows->add(
        {large.name,
         "large session alone",
         {{"lights", double(large.lights)}, {"tick", double(step + 1)}, {"longest piece is of", longestOf(report)}},
         {{"tick_ms", 1e3 * seconds},
          {"longest_piece_ms", 1e3 * report.longestPiece},
          {"predicted_ms", 1e3 * predictedSeconds(large)},
          {"pieces", double(report.pieces)}}});
  }
  bench::engine().forget(kLarge);
}

bench::Row rowOf(const Load& large, bool paced, const Intervals& alone, const Intervals& beside, const Neighbour& by) {
  const auto [ticks, worst] = by.seen();
  return {large.name,
          "fairness",
          {{"lights", double(large.lights)}, {"small session's ticks", paced ? "paced" : "back to back"}},
          {{"alone_ms", 1e3 * alone.median},
           {"beside_ms", 1e3 * beside.median},
           {"times", beside.median / alone.median},
           {"alone_longest_ms", 1e3 * alone.longest},
           {"beside_longest_ms", 1e3 * beside.longest},
           {"large_ticks", double(ticks)},
           {"large_longest_piece_ms", 1e3 * worst.longestPiece},
           {"largest_prediction_ms", 1e3 * worst.largestPrediction}}};
}

void compare(const Load& small, Load large, int ticks, bench::Rows* rows) {
  alone(large, rows);
  if (large.mostLights) {
    large = largestAdmitted(large);
    alone(large, rows);
  }
  const Intervals byItself = intervals(small, ticks, false), byItselfPaced = intervals(small, ticks, true);
  Neighbour neighbour(large);
  std::this_thread::sleep_for(std::chrono::seconds(2));
  rows->add(rowOf(large, false, byItself, intervals(small, ticks, false), neighbour));
  rows->add(rowOf(large, true, byItselfPaced, intervals(small, ticks, true), neighbour));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Ticks of a small session beside a large one");
  std::string wanted;
  std::string rowsFile;
  int ticks = 100;
  app.add_option("--large", wanted, "only those whose name contains this");
  app.add_option("--ticks", ticks, "of the small session, per measurement");
  app.add_option("--rows", rowsFile, bench::kRowsHelp);
  CLI11_PARSE(app, argc, argv);
  bench::Rows rows(rowsFile, bench::engine().device().name);
  const Load small{"quad", reference::quad(), 32, Transport::kGather, false, {640, 360}};
  for (const Load& large : largeOnes()) {
    if (large.name.find(wanted) != std::string::npos) compare(small, large, ticks, &rows);
  }
}
