// What each feature adds to a tick, to a frame and to memory: one lamp that moves in a room of walls, and in the same
// room with two boxes, each feature alone or on top of those before it.
//   feature_bench [--ticks N] [--grid N] [--rows FILE]

#include <CLI/CLI.hpp>
#include <chrono>
#include <string>
#include <vector>

#include "bench/rows.h"
#include "core_scene.h"
#include "reference/room.h"

namespace {

using namespace lpv;

constexpr glm::ivec2 kSize{320, 180};

/// A row of the table: a session, and what is asked of its ticks.
struct Feature {
  const char* name;
  Visibility visibility;
  int bounces;
  bool frame;
  bool guarded = false;
  bool reduced = true;
  int samples = 1;
  bool gloss = false;  ///< of all surfaces, roughness .3
  double haze = 0.0;  ///< extinction per metre
};

/// A tenth in a metre.
constexpr double kHaze = 0.1;

constexpr Feature kFeatures[] = {
    {"volume", Visibility::kOff, 0, false},
    {"volume, guard cells", Visibility::kOff, 0, false, true},
    {"volume, visibility auto", Visibility::kAuto, 0, false},
    {"volume, shadows", Visibility::kOn, 0, false},
    {"volume, haze", Visibility::kOn, 0, false, false, true, 1, false, kHaze},
    {"volume, shadows, 1 bounce", Visibility::kOn, 1, false},
    {"volume, shadows, all bounces", Visibility::kOn, kAutoBounces, false},
    {"stream's frame", Visibility::kOff, 0, true},
    {"stream's frame, visibility auto", Visibility::kAuto, 0, true},
    {"stream's frame, shadows", Visibility::kOn, 0, true},
    {"stream's frame, haze", Visibility::kOn, 0, true, false, true, 1, false, kHaze},
    {"stream's frame, shadows, 1 bounce", Visibility::kOn, 1, true},
    {"stream's frame, shadows, all bounces", Visibility::kOn, kAutoBounces, true},
    {"stream's frame, shadows, all bounces, gloss", Visibility::kOn, kAutoBounces, true, false, true, 1, true},
    {"stream's frame, all bounces, haze", Visibility::kOn, kAutoBounces, true, false, true, 1, false, kHaze},
    {"single frame", Visibility::kOff, 0, true, false, false},
    {"single frame, 16 samples", Visibility::kOff, 0, true, false, false, 16},
    {"single frame, 16 samples, shadows", Visibility::kOn, 0, true, false, false, 16},
    {"single frame, 16 samples, haze", Visibility::kOn, 0, true, false, false, 16, false, kHaze},
    {"single frame, 16 samples, shadows, all bounces", Visibility::kOn, kAutoBounces, true, false, false, 16},
    {"single frame, 16 samples, shadows, all bounces, gloss", Visibility::kOn, kAutoBounces, true, false, false, 16,
     true},
    {"single frame, 16 samples, all bounces, haze", Visibility::kOn, kAutoBounces, true, false, false, 16, false,
     kHaze},
};

/// What a row came to.
struct Cost {
  double milliseconds = 0.0;
  MemoryUse memory;
};

Scene roomOf(bool boxes, int grid) {
  Scene scene = reference::smallRoom(grid);
  if (!boxes) {
    scene.surfaces.erase("tall");
    scene.surfaces.erase("short");
  }
  scene.options.transport = Transport::kGather;
  scene.options.followTransport();
  return scene;
}

TickRequest requestOf(const Scene& scene, const Feature& feature, SessionKey session, int step) {
  TickRequest request;
  request.session = session;
  const Light& lamp = *scene.lights.begin()->second;
  request.scene = bench::movedTo(scene, lamp.transform.translation + glm::dvec3(0.1 * (step % 2), 0.0, 0.0));
  request.transported = !feature.frame;
  request.guarded = feature.guarded;
  if (!feature.frame) return request;
  FrameRequest frame;
  frame.view = feature.reduced ? session : 0;
  frame.camera = reference::roomCamera();
  frame.size = kSize;
  frame.reduced = feature.reduced;
  frame.samples = feature.samples;
  request.frames = {frame};
  return request;
}

void makeGlossy(Scene& scene) {
  scene.options.gloss = Gloss::kOn;
  for (auto& [name, surface] : scene.surfaces) {
    auto glossy = std::make_shared<Surface>(*surface);
    glossy->roughness = 0.3;
    surface = std::move(glossy);
  }
}

Cost measure(Scene scene, const Feature& feature, int ticks) {
  static SessionKey session = 0;
  ++session;
  scene.options.visibility = feature.visibility;
  scene.options.bounces = feature.bounces;
  scene.options.haze = feature.haze;
  if (feature.gloss) makeGlossy(scene);
  Cost cost;
  std::vector<double> took;
  for (int step = -2; step < ticks; ++step) {  // the first two make what is kept
    const TickRequest request = requestOf(scene, feature, session, step + 2);
    const auto begun = std::chrono::steady_clock::now();
    cost.memory = bench::tick(request).report.memory;
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - begun;
    if (step >= 0) took.push_back(ms.count());
  }
  bench::engine().forget(session);
  cost.milliseconds = bench::medianOf(took);
  return cost;
}

void table(bool boxes, int grid, int ticks, bench::Rows* rows) {
  const Scene scene = roomOf(boxes, grid);
  double first = 0.0;
  for (const Feature& feature : kFeatures) {
    const Cost cost = measure(scene, feature, ticks);
    if (first == 0.0) first = cost.milliseconds;
    rows->add({boxes ? "room with two boxes" : "empty room",
               "features",
               {{"asked", feature.name}},
               {{"tick_ms", cost.milliseconds},
                {"times_the_volumes_tick", cost.milliseconds / first},
                {"light_bytes", double(cost.memory.light)},
                {"frames_bytes", double(cost.memory.frames)}}});
  }
}

}  // namespace

int main(int argc, char** argv) {
  int ticks = 9;
  int grid = 32;
  std::string rowsFile;
  CLI::App app("What each feature adds to a tick, to a frame of 320x180 and to memory");
  app.add_option("--ticks", ticks, "of each row, whose median is told")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--grid", grid, "cells along the longest edge")->check(CLI::Range(1, 128))->capture_default_str();
  app.add_option("--rows", rowsFile, bench::kRowsHelp);
  CLI11_PARSE(app, argc, argv);
  bench::Rows rows(rowsFile, bench::engine().device().name);
  table(false, grid, ticks, &rows);
  table(true, grid, ticks, &rows);
  return 0;
}
