#include "visibility_costs.h"

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <functional>

#include "core_scene.h"
#include "gpu/gl.h"
#include "living_room.h"
#include "lpv/resources/occluders.h"
#include "reference/meshes.h"
#include "reference/room.h"

namespace lpv::bench {

namespace {

double seconds() {
  timespec t{};
  clock_gettime(deviceContext().capabilities().software ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + std::ptrdiff_t(values.size() / 2));
  return values[values.size() / 2];
}

double secondsOf(const std::function<void()>& work) {
  const double begin = seconds();
  work();
  return seconds() - begin;
}

/// One way and the other in turns; the first time, which compiles, does not count.
Compared inTurns(int repeats, const std::function<void()>& triangles, const std::function<void()>& coverage,
                 double per = 1.0) {
  triangles();
  coverage();
  std::vector<double> first, second;
  for (int i = 0; i < repeats; ++i) {
    first.push_back(secondsOf(triangles) / per);
    second.push_back(secondsOf(coverage) / per);
  }
  return {median(first), median(second)};
}

/// The same scene of meshes that nobody has seen, so that no tree of them is kept.
Scene withNewMeshes(const Scene& scene) {
  Scene out = scene;
  for (auto& [name, surface] : out.surfaces) {
    auto copy = std::make_shared<Surface>(*surface);
    copy->mesh = std::make_shared<Mesh>(*surface->mesh);
    surface = copy;
  }
  return out;
}

const std::string& nameOfLargest(const Scene& scene) {
  return std::ranges::max_element(scene.surfaces, {}, [](const auto& s) { return s.second->mesh->triangles.size(); })
      ->first;
}

void moveALittle(Scene& scene, const std::string& name) {
  auto moved = std::make_shared<Surface>(*scene.surfaces.at(name));
  moved->transform.translation.x += 0.01;
  scene.surfaces[name] = moved;
}

CostScene costScene(const std::string& name, Scene scene) {
  std::size_t triangles = 0;
  for (const auto& [key, surface] : scene.surfaces) triangles += surface->mesh->triangles.size();
  return {name, std::move(scene), triangles};
}

}  // namespace

std::vector<CostScene> costScenes(int cells) {
  const char* room = std::getenv("LPV_BENCH_ROOM");
  const bool lucy = std::getenv("LPV_BENCH_LUCY") != nullptr;
  std::vector<CostScene> out;
  out.push_back(costScene("two boxes", reference::smallRoom(cells)));
  out.push_back(costScene("bumpy sphere", roomAround(reference::bumpySphere(1000), cells)));
  out.push_back(costScene(lucy ? "Lucy" : "bumpy sphere", roomAround(statue(), cells)));
  if (room != nullptr) {
    out.push_back(costScene("living room", gltfRoom(room, cells)));
  } else {
    out.push_back(costScene("bumpy sphere", roomAround(reference::bumpySphere(180000), cells)));
  }
  return out;
}

std::size_t largestOf(const Scene& scene) { return scene.surfaces.at(nameOfLargest(scene))->mesh->triangles.size(); }

Compared VisibilityCosts::ray(const Scene& scene, bool toLamp) {
  GpuOccluders occluders;
  occluders.update(occludersOf(scene), scene.grid).runToEnd();
  const GpuCoverage coverage{CoverageGrid(occludersOf(scene), scene.grid)};
  std::vector<ShadowRay> rays = shadowRays(scene, toLamp);
  const gpu::Buffer between = rayBuffer(rays), answers = answerBuffer(rays.size());
  std::ranges::transform(rays, rays.begin(),
                         [&](const ShadowRay& ray) { return marched(ray, variant_.start, 2 * scene.grid.dims); });
  const gpu::Buffer through = rayBuffer(rays);
  return inTurns(
      repeats_,
      [&] {
        occluders.bind();
        ways_.triangles().dispatch(between, answers);
      },
      [&] {
        coverage.bind();
        ways_.coverage(variant_.blend).dispatch(through, answers);
      },
      double(rays.size()));
}

Compared VisibilityCosts::make(const Scene& scene) {
  return inTurns(
      repeats_,
      [&] {
        const Scene anew = withNewMeshes(scene);
        GpuOccluders occluders;
        occluders.update(occludersOf(anew), anew.grid).runToEnd();
        glFinish();
      },
      [&] {
        const Scene anew = withNewMeshes(scene);
        const GpuCoverage coverage{CoverageGrid(occludersOf(anew), anew.grid)};
        glFinish();
      });
}

Compared VisibilityCosts::move(const Scene& scene) {
  Scene first = scene, second = scene;
  const std::string& name = nameOfLargest(scene);
  GpuOccluders occluders;
  occluders.update(occludersOf(first), first.grid).runToEnd();
  CoverageGrid grid(occludersOf(second), second.grid);
  GpuCoverage coverage(grid);
  const auto index = std::size_t(std::distance(scene.surfaces.begin(), scene.surfaces.find(name)));
  return inTurns(
      repeats_,
      [&] {
        moveALittle(first, name);
        occluders.update(occludersOf(first), first.grid).runToEnd();
        glFinish();
      },
      [&] {
        moveALittle(second, name);
        coverage.update(grid, grid.move(index, occludersOf(second)[index]));
        glFinish();
      });
}

VisibilityBytes bytesOf(const Scene& scene) {
  GpuOccluders occluders;
  occluders.update(occludersOf(scene), scene.grid).runToEnd();
  const CoverageGrid grid(occludersOf(scene), scene.grid);
  return {occluders.bytes(), GpuCoverage(grid).bytes(), grid.lineBytes()};
}

}  // namespace lpv::bench
