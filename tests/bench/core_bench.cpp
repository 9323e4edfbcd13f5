// The lighting core's stages, as the engine times them: a light of 33,446 triangles that moves every tick, at 32^3 and
// 64^3 with as many iterations as the grid is long. "transport" reads the volume back, "frames" renders 640 x 360 from
// a still camera, "nearField" with GATHER, "streams" a small room as streams have it, with shadows and with all
// bounces. Times are from submit to done; the counters are milliseconds per stage, medians and the least, and, named by
// what they count per second, how much a stage does: triangles voxelized, cells gathered, bytes that propagation reads
// and writes at the least, and, where the device is software, what share those are of what memory copies in the same
// time.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "bench/rows.h"
#include "core_scene.h"
#include "reference/room.h"

namespace {

using namespace lpv;

glm::dvec3 position(int step) {
  return {0.7 * std::cos(0.1 * step), 1.5 + 0.3 * std::sin(0.07 * step), 0.7 * std::sin(0.1 * step)};
}

TickRequest request(const Scene& scene, int step) {
  TickRequest r;
  r.session = 1;
  r.scene = bench::movedTo(scene, position(step));
  r.transported = true;
  return r;
}

FrameRequest frame(bool still) {
  FrameRequest f;
  f.view = still ? 1 : 0;
  f.camera.eye = {1.8, 1.6, 1.8};
  f.camera.target = {0.0, 1.2, 0.0};
  f.size = {640, 360};
  return f;
}

/// What the ticks of one benchmark took, stage by stage.
class Stages {
 public:
  void add(const TickReport& report) {
    for (const StageTime& time : report.stages) milliseconds_[nameOf(time.stage)].push_back(1e3 * time.seconds);
  }
  /// The median of every stage as a counter with its name, and the least, which what else the machine does moves least.
  void count(benchmark::State& state) const {
    for (const auto& [name, all] : milliseconds_) {
      state.counters[name] = bench::medianOf(all);
      state.counters[name + "_least"] = *std::min_element(all.begin(), all.end());
    }
  }
  /// What one tick does in a stage, per second of the stage's median.
  void countRate(benchmark::State& state, const char* name, double amount, Stage stage) const {
    const auto found = milliseconds_.find(nameOf(stage));
    if (found != milliseconds_.end()) state.counters[name] = amount / (1e-3 * bench::medianOf(found->second));
  }

 private:
  std::map<std::string, std::vector<double>> milliseconds_;
};

/// Bytes read and written per second by memcpy of more than caches hold.
double copyBandwidth() {
  static const double bandwidth = [] {
    constexpr std::size_t kBytes = std::size_t(128) << 20;
    const std::vector<char> from(kBytes, 1);
    std::vector<char> to(kBytes);
    double best = 0.0;
    for (int i = 0; i < 5; ++i) {
      const auto begun = std::chrono::steady_clock::now();
      std::memcpy(to.data(), from.data(), kBytes);
      benchmark::DoNotOptimize(to.data());
      const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begun;
      best = std::max(best, 2.0 * double(kBytes) / seconds.count());
    }
    return best;
  }();
  return bandwidth;
}

double cellsOf(const Scene& scene) {
  const glm::dvec3 dims(scene.grid.dims);
  return dims.x * dims.y * dims.z;
}

void transport(benchmark::State& state) {
  const Scene scene = bench::roomWith(bench::statue(), position(0), int(state.range(0)));
  bench::tick(request(scene, 0));
  int step = 1;
  Stages stages;
  for (auto _ : state) stages.add(bench::tick(request(scene, step++)).report);
  stages.count(state);
  const double triangles = double(bench::statue()->triangles.size());
  stages.countRate(state, "triangles_per_s", triangles, Stage::kVoxelize);
  constexpr double kBytesPerStep = 48.0;  // of a cell: four floats read, added and written
  const double bytes = kBytesPerStep * cellsOf(scene) * scene.options.iterationsFor(scene.grid);
  stages.countRate(state, "propagated_bytes_per_s", bytes, Stage::kPropagate);
  if (bench::engine().device().software) {
    state.counters["propagated_share_of_copying"] = state.counters["propagated_bytes_per_s"].value / copyBandwidth();
  }
}

/// The whole grid by GATHER.
void gather(benchmark::State& state) {
  Scene scene = bench::roomWith(bench::statue(), position(0), int(state.range(0)));
  scene.options.transport = Transport::kGather;
  scene.options.followTransport();
  scene.options.visibility = Visibility::kOff;
  bench::tick(request(scene, 0));
  int step = 1;
  Stages stages;
  for (auto _ : state) stages.add(bench::tick(request(scene, step++)).report);
  stages.count(state);
  stages.countRate(state, "triangles_per_s", double(bench::statue()->triangles.size()), Stage::kVoxelize);
  stages.countRate(state, "cells_per_s", cellsOf(scene), Stage::kGather);
}

/// As many lights, of which one moves.
void lights(benchmark::State& state) {
  const Scene scene = bench::roomOfLights(int(state.range(0)), 32);
  int step = 0;
  const auto moved = [&] {
    auto next = std::make_shared<Scene>(scene);
    auto lamp = std::make_shared<Light>(*scene.lights.at("light"));
    lamp->transform.translation = position(step);
    next->lights["light"] = lamp;
    next->revision = std::uint64_t(++step);
    TickRequest r;
    r.session = 1;
    r.scene = next;
    r.transported = true;
    return bench::tick(std::move(r)).report;
  };
  moved();
  Stages stages;
  for (auto _ : state) stages.add(moved());
  stages.count(state);
}

void frames(benchmark::State& state) {
  const Scene scene = bench::roomWith(bench::statue(), position(0), int(state.range(0)));
  int step = 0;
  Stages stages;
  for (auto _ : state) {
    TickRequest r = request(scene, step++);
    r.transported = false;
    r.frames = {frame(true)};
    stages.add(bench::tick(std::move(r)).report);
  }
  stages.count(state);
}

/// GATHER with the statue near walls: the near field at some pixels, as streams have it, or at each.
void nearField(benchmark::State& state) {
  Scene scene = bench::roomWith(bench::statue(), position(0), 32);
  scene.options.transport = Transport::kGather;
  scene.options.followTransport();
  int step = 0;
  Stages stages;
  for (auto _ : state) {
    TickRequest r = request(scene, step++);
    r.transported = false;
    r.frames = {frame(true)};
    r.frames[0].reduced = state.range(0) != 0;
    stages.add(bench::tick(std::move(r)).report);
  }
  stages.count(state);
}

/// A stream's frame of the small room, the lamp moving; with shadows, and with as many bounces as are seen.
void streams(benchmark::State& state) {
  Scene scene = reference::smallRoom(32);
  scene.options = {};
  scene.options.followTransport();
  scene.options.visibility = state.range(0) > 0 ? Visibility::kOn : Visibility::kOff;
  scene.options.bounces = state.range(0) > 1 ? kAutoBounces : 0;
  const glm::dvec3 lamp = scene.lights.begin()->second->transform.translation;
  int step = 0;
  Stages stages;
  for (auto _ : state) {
    TickRequest r;
    r.session = 2;
    r.scene = bench::movedTo(scene, lamp + glm::dvec3(0.1 * std::sin(0.3 * step++), 0.0, 0.0));
    r.frames = {frame(true)};
    r.frames[0].camera = reference::roomCamera();
    r.frames[0].size = {320, 180};
    r.frames[0].reduced = true;
    stages.add(bench::tick(std::move(r)).report);
  }
  stages.count(state);
}

constexpr auto kUnit = benchmark::kMillisecond;
BENCHMARK(transport)->Arg(32)->Arg(64)->UseRealTime()->Unit(kUnit);
BENCHMARK(gather)->Arg(32)->Arg(64)->UseRealTime()->Unit(kUnit);
BENCHMARK(lights)->Arg(16)->Arg(64)->UseRealTime()->Unit(kUnit);
BENCHMARK(frames)->Arg(32)->Arg(64)->UseRealTime()->Unit(kUnit);
BENCHMARK(nearField)->ArgName("reduced")->Arg(0)->Arg(1)->UseRealTime()->Unit(kUnit);
BENCHMARK(streams)->ArgName("features")->Arg(0)->Arg(1)->Arg(2)->UseRealTime()->Unit(kUnit);

}  // namespace

BENCHMARK_MAIN();
