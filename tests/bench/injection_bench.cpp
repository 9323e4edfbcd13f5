// The paper's Table 1: the time to put one area light into the grid, for dense sampling with 1, 100 and 1000 samples
// per triangle and for exact voxelization, by the compute and the raster injector, COUNT and FLUX. Programs are
// compiled beforehand; nothing is reused from one injection to the next. Ratios are of times of the same run.
//
//   injection_bench [--grids 32,64,128] [--mesh NAME] [--repeats N] [--rows FILE]
//
// LPV_BENCH_LUCY names the PLY file of Stanford's Lucy; a bumpy sphere of as many triangles takes its place.

#include <ctime>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>

#include "bench/rows.h"
#include "core_scene.h"
#include "gpu/context.h"
#include "gpu/gl.h"
#include "lpv/transport/inject.h"
#include "lpv/voxelize/voxelize.h"
#include "reference/meshes.h"

namespace {

using namespace lpv;
using bench::NamedMesh;

struct Way {
  std::string name;
  VoxelMethod method;
};

/// Milliseconds, medians over the repeats.
struct Cost {
  double wall = 0.0;
  double cpu = 0.0;     ///< of all threads: what a run beside others is compared by
  double inject = 0.0;  ///< wall of adding the finished voxels to the field
};

std::vector<Way> ways() {
  using enum InjectionMethod;
  return {{"dense 1", {Injection::kCount, kDense, 1}},       {"dense 100", {Injection::kCount, kDense, 100}},
          {"dense 1000", {Injection::kCount, kDense, 1000}}, {"raster COUNT", {Injection::kCount, kRaster, 0}},
          {"raster FLUX", {Injection::kFlux, kRaster, 0}},   {"COUNT", {Injection::kCount, kCompute, 0}},
          {"FLUX", {Injection::kFlux, kCompute, 0}}};
}

/// Turned away from the axes, its longest edge 70 % of the grid's.
EmittingLight placed(const MeshPtr& mesh, int cells) {
  EmittingLight light;
  light.mesh = mesh;
  light.radiance = glm::dvec3(1.0);
  const glm::dvec3 extent = mesh->bounds.extent();
  const double size = 0.7 * cells / std::max({extent.x, extent.y, extent.z});
  light.gridFromObject = glm::translate(glm::dmat4(1.0), glm::dvec3(0.5 * cells + 0.137)) *
                         glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1, 2, 3))) *
                         glm::scale(glm::dmat4(1.0), glm::dvec3(size)) *
                         glm::translate(glm::dmat4(1.0), -mesh->bounds.centre());
  return light;
}

double cpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void finish(GpuTask task) {
  task.runToEnd();
  glFinish();
}

class Table {
 public:
  explicit Table(int repeats) : repeats_(repeats) {
    // As many triangles a dispatch as it holds: told twice, since the clock learns no rate from a first sample.
    for (int i = 0; i < 2; ++i) clock_.add(Stage::kVoxelize, 1e-9, 1.0);
  }

  Cost measure(const MeshPtr& mesh, int cells, const VoxelMethod& method) {
    const EmittingLight light = placed(mesh, cells);
    LightField field({glm::dvec3(0.0), 1.0, glm::ivec3(cells)}, 1);
    finish(injector_.retire(field, {&clock_}));
    SceneResources resources;
    Scene scene;
    auto named = std::make_shared<Light>();
    named->mesh = mesh;
    scene.lights["light"] = named;
    finish(cache_.upload(scene, resources));
    const auto voxels = std::make_shared<LightVoxels>(cellsAround({light}, field.grid.dims), 1);
    voxels->source = {mesh, nullptr, light.gridFromObject, field.grid.dims, method};
    const Palette palette = choosePalette({light});
    std::vector<double> wall, cpu, inject;
    double spent = 0.0;
    for (int i = 0; i <= repeats_ || (spent < 0.2 && i < 200); ++i) {
      const double wall0 = wallSeconds(), cpu0 = cpuSeconds();
      finish(voxelizer_.run(field, *resources.meshes.at(mesh), nullptr, *voxels, {&clock_, 1.0}));
      const double wall1 = wallSeconds(), cpu1 = cpuSeconds();
      finish(injector_.add(field, {light}, {voxels}, palette, {&clock_}));
      const double wall2 = wallSeconds();
      finish(injector_.retire(field, {&clock_}));
      spent += wall1 - wall0;
      if (i == 0) continue;  // compiles
      wall.push_back(1e3 * (wall1 - wall0));
      cpu.push_back(1e3 * (cpu1 - cpu0));
      inject.push_back(1e3 * (wall2 - wall1));
    }
    return {bench::medianOf(wall), bench::medianOf(cpu), bench::medianOf(inject)};
  }

 private:
  int repeats_;
  StageClock clock_;
  Voxelizer voxelizer_;
  Injector injector_;
  SceneCache cache_;
};

int run(const std::vector<int>& grids, const std::string& only, int repeats, const std::string& rowsFile,
        gpu::Context& context) {
  bench::Rows rows(rowsFile, context.capabilities().renderer);
  Table table(repeats);
  for (const NamedMesh& mesh : bench::paperMeshes()) {
    if (!only.empty() && mesh.name.find(only) == std::string::npos) continue;
    for (const int cells : grids) {
      for (const Way& way : ways()) {
        const Cost cost = table.measure(mesh.mesh, cells, way.method);
        rows.add({mesh.name,
                  "injection",
                  {{"grid", double(cells)}, {"method", way.name}},
                  {{"triangles", double(mesh.mesh->triangles.size())},
                   {"wall_ms", cost.wall},
                   {"cpu_ms", cost.cpu},
                   {"inject_wall_ms", cost.inject}}});
      }
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"The paper's Table 1: dense sampling against exact voxelization"};
  std::vector<int> grids = {32, 64, 128};
  int repeats = 9;
  std::string rowsFile, only;
  app.add_option("--grids", grids, "Cells along an edge")->delimiter(',');
  app.add_option("--repeats", repeats, "Injections that are timed, at least")->check(CLI::Range(1, 1000));
  app.add_option("--rows", rowsFile, bench::kRowsHelp);
  app.add_option("--mesh", only, "Only meshes with this in their name");
  CLI11_PARSE(app, argc, argv);
  for (const gpu::Device& device : gpu::preferredOrder(gpu::listDevices())) {
    Expected<gpu::Context> context = gpu::Context::make(device);
    if (context.ok()) return run(grids, only, repeats, rowsFile, *context);
  }
  std::cerr << "no OpenGL 4.5 here\n";
  return 1;
}
