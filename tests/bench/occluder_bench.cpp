// Shadow rays: nanoseconds per ray of visibility/occluders.glsl on the first device, and what the trees take to make
// and to keep. Four scenes; rays of two cells, and rays to a lamp at the ceiling, from the surfaces of a grid of 32
// cells (shadow_rays.h).
//
// LPV_BENCH_LUCY names the PLY file of Stanford's Lucy; a bumpy sphere of as many triangles takes its place.

#include <benchmark/benchmark.h>

#include <iostream>

#include "core_scene.h"
#include "gpu/gl.h"
#include "lpv/resources/occluders.h"
#include "reference/meshes.h"
#include "reference/room.h"
#include "shadow_rays.h"

namespace {

using namespace lpv;

using bench::kRays;

const std::vector<std::pair<std::string, Scene>>& scenes() {
  static const std::vector<std::pair<std::string, Scene>> all = {
      {"boxes", reference::smallRoom(32)},
      {"1000", bench::roomAround(reference::bumpySphere(1000))},
      {"Lucy", bench::roomAround(bench::statue())},
      {"180000", bench::roomAround(reference::bumpySphere(180000))}};
  return all;
}

void shadowRays(benchmark::State& state) {
  const auto& [name, scene] = scenes()[std::size_t(state.range(0))];
  state.SetLabel(name + (state.range(1) != 0 ? ", to the lamp" : ", 2 cells"));
  GpuOccluders occluders;
  occluders.update(occludersOf(scene), scene.grid).runToEnd();
  static bench::RayProgram program = bench::trianglesProgram();
  const gpu::Buffer in = bench::rayBuffer(bench::shadowRays(scene, state.range(1) != 0));
  const gpu::Buffer out = bench::answerBuffer(kRays);
  for (auto _ : state) {
    occluders.bind();
    program.dispatch(in, out);
  }
  glm::dvec2 sum(0.0);
  float most = 0.0F;
  for (const glm::vec2& s : bench::answersOf(out)) {
    sum += glm::dvec2(s);
    most = std::max(most, s.y);
  }
  using benchmark::Counter;
  state.counters["open"] = sum.x / double(kRays);
  state.counters["rounds"] = sum.y / double(kRays);
  state.counters["most"] = double(most);
  state.counters["KiB"] = double(occluders.bytes()) / 1024.0;
  state.counters["s/ray"] = Counter(double(kRays), Counter::kIsIterationInvariantRate | Counter::kInvert);
}

void cpuRays(benchmark::State& state) {
  const auto& [name, scene] = scenes()[std::size_t(state.range(0))];
  state.SetLabel(name + (state.range(1) != 0 ? ", to the lamp" : ", 2 cells"));
  const Occluders occluders(scene);
  std::vector<std::pair<glm::dvec3, glm::dvec3>> ends;
  for (const bench::ShadowRay& ray : bench::shadowRays(scene, state.range(1) != 0))
    ends.emplace_back(scene.grid.worldFromGrid(ray.from), scene.grid.worldFromGrid(ray.to));
  std::size_t at = 0;
  for (auto _ : state) {
    const auto& [from, to] = ends[at++ % ends.size()];
    benchmark::DoNotOptimize(occluders.blocked(from, to, 0));
  }
}

void makeTree(benchmark::State& state) {
  const MeshPtr mesh = reference::bumpySphere(std::size_t(state.range(0)));
  std::size_t bytes = 0;
  for (auto _ : state) {
    const TriangleBvh bvh(*mesh);
    bytes = bvh.nodes.size() * sizeof(BvhNode) + bvh.triangles.size() * sizeof(BvhTriangle);
  }
  state.counters["bytes/triangle"] = double(bytes) / double(state.range(0));
}

/// One surface moves: what is above the meshes is made anew.
void moveSurface(benchmark::State& state) {
  Scene scene = scenes()[0].second;
  const auto count = state.range(0);
  for (int i = 0; i < count; ++i) {
    auto surface = std::make_shared<Surface>(*scene.surfaces.at("short"));
    surface->transform.translation = 0.01 * glm::dvec3(i % 10, i / 10 % 10, i / 100);
    scene.surfaces["s" + std::to_string(i)] = surface;
  }
  GpuOccluders occluders;
  for (auto _ : state) {
    auto moved = std::make_shared<Surface>(*scene.surfaces.at("short"));
    moved->transform.translation.x += 1e-3;
    scene.surfaces["short"] = moved;
    occluders.update(occludersOf(scene), scene.grid).runToEnd();
    glFinish();
  }
}

/// A surface of many triangles moves: it is placed anew.
void moveLargeSurface(benchmark::State& state) {
  Scene scene = scenes()[0].second;
  auto rock = std::make_shared<Surface>(*scene.surfaces.at("short"));
  rock->mesh = reference::bumpySphere(std::size_t(state.range(0)));
  GpuOccluders occluders;
  for (auto _ : state) {
    auto moved = std::make_shared<Surface>(*rock);
    rock->transform.translation.x += 1e-3;
    scene.surfaces["short"] = moved;
    occluders.update(occludersOf(scene), scene.grid).runToEnd();
    glFinish();
  }
}

BENCHMARK(shadowRays)
    ->ArgsProduct({{0, 1, 2, 3}, {0, 1}})
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(cpuRays)->ArgsProduct({{0, 1, 2, 3}, {0, 1}});
BENCHMARK(makeTree)->Arg(1000)->Arg(33446)->Arg(180000)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK(moveSurface)->Arg(10)->Arg(4000)->UseRealTime()->Unit(benchmark::kMicrosecond);
BENCHMARK(moveLargeSurface)->Arg(33446)->Arg(180000)->UseRealTime()->Unit(benchmark::kMicrosecond);

}  // namespace

int main(int argc, char** argv) {
  std::cout << bench::deviceContext().capabilities().renderer << "\n";
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
