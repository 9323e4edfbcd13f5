// How time and memory grow with a scene: triangles of a light, lights, surfaces, cells, sessions. One thing grows at a
// time; in each tick one light moves (or each session's light). Ticks are medians, the first stands beside
// them. Readers are stream_bench's.
//   scale_bench [--ticks N] [--most N] [--only NAME] [--rows FILE]

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "bench/rows.h"
#include "core_scene.h"
#include "reference/meshes.h"

namespace {

using namespace lpv;

/// One thing that grows.
struct Growth {
  std::string name;
  std::vector<int> counts;
  Scene (*scene)(int count);
  bool frame = false;
  bool sessions = false;  ///< as many sessions as counted, of the same scene
};

struct Ticks {
  double first = 0.0, median = 0.0;  ///< milliseconds
  double firstVoxelize = 0.0, voxelize = 0.0;  ///< of these, in voxelization
  MemoryUse memory;                  ///< of one session
};

Scene roomOf(const MeshPtr& lamp, int cells) {
  Scene scene = bench::roomWith(lamp, {0.0, 1.5, 0.0}, cells);
  scene.options = {};
  scene.options.transport = Transport::kGather;
  scene.options.followTransport();
  scene.options.visibility = Visibility::kOff;
  scene.options.bounces = 0;
  return scene;
}

Scene trianglesOf(int count) {
  return roomOf(count < 100 ? reference::sphereOf(3, 1 + count / 6) : reference::bumpySphere(std::size_t(count)), 32);
}

Scene lightsOf(int count) { return bench::roomOfLights(count, 32); }

Scene surfacesOf(int count) {
  Scene scene = roomOf(reference::sphere(), 32);
  scene.options.visibility = Visibility::kAuto;
  const double half = 0.5 / std::cbrt(double(count));
  const MeshPtr mesh = reference::box(glm::dvec3(-half), glm::dvec3(half));
  for (int i = 1; i < count; ++i) {  // the room itself is the first
    auto surface = std::make_shared<Surface>();
    surface->name = "box" + std::to_string(i);
    surface->mesh = mesh;
    surface->transform.translation = bench::spreadInRoom(i);
    scene.surfaces[surface->name] = surface;
  }
  return scene;
}

Scene cellsOf(int count) { return roomOf(reference::sphere(), count); }

Scene propagatedCellsOf(int count) {
  Scene scene = cellsOf(count);
  scene.options.transport = Transport::kPropagate;
  scene.options.followTransport();
  scene.options.iterations = 2 * count;
  return scene;
}

Scene sessionsOf(int) { return roomOf(reference::sphere(), 16); }

std::vector<Growth> growths() {
  return {{"triangles of a light", {12, 100, 1000, 10000, 100000, 1000000}, trianglesOf},
          {"lights, one moves", {1, 4, 16, 64, 256, 1024}, lightsOf},
          {"surfaces, a stream's frame with shadows", {1, 4, 16, 64, 256, 1024}, surfacesOf, true},
          {"cells along an edge, GATHER", {16, 32, 64, 128}, cellsOf},
          {"cells along an edge, PROPAGATE", {16, 32, 64, 128}, propagatedCellsOf},
          {"sessions, all lights move", {1, 4, 16, 64, 128}, sessionsOf, false, true}};
}

TickRequest requestOf(const Scene& scene, const Growth& growth, SessionKey session, int step) {
  TickRequest request;
  request.session = session;
  auto moved = std::make_shared<Scene>(scene);
  auto lamp = std::make_shared<Light>(*moved->lights.at("light"));
  lamp->transform.translation.x += 0.05 * (step % 7);
  moved->lights["light"] = lamp;
  moved->revision = std::uint64_t(step) + 1;
  request.scene = moved;
  request.transported = !growth.frame;
  if (!growth.frame) return request;
  FrameRequest frame;
  frame.view = 1;
  frame.camera.eye = {1.8, 1.6, 1.8};
  frame.camera.target = {0.0, 1.2, 0.0};
  frame.size = {320, 180};
  frame.reduced = true;
  request.frames = {frame};
  return request;
}

/// A tick of every session.
Ticks measure(const Growth& growth, int count, int ticks) {
  const Scene scene = growth.scene(count);
  const int sessions = growth.sessions ? count : 1;
  Ticks out;
  std::vector<double> took, voxelized;
  for (int step = 0; step < ticks + 2; ++step) {
    const auto begun = std::chrono::steady_clock::now();
    double voxelize = 0.0;
    for (int s = 1; s <= sessions; ++s) {
      const TickReport report = bench::tick(requestOf(scene, growth, SessionKey(s), step)).report;
      voxelize += 1e3 * bench::secondsOf(report, Stage::kVoxelize);
      out.memory = report.memory;
    }
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - begun;
    if (step == 0) out.first = ms.count(), out.firstVoxelize = voxelize;
    if (step >= 2) took.push_back(ms.count()), voxelized.push_back(voxelize);
    if (step >= 4 && ms.count() > 2000.0) break;  // three of such are enough
  }
  for (int s = 1; s <= sessions; ++s) bench::engine().forget(SessionKey(s));
  out.median = bench::medianOf(took);
  out.voxelize = bench::medianOf(voxelized);
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  int ticks = 7;
  int most = 1000000;
  std::string only;
  std::string rowsFile;
  CLI::App app("How time and memory grow with triangles, lights, surfaces, cells and sessions");
  app.add_option("--ticks", ticks, "of each row, whose median is told")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--most", most, "Larger counts are left out")->capture_default_str();
  app.add_option("--only", only, "Only what has this in its name");
  app.add_option("--rows", rowsFile, bench::kRowsHelp);
  CLI11_PARSE(app, argc, argv);
  bench::Rows rows(rowsFile, bench::engine().device().name);
  for (const Growth& growth : growths()) {
    if (growth.name.find(only) == std::string::npos) continue;
    for (const int count : growth.counts) {
      if (count > most) break;
      const Ticks seen = measure(growth, count, ticks);
      const double sessions = growth.sessions ? count : 1;
      rows.add({growth.name,
                "scale",
                {{"count", double(count)}},
                {{"tick_ms", seen.median},
                 {"first_tick_ms", seen.first},
                 {"voxelize_ms", seen.voxelize},
                 {"first_voxelize_ms", seen.firstVoxelize},
                 {"light_bytes", sessions * double(seen.memory.light)},
                 {"frames_bytes", sessions * double(seen.memory.frames)}}});
    }
  }
  return 0;
}
