// Time against error: grid x distance rule x lookup x transport, through the engine as sessions use it. Truth is the
// closed form for polygons (Lambert; Arvo 1995), without occluders; receivers are 864 points of six walls and random
// object points at least two cells from the light (MATHS.md 4, 5). Times are of ticks in which the light has moved.
//
//   accuracy_bench [--grids 16,32,64] [--mesh NAME] [--poses N] [--csv FILE]
//
// LPV_BENCH_LUCY names the PLY file of Stanford's Lucy; a bumpy sphere of as many triangles takes its place.

#include <ctime>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <future>
#include <glm/gtc/quaternion.hpp>
#include <iostream>
#include <sstream>

#include "core_scene.h"
#include "lpv/engine.h"
#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "reference/receivers.h"
#include "reference/volume.h"

namespace {

using namespace lpv;
using reference::Errors;
using reference::Receiver;

struct Named {
  std::string name;
  MeshPtr mesh;
};

std::vector<Named> meshes() {
  return {{"quad", reference::quad()},
          {"pyramid", reference::pyramid()},
          {"tube", reference::tube()},
          {"sphere 720", reference::sphere()},
          {std::getenv("LPV_BENCH_LUCY") != nullptr ? "Lucy" : "bumpy 33446", bench::statue()}};
}

struct Way {
  std::string name;
  Transport transport = Transport::kGather;
  double k = 0.0;
  int iterationsPerCell = 0;  ///< PROPAGATE: iterations are this many times the longest edge
  bool clamp = false;
};

std::vector<Way> ways() {
  using enum Transport;
  return {{"PROPAGATE", kPropagate, 0.0, 2},
          {"PROPAGATE clamped", kPropagate, 0.0, 2, true},
          {"GATHER k 1.5", kGather, 1.5},
          {"GATHER k 2", kGather, 2.0},
          {"GATHER k 2.25", kGather, 2.25},
          {"GATHER k 2.5", kGather, 2.5},
          {"GATHER k 3", kGather, 3.0},
          {"GATHER k 4", kGather, 4.0},
          {"GATHER k 6", kGather, 6.0}};
}

/// The light in the middle of a unit cube, a quarter of it across, turned and moved by parts of a cell.
Transform poseOf(int pose, const Mesh& mesh, double cell) {
  const glm::dvec3 size = mesh.bounds.extent();
  Transform t;
  t.scale = glm::dvec3(0.25 / std::max({size.x, size.y, size.z}));
  t.rotation = glm::angleAxis(0.7 * pose + 0.3, glm::normalize(glm::dvec3(1.0, 2.0 - pose, 0.5 * pose + 0.2)));
  const glm::dvec3 centre = t.rotation * (t.scale * mesh.bounds.centre());
  t.translation = glm::dvec3(0.5) - centre + cell * glm::dvec3(0.37 * pose, 0.61 * pose, 0.83 * pose);
  return t;
}

Scene sceneOf(const Named& light, const Way& way, int cells, int pose) {
  Scene scene;
  scene.grid = {glm::dvec3(0.0), 1.0 / cells, glm::ivec3(cells)};
  scene.options.transport = way.transport;
  scene.options.followTransport();
  scene.options.k = way.k;
  scene.options.iterations = way.iterationsPerCell * cells;
  scene.options.clampFaces = way.clamp;
  auto lamp = std::make_shared<Light>();
  lamp->name = "lamp";
  lamp->mesh = light.mesh;
  lamp->transform = poseOf(pose, *light.mesh, scene.grid.cell);
  scene.lights["lamp"] = lamp;
  return scene;
}

TickResult tick(Engine& engine, const Scene& scene) {
  static std::uint64_t revision = 0;
  TickRequest request;
  request.session = 1;
  auto copy = std::make_shared<Scene>(scene);
  copy->revision = ++revision;
  request.scene = copy;
  request.transported = true;
  std::promise<Expected<TickResult>> answer;
  engine.submit(std::move(request), [&](Expected<TickResult> r) { answer.set_value(std::move(r)); });
  Expected<TickResult> result = answer.get_future().get();
  if (!result.ok()) throw std::runtime_error(result.status().message());
  return std::move(*result);
}

double cpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

/// Milliseconds.
struct Times {
  double voxelize = 0.0, transport = 0.0, cpu = 0.0;
};

double medianOf(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + long(v.size() / 2), v.end());
  return v[v.size() / 2];
}

/// Moves the light on and on; medians.
Times timesOf(Engine& engine, const Scene& scene, int repeats) {
  std::vector<double> voxelize, transport, cpu;
  for (int i = 0; i < repeats; ++i) {
    Scene moved = scene;
    auto lamp = std::make_shared<Light>(*moved.lights["lamp"]);
    lamp->transform.translation.x += scene.grid.cell * 0.01 * (i + 1);
    moved.lights["lamp"] = lamp;
    const double before = cpuSeconds();
    const TickResult result = tick(engine, moved);
    cpu.push_back(cpuSeconds() - before);
    voxelize.push_back(bench::secondsOf(result.report, "voxelize") + bench::secondsOf(result.report, "inject"));
    transport.push_back(bench::secondsOf(result.report, "gather") + bench::secondsOf(result.report, "propagate"));
  }
  return {1e3 * medianOf(voxelize), 1e3 * medianOf(transport), 1e3 * medianOf(cpu)};
}

std::vector<glm::dvec3> seen(const Volume& volume, Lookup lookup, const std::vector<Receiver>& receivers) {
  std::vector<glm::dvec3> out;
  for (const Receiver& r : receivers) out.push_back(irradianceAt(volume, lookup, r.position, r.normal).rgb);
  return out;
}

/// What all poses say together.
struct Collected {
  std::vector<glm::dvec3> truth, cap, sh2;
};

void collect(Collected& all, const Volume& volume, const std::vector<reference::Emitter>& emitters,
             const std::vector<Receiver>& receivers) {
  const auto append = [](std::vector<glm::dvec3>& to, const std::vector<glm::dvec3>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(all.truth, reference::irradiances(emitters, receivers));
  append(all.cap, seen(volume, Lookup::kCap, receivers));
  append(all.sh2, seen(volume, Lookup::kSh2, receivers));
}

struct Row {
  std::string mesh, way, lookup;
  int cells = 0;
  Times times;
  Errors walls, objects;
  std::uint64_t vpls = 0;
};

void print(std::ostream& out, const Row& r) {
  char line[320];
  std::snprintf(line, sizeof line, "%s,%d,%s,%s,%llu,%.3f,%.3f,%.3f,%.5f,%.5f,%.5f,%.5f,%.5f,%.5f", r.mesh.c_str(),
                r.cells, r.way.c_str(), r.lookup.c_str(), static_cast<unsigned long long>(r.vpls), r.times.voxelize,
                r.times.transport, r.times.cpu, r.walls.raw, r.walls.shape, r.walls.worst, r.objects.raw,
                r.objects.shape, r.objects.worst);
  out << line << std::endl;
}

std::vector<Row> measure(Engine& engine, const Named& light, const Way& way, int cells, int poses, int repeats) {
  Collected walls, objects;
  std::uint64_t vpls = 0;
  for (int pose = 0; pose < poses; ++pose) {
    const Scene scene = sceneOf(light, way, cells, pose);
    const TickResult result = tick(engine, scene);
    vpls = result.report.vpls;
    const std::vector<reference::Emitter> emitters = reference::emittersOf(scene).triangles;
    collect(walls, *result.transported, emitters, reference::wallReceivers(scene.grid));
    collect(objects, *result.transported, emitters, reference::objectReceivers(scene.grid, emitters, 200));
  }
  const Times times = timesOf(engine, sceneOf(light, way, cells, 1), repeats);
  std::vector<Row> rows;
  rows.push_back({light.name, way.name, "CAP", cells, times, reference::errors(walls.cap, walls.truth),
                  reference::errors(objects.cap, objects.truth), vpls});
  rows.push_back({light.name, way.name, "SH2", cells, times, reference::errors(walls.sh2, walls.truth),
                  reference::errors(objects.sh2, objects.truth), vpls});
  return rows;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Time against error of the transports, as CSV");
  std::vector<int> grids = {16, 32, 64};
  std::string only, csv, onlyWay;
  int poses = 2, repeats = 5;
  app.add_option("--grids", grids, "Cells along an edge")->delimiter(',');
  app.add_option("--mesh", only, "Only the mesh whose name begins so");
  app.add_option("--way", onlyWay, "Only ways whose name begins so");
  app.add_option("--poses", poses, "Poses that the errors are taken over");
  app.add_option("--repeats", repeats, "Ticks that the times are medians of");
  app.add_option("--csv", csv, "Write the table there too");
  CLI11_PARSE(app, argc, argv);

  Expected<std::unique_ptr<Engine>> engine = startEngine({});
  if (!engine.ok()) {
    std::cerr << "accuracy_bench: " << engine.status().message() << "\n";
    return 1;
  }
  std::cerr << (*engine)->device().name << "\n";
  std::ofstream file;
  if (!csv.empty()) file.open(csv);
  const char* header =
      "mesh,cells,transport,lookup,vpls,voxelize_ms,transport_ms,tick_cpu_ms,walls_raw,walls_shape,walls_worst,"
      "objects_raw,objects_shape,objects_worst\n";
  std::cout << header;
  file << header;
  for (const Named& light : meshes()) {
    if (light.name.rfind(only, 0) != 0) continue;
    for (const int cells : grids) {
      for (const Way& way : ways()) {
        if (way.name.rfind(onlyWay, 0) != 0) continue;
        for (const Row& row : measure(**engine, light, way, cells, poses, repeats)) {
          print(std::cout, row);
          if (file.is_open()) print(file, row);
        }
      }
    }
  }
  return 0;
}
