// Time against error: grid x distance rule x lookup x transport, through the engine as sessions use it. Truth is the
// closed form for polygons (Lambert; Arvo 1995), without occluders; receivers are 864 points of six walls and random
// object points at least two cells from the light (MATHS.md 4, 5). Times are of ticks in which the light has moved and
// the whole grid is wanted; a receiver's is what one lookup costs on one core.
//
//   accuracy_bench [--grids 16,32,64] [--mesh NAME] [--way NAME] [--poses N] [--repeats N] [--rows FILE]
//
// LPV_BENCH_LUCY names the PLY file of Stanford's Lucy; a bumpy sphere of as many triangles takes its place.

#include <ctime>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <future>
#include <glm/gtc/quaternion.hpp>
#include <iostream>

#include "bench/rows.h"
#include "core_scene.h"
#include "engine/device_choice.h"
#include "gpu/device.h"
#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "reference/receivers.h"
#include "reference/texel.h"
#include "reference/textures.h"
#include "reference/volume.h"
#include "scene/lookup.h"

namespace {

using namespace lpv;
using reference::Errors;
using reference::Receiver;

struct Named {
  std::string name;
  MeshPtr mesh;
  TexturePtr texture = nullptr;
};

std::vector<Named> meshes() {
  std::vector<Named> out;
  for (const auto& [name, mesh] : bench::paperMeshes()) out.push_back({name, mesh});
  out.push_back({"screen", reference::quad(), reference::noise(8, 8)});
  return out;
}

struct Way {
  std::string name;
  Transport transport = Transport::kGather;
  double k = 0.0;
  int iterationsPerCell = 0;  ///< PROPAGATE: iterations are this many times the edge of the grid
  bool clamp = false;
};

std::vector<Way> ways() {
  using enum Transport;
  return {{"GATHER", kGather},  // with the k of the default quality
          {"PROPAGATE", kPropagate, 0.0, 2},
          {"PROPAGATE clamped", kPropagate, 0.0, 2, true},
          {"GATHER k 1", kGather, 1.0},
          {"GATHER k 1.5", kGather, 1.5},
          {"GATHER k 3", kGather, 3.0},
          {"GATHER k 6", kGather, 6.0},
          {"DIRECT k 1.5", kDirect, 1.5},
          {"DIRECT k 3", kDirect, 3.0}};
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
  scene.options.visibility = Visibility::kOff;  // the truth has no occluders, so Lucy's arms are none either
  scene.options.k = way.k;
  scene.options.iterations = way.iterationsPerCell * cells;
  scene.options.clampFaces = way.clamp;
  auto lamp = std::make_shared<Light>();
  lamp->name = "lamp";
  lamp->mesh = light.mesh;
  lamp->texture = light.texture;
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

using bench::medianOf;

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
    voxelize.push_back(bench::secondsOf(result.report, Stage::kVoxelize) +
                       bench::secondsOf(result.report, Stage::kInject));
    transport.push_back(bench::secondsOf(result.report, Stage::kGather) +
                        bench::secondsOf(result.report, Stage::kPropagate));
  }
  return {1e3 * medianOf(voxelize), 1e3 * medianOf(transport), 1e3 * medianOf(cpu)};
}

/// How receivers read the result: a lookup of the volume alone, or with the lights themselves where they are near (all
/// of it with DIRECT).
struct Reading {
  std::string name;
  Lookup lookup = Lookup::kCap;
  bool nearField = false;
};

std::vector<Reading> readingsOf(const Way& way) {
  if (way.transport == Transport::kDirect) return {{"DIRECT", Lookup::kCap, true}};
  if (way.transport == Transport::kPropagate) return {{"SH2", Lookup::kSh2, false}};
  return {{"SH2", Lookup::kSh2, false}, {"CAP", Lookup::kCap, false}, {"CAP, near field", Lookup::kCap, true}};
}

using Colours = std::vector<glm::dvec3>;

Colours seen(const Volume& volume, const Reading& reading, const std::vector<Receiver>& receivers) {
  const auto look = reading.nearField ? irradianceWithNearField : irradianceAt;
  Colours out;
  for (const Receiver& r : receivers) out.push_back(look(volume, reading.lookup, r.position, r.normal).rgb);
  return out;
}

/// Receivers and the truth for one pose of a light.
struct Judged {
  std::vector<Receiver> walls, objects;
  Colours wallTruth, objectTruth;
  Colours wallLookup, objectLookup;  ///< what CAP makes of exact moments at the receiver itself
};

Colours exactLookups(const std::vector<reference::Emitter>& emitters, const std::vector<Receiver>& receivers) {
  Colours out;
  for (const Receiver& r : receivers) {
    const auto incident = reference::incidentSh(emitters, r.position);
    out.emplace_back(irradianceCap(incident[0], r.normal), irradianceCap(incident[1], r.normal),
                     irradianceCap(incident[2], r.normal));
  }
  return out;
}

/// Triangles of one radiance each: a texture is taken apart finer than its texels.
std::vector<reference::Emitter> polygonsOf(Named light, int cells, int pose) {
  const TexturePtr texture = light.texture;
  light.texture = nullptr;
  if (texture != nullptr) light.mesh = reference::quadOf(96);
  std::vector<reference::Emitter> out = reference::emittersOf(sceneOf(light, ways().front(), cells, pose)).triangles;
  if (texture == nullptr) return out;
  for (reference::Emitter& e : out) e.radiance *= reference::bilinear(*texture, e.uvAt(glm::dvec3(1.0 / 3.0)));
  return out;
}

std::vector<Judged> judge(const Named& light, int cells, int poses) {
  std::vector<Judged> out;
  for (int pose = 0; pose < poses; ++pose) {
    const Grid grid = sceneOf(light, ways().front(), cells, pose).grid;
    const std::vector<reference::Emitter> emitters = polygonsOf(light, cells, pose);
    Judged& j = out.emplace_back();
    j.walls = reference::wallReceivers(grid);
    j.objects = reference::objectReceivers(grid, emitters, 200);
    j.wallLookup = exactLookups(emitters, j.walls);
    j.objectLookup = exactLookups(emitters, j.objects);
    j.wallTruth = reference::irradiances(emitters, j.walls);
    j.objectTruth = reference::irradiances(emitters, j.objects);
  }
  return out;
}

struct Row {
  std::string mesh, way, reading;
  int cells = 0;
  Times times;
  Errors walls, objects;
  std::uint64_t vpls = 0;
  double receiverUs = 0.0;
};

/// What reads the result decides the errors, and costs per receiver; the tick is the same.
bench::Row rowOf(const Row& r) {
  bench::Row out{r.mesh, "transport", {{"grid", double(r.cells)}, {"transport", r.way}, {"lookup", r.reading}}, {}};
  if (r.times.transport > 0.0) {
    out.values = {{"tick_seconds", 1e-3 * (r.times.voxelize + r.times.transport)},
                  {"voxelize_ms", r.times.voxelize},
                  {"transport_ms", r.times.transport},
                  {"tick_cpu_ms", r.times.cpu},
                  {"receiver_us", r.receiverUs},
                  {"vpls", double(r.vpls)}};
  }
  for (const auto& [name, value] : {std::pair{"raw_l2", r.walls.raw},
                                    {"shape_l2", r.walls.shape},
                                    {"worst", r.walls.worst},
                                    {"log_ratio_p95", r.walls.logRatio95},
                                    {"log_ratio_p99", r.walls.logRatio99},
                                    {"objects_raw_l2", r.objects.raw},
                                    {"objects_shape_l2", r.objects.shape},
                                    {"objects_worst", r.objects.worst}}) {
    out.values.emplace_back(name, value);
  }
  return out;
}

void append(Colours& to, const Colours& from) { to.insert(to.end(), from.begin(), from.end()); }

/// Without a grid: what the lookup alone costs in error.
Row lookupRow(const Named& light, int cells, const std::vector<Judged>& poses) {
  Colours walls, wallTruth, objects, objectTruth;
  for (const Judged& j : poses) {
    append(walls, j.wallLookup);
    append(wallTruth, j.wallTruth);
    append(objects, j.objectLookup);
    append(objectTruth, j.objectTruth);
  }
  return {light.name,
          "exact moments",
          "CAP",
          cells,
          {},
          reference::errors(walls, wallTruth),
          reference::errors(objects, objectTruth)};
}

std::vector<Row> measure(Engine& engine, const Named& light, const Way& way, int cells,
                         const std::vector<Judged>& poses, int repeats) {
  std::vector<VolumePtr> volumes;
  std::uint64_t vpls = 0;
  for (int pose = 0; pose < int(poses.size()); ++pose) {
    const TickResult result = tick(engine, sceneOf(light, way, cells, pose));
    volumes.push_back(result.transported);
    vpls = result.report.vpls;
  }
  const Times times = timesOf(engine, sceneOf(light, way, cells, 1), repeats);
  std::vector<Row> rows;
  for (const Reading& reading : readingsOf(way)) {
    Colours walls, wallTruth, objects, objectTruth;
    const double before = cpuSeconds();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      append(walls, seen(*volumes[i], reading, poses[i].walls));
      append(objects, seen(*volumes[i], reading, poses[i].objects));
    }
    const double perReceiver = (cpuSeconds() - before) / double(walls.size() + objects.size());
    for (const Judged& j : poses) {
      append(wallTruth, j.wallTruth);
      append(objectTruth, j.objectTruth);
    }
    rows.push_back({light.name, way.name, reading.name, cells, times, reference::errors(walls, wallTruth),
                    reference::errors(objects, objectTruth), vpls, 1e6 * perReceiver});
  }
  return rows;
}

}  // namespace

int main(int argc, char** argv) {
  gpu::askForSoftwareWorkers();
  CLI::App app("Time against error of the transports");
  std::vector<int> grids = {16, 32, 64};
  std::string only, rowsFile, onlyWay;
  int poses = 2, repeats = 5;
  app.add_option("--grids", grids, "Cells along an edge")->delimiter(',');
  app.add_option("--mesh", only, "Only the mesh whose name begins so");
  app.add_option("--way", onlyWay, "Only ways whose name begins so");
  app.add_option("--poses", poses, "Poses that the errors are taken over");
  app.add_option("--repeats", repeats, "Ticks that the times are medians of");
  app.add_option("--rows", rowsFile, bench::kRowsHelp);
  CLI11_PARSE(app, argc, argv);

  Expected<std::unique_ptr<Engine>> engine = startEngine({});
  if (!engine.ok()) {
    std::cerr << "accuracy_bench: " << engine.status().message() << "\n";
    return 1;
  }
  bench::Rows rows(rowsFile, (*engine)->device().name);
  for (const Named& light : meshes()) {
    if (light.name.rfind(only, 0) != 0) continue;
    for (const int cells : grids) {
      const std::vector<Judged> judged = judge(light, cells, poses);
      if (onlyWay.empty()) rows.add(rowOf(lookupRow(light, cells, judged)));
      for (const Way& way : ways()) {
        if (way.name.rfind(onlyWay, 0) != 0) continue;
        for (const Row& row : measure(**engine, light, way, cells, judged, repeats)) rows.add(rowOf(row));
      }
    }
  }
  return 0;
}
