// The lighting core's stages, as the engine times them: a light of 33,446 triangles that moves every tick, at 32^3 and
// 64^3 with as many iterations as the grid is long. "transport" reads the volume back, "frames" renders 640 x 360 from
// a still camera, "nearField" with GATHER. Times are from submit to done; the counters are milliseconds per stage.

#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>

#include "core_scene.h"

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

/// Milliseconds of every stage as counters, averaged over the ticks.
void countStages(benchmark::State& state, const TickReport& report) {
  for (const StageTime& time : report.stages) {
    benchmark::Counter& counter = state.counters[nameOf(time.stage)];
    counter.flags = benchmark::Counter::kAvgIterations;
    counter.value += 1e3 * time.seconds;
  }
}

void transport(benchmark::State& state) {
  const Scene scene = bench::roomWith(bench::statue(), position(0), int(state.range(0)));
  bench::tick(request(scene, 0));
  int step = 1;
  for (auto _ : state) countStages(state, bench::tick(request(scene, step++)).report);
}

void frames(benchmark::State& state) {
  const Scene scene = bench::roomWith(bench::statue(), position(0), int(state.range(0)));
  int step = 0;
  for (auto _ : state) {
    TickRequest r = request(scene, step++);
    r.transported = false;
    r.frames = {frame(true)};
    countStages(state, bench::tick(std::move(r)).report);
  }
}

/// GATHER with the statue near walls: the near field at some pixels, as streams have it, or at each.
void nearField(benchmark::State& state) {
  Scene scene = bench::roomWith(bench::statue(), position(0), 32);
  scene.options.transport = Transport::kGather;
  scene.options.followTransport();
  int step = 0;
  for (auto _ : state) {
    TickRequest r = request(scene, step++);
    r.transported = false;
    r.frames = {frame(true)};
    r.frames[0].reduced = state.range(0) != 0;
    countStages(state, bench::tick(std::move(r)).report);
  }
}

constexpr auto kUnit = benchmark::kMillisecond;
BENCHMARK(transport)->Arg(32)->Arg(64)->UseRealTime()->Unit(kUnit);
BENCHMARK(frames)->Arg(32)->Arg(64)->UseRealTime()->Unit(kUnit);
BENCHMARK(nearField)->ArgName("reduced")->Arg(0)->Arg(1)->UseRealTime()->Unit(kUnit);

}  // namespace

BENCHMARK_MAIN();
