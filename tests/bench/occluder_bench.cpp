// Shadow rays: nanoseconds per ray of visibility/occluders.glsl on the first device, and what the trees take to make
// and to keep. Four scenes; rays of two cells, and rays to a lamp at the ceiling. Receivers are on all surfaces of a
// grid of 32 cells, 32 rays from each cell beside one another, as a frame's blocks of pixels have them.
//
// LPV_BENCH_LUCY names the PLY file of Stanford's Lucy; a bumpy sphere of as many triangles takes its place.

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <map>
#include <random>
#include <span>

#include "core_scene.h"
#include "gpu/context.h"
#include "gpu/gl.h"
#include "gpu/program.h"
#include "lpv/resources/occluders.h"
#include "reference/meshes.h"
#include "reference/room.h"
#include "shaders/layout.h"

namespace {

using namespace lpv;

constexpr std::size_t kRays = 1 << 16, kRaysOfCell = 32;

void makeContext() {
  for (const gpu::Device& device : gpu::preferredOrder(gpu::listDevices())) {
    Expected<gpu::Context> made = gpu::Context::make(device, false);
    if (!made.ok()) continue;
    static gpu::Context context = std::move(*made);
    context.makeCurrent();
    std::cout << reinterpret_cast<const char*>(glGetString(GL_RENDERER)) << "\n";
    return;
  }
  std::cerr << "no device\n";
  std::exit(1);
}

/// The room with a mesh instead of its two boxes, standing in the middle.
Scene roomAround(const MeshPtr& mesh) {
  Scene scene = reference::smallRoom(32);
  scene.surfaces.erase("tall");
  auto surface = std::make_shared<Surface>(*scene.surfaces.at("short"));
  const double size = 1.6 / std::max({mesh->bounds.extent().x, mesh->bounds.extent().y, mesh->bounds.extent().z});
  surface->mesh = mesh;
  surface->transform.scale = glm::dvec3(size);
  surface->transform.translation = -size * (surface->transform.rotation * mesh->bounds.centre());
  scene.surfaces["short"] = surface;
  return scene;
}

const std::vector<std::pair<std::string, Scene>>& scenes() {
  static const std::vector<std::pair<std::string, Scene>> all = {
      {"boxes", reference::smallRoom(32)},
      {"1000", roomAround(reference::bumpySphere(1000))},
      {"Lucy", roomAround(bench::statue())},
      {"180000", roomAround(reference::bumpySphere(180000))}};
  return all;
}

/// Points of all triangles in proportion to area, .0002 cells above them, cell by cell.
std::vector<glm::vec3> receivers(const Scene& scene, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::map<std::size_t, std::vector<glm::vec3>> byCell;
  for (const auto& [name, surface] : scene.surfaces) {
    const glm::dmat4 m = scene.grid.gridFromWorldMatrix() * surface->transform.worldFromObject();
    for (const glm::uvec3& t : surface->mesh->triangles) {
      glm::dvec3 c[3];
      for (int i = 0; i < 3; ++i) c[i] = glm::dvec3(m * glm::dvec4(glm::dvec3(surface->mesh->positions[t[i]]), 1.0));
      const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
      const double points = 20.0 * glm::length(normal) + share(random);
      for (int i = 0; i < int(points); ++i) {
        const double u = std::sqrt(share(random)), v = share(random);
        const glm::dvec3 p = c[0] * (1.0 - u) + c[1] * (u * (1.0 - v)) + c[2] * (u * v) +
                             double(layout::kShadowOffset) * glm::normalize(normal);
        byCell[scene.grid.index(glm::clamp(glm::ivec3(p), glm::ivec3(0), scene.grid.dims - 1))].emplace_back(p);
      }
    }
  }
  std::vector<glm::vec3> out;
  for (const auto& [cell, points] : byCell) {
    for (std::size_t i = 0; i < kRaysOfCell; ++i) out.push_back(points[i % points.size()]);
  }
  return out;
}

/// vec4 (from, light), vec4 (to, -) per ray, grid space.
std::vector<glm::vec4> rays(const Scene& scene, bool toLamp) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<double> share(-0.4, 0.4);
  const std::vector<glm::vec3> from = receivers(scene, random);
  std::vector<glm::vec4> out;
  for (std::size_t i = 0; i < kRays; ++i) {
    const glm::vec3& start = from[i % from.size()];
    const double x = share(random);
    const glm::vec3 lamp(scene.grid.gridFromWorld({x, 0.969, share(random)}));
    const float dx = normal(random), dy = normal(random);
    out.emplace_back(start, 0.0F);
    out.emplace_back(toLamp ? lamp : start + 2.0F * glm::normalize(glm::vec3(dx, dy, normal(random))), 0.0F);
  }
  return out;
}

gpu::Program& program() {
  static gpu::Program made = gpu::Program::computeOfText(
      "rays",
      "#include \"layout.h\"\n#define LPV_TRANSPARENT 0\n#include \"visibility/occluders.glsl\"\n"
      "layout(local_size_x = 128) in;\n"
      "layout(std430, binding = kTestIn) readonly buffer In { vec4 rays[]; };\n"
      "layout(std430, binding = kTestOut) writeonly buffer Out { vec2 seen[]; };\n"
      "void main() {\n  const uint i = gl_GlobalInvocationID.x;\n"
      "  int rounds = 0;\n"
      "  const float seenOf = transmitted(rays[2u * i].xyz, rays[2u * i + 1u].xyz, int(rays[2u * i].w), rounds).x;\n"
      "  seen[i] = vec2(seenOf, float(rounds));\n}\n",
      {});
  return made;
}

void shadowRays(benchmark::State& state) {
  const auto& [name, scene] = scenes()[std::size_t(state.range(0))];
  state.SetLabel(name + (state.range(1) != 0 ? ", to the lamp" : ", 2 cells"));
  GpuOccluders occluders;
  occluders.update(occludersOf(scene), scene.grid).runToEnd();
  const std::vector<glm::vec4> segments = rays(scene, state.range(1) != 0);
  const gpu::Buffer in("rays", gpu::bytesOf(std::span<const glm::vec4>(segments)));
  const gpu::Buffer out("seen", kRays * sizeof(glm::vec2));
  for (auto _ : state) {
    occluders.bind();
    in.bindStorage(layout::kTestIn);
    out.bindStorage(layout::kTestOut);
    program().dispatch(kRays / 128);
    glFinish();
  }
  std::vector<glm::vec2> seen(kRays);
  glGetNamedBufferSubData(out.id(), 0, GLsizeiptr(kRays * sizeof(glm::vec2)), seen.data());
  glm::dvec2 sum(0.0);
  float most = 0.0F;
  for (const glm::vec2& s : seen) {
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
  std::vector<glm::vec4> segments = rays(scene, state.range(1) != 0);
  std::vector<std::pair<glm::dvec3, glm::dvec3>> ends;
  for (std::size_t i = 0; i < segments.size(); i += 2)
    ends.emplace_back(scene.grid.worldFromGrid(segments[i]), scene.grid.worldFromGrid(segments[i + 1]));
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

BENCHMARK(shadowRays)
    ->ArgsProduct({{0, 1, 2, 3}, {0, 1}})
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(cpuRays)->ArgsProduct({{0, 1, 2, 3}, {0, 1}});
BENCHMARK(makeTree)->Arg(1000)->Arg(33446)->Arg(180000)->Arg(1000000)->Unit(benchmark::kMillisecond);
BENCHMARK(moveSurface)->Arg(10)->Arg(4000)->UseRealTime()->Unit(benchmark::kMicrosecond);

}  // namespace

int main(int argc, char** argv) {
  makeContext();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
