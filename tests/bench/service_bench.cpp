// What a user feels, measured over real sockets on one machine: a session whose light moves (or whose light's mesh
// deforms) while one client watches frames and, if asked, another the volume. Prints rates, stage times and the time
// from sending an edit to holding the first frame that shows it. Numbers, not verdicts: nothing fails for being slow.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench/rows.h"
#include "bench/service_load.h"

namespace {

using lpv::bench::Load;
using lpv::bench::Measured;

nlohmann::json latencyJson(const lpv::client::LatencySummary& latency) {
  return {
      {"p50", latency.p50 * 1e3}, {"p95", latency.p95 * 1e3}, {"p99", latency.p99 * 1e3}, {"max", latency.max * 1e3}};
}

nlohmann::json asJson(const Load& load, const Measured& m) {
  nlohmann::json stages = nlohmann::json::object();
  for (const auto& [stage, seconds] : m.stageSeconds) stages[stage] = seconds * 1e3;
  nlohmann::json first = nlohmann::json::object();
  for (const auto& [stage, seconds] : m.firstFrameSeconds) first[stage] = seconds * 1e3;
  return {{"mode", load.deform ? "deform" : "move"},
          {"device", m.device},
          {"version", m.version},
          {"seconds", m.seconds},
          {"grid", load.grid},
          {"transport", load.transport},
          {"frame", {load.width, load.height}},
          {"surface_triangles", m.surfaceTriangles},
          {"light_triangles", m.lightTriangles},
          {"edits_per_s", m.edits / m.seconds},
          {"ticks_per_s", m.ticks / m.seconds},
          {"frames_per_s", m.frames / m.seconds},
          {"volumes_per_s", m.volumes / m.seconds},
          {"frame_kb", m.frames > 0 ? m.frameBytes / m.frames / 1e3 : 0.0},
          {"latency_ms", latencyJson(m.latency)},
          {"warm_up",
           {{"seconds", load.warmUpSeconds},
            {"latency_ms", latencyJson(m.warmUpLatency)},
            {"first_frame_stage_ms", first}}},
          {"revisions_behind_p50", m.revisionsBehind},
          {"stage_ms_median", stages}};
}

void printStages(const char* title, const nlohmann::json& stages) {
  std::printf("%s", title);
  for (const auto& [stage, ms] : stages.items()) std::printf(" %s %.1f", stage.c_str(), ms.get<double>());
  std::printf("\n");
}

void print(const nlohmann::json& j) {
  std::printf("%s, %s light of %lld triangles in a scene of %lld, grid %d, %s, %dx%d, %s\n",
              j["version"].get<std::string>().c_str(), j["mode"] == "deform" ? "deforming" : "moving",
              j["light_triangles"].get<long long>(), j["surface_triangles"].get<long long>(), j["grid"].get<int>(),
              j["transport"].get<std::string>().c_str(), j["frame"][0].get<int>(), j["frame"][1].get<int>(),
              j["device"].get<std::string>().c_str());
  std::printf("  edits/s %.1f  ticks/s %.1f  frames/s %.1f (%.0f kB each)  volumes/s %.1f\n",
              j["edits_per_s"].get<double>(), j["ticks_per_s"].get<double>(), j["frames_per_s"].get<double>(),
              j["frame_kb"].get<double>(), j["volumes_per_s"].get<double>());
  std::printf("  edit to frame, ms: p50 %.0f  p95 %.0f  p99 %.0f;  revisions behind when a frame arrives: %.0f\n",
              j["latency_ms"]["p50"].get<double>(), j["latency_ms"]["p95"].get<double>(),
              j["latency_ms"]["p99"].get<double>(), j["revisions_behind_p50"].get<double>());
  std::printf("  not counted: %.1f s of warm-up, whose slowest edit took %.0f ms\n",
              j["warm_up"]["seconds"].get<double>(), j["warm_up"]["latency_ms"]["max"].get<double>());
  printStages("  its first frame, ms:", j["warm_up"]["first_frame_stage_ms"]);
  printStages("  stages, ms (median):", j["stage_ms_median"]);
}

/// "edit,counted,ms" lines, the warm-up first.
void writeSamples(const std::string& path, const Measured& m) {
  std::ofstream file(path);
  file << "edit,counted,ms\n";
  for (std::size_t i = 0; i < m.samples.size(); ++i) {
    file << i << "," << (i < m.warmUpSamples ? 0 : 1) << "," << m.samples[i] * 1e3 << "\n";
  }
}

lpv::bench::Row rowOf(const std::string& name, const Load& load, const Measured& m) {
  lpv::bench::Row row{name.empty() ? "room" : name, "service", {}, {}};
  row.settings = {{"grid", double(load.grid)},
                  {"transport", load.transport},
                  {"visibility", load.visibility},
                  {"bounces", load.bounces}};
  row.values = {{"surface_triangles", double(m.surfaceTriangles)},
                {"light_triangles", double(m.lightTriangles)},
                {"edits_per_s", m.edits / m.seconds},
                {"ticks_per_s", m.ticks / m.seconds},
                {"frames_per_s", m.frames / m.seconds},
                {"volumes_per_s", m.volumes / m.seconds},
                {"latency_p50_ms", m.latency.p50 * 1e3},
                {"latency_p95_ms", m.latency.p95 * 1e3},
                {"latency_p99_ms", m.latency.p99 * 1e3},
                {"latency_max_ms", m.latency.max * 1e3},
                {"first_frame_ms", m.warmUpLatency.max * 1e3}};
  for (const char* stage : {"voxelize", "propagate", "gather", "emitters", "reflect", "shade"}) {
    const auto found = m.stageSeconds.find(stage);
    row.values.emplace_back(std::string(stage) + "_ms", found == m.stageSeconds.end() ? 0.0 : found->second * 1e3);
  }
  return row;
}

}  // namespace

int main(int argc, char** argv) {
  Load load;
  std::string jsonFile;
  std::string samplesFile;
  std::string rowsFile;
  std::string rowName;
  bool volumeOnly = false;
  CLI::App app("Measures a running session over the loopback; starts an lpvd of its own unless --server names one");
  app.add_option("--server", load.server, "HOST:PORT of a running lpvd");
  app.add_option("--scene", load.sceneFile, "scene to load (default: a small procedural room)");
  app.add_option("--light", load.lightFile, "mesh of the light (default: a procedural sphere)");
  app.add_option("--light-scale", load.lightScale, "factor from the mesh file's unit to metres")->capture_default_str();
  app.add_option("--light-triangles", load.lightTriangles, "of the procedural light")->capture_default_str();
  app.add_option("--place", load.place, "x y z: where the light's base stands")->expected(3);
  app.add_option("--radiance", load.radiance, "of the light, each colour")->capture_default_str();
  auto* camera = app.add_option("--camera", load.camera, "eye x y z target x y z")->expected(6);
  app.add_option("--grid", load.grid, "cells along the longest edge")->capture_default_str();
  app.add_option("--transport", load.transport)
      ->check(CLI::IsMember({"gather", "propagate", "direct"}))
      ->capture_default_str();
  app.add_option("--iterations", load.iterations, "steps of --transport propagate")->capture_default_str();
  app.add_option("--width", load.width)->capture_default_str();
  app.add_option("--height", load.height)->capture_default_str();
  app.add_option("--rate", load.rate, "edits per second")->capture_default_str();
  app.add_option("--warm-up", load.warmUpSeconds, "seconds of the same load before anything is counted")
      ->capture_default_str();
  app.add_option("--seconds", load.seconds, "that are counted")->capture_default_str();
  app.add_flag("--deform", load.deform, "new vertices each time instead of a new place");
  app.add_option("--visibility", load.visibility, "as lpvctl's")
      ->check(CLI::IsMember({"auto", "on", "off"}))
      ->capture_default_str();
  app.add_option("--bounces", load.bounces, "as lpvctl's: auto or a number")
      ->check(CLI::IsMember({"auto"}) | CLI::Range(0, 32))
      ->capture_default_str();
  app.add_flag("--volume", load.watchVolume, "a second client watches the volume");
  app.add_flag("--volume-only", volumeOnly, "it alone: nobody watches frames");
  app.add_flag("--orbit", load.orbit, "the camera moves instead of the light")->needs(camera);
  app.add_option("--still", load.stillFolder,
                 "folder for what the stream shows of the light on its place, and the scene of that, for references");
  app.add_option("--json", jsonFile, "also write the numbers here");
  auto* rows = app.add_option("--rows", rowsFile, lpv::bench::kRowsHelp);
  app.add_option("--row", rowName, "name of that row")->needs(rows);
  app.add_option("--samples", samplesFile, "write the time from edit to frame of every edit here, as CSV");
  CLI11_PARSE(app, argc, argv);

  if (volumeOnly) load.watchVolume = true;
  load.watchFrames = !volumeOnly;
  const lpv::Expected<Measured> measured = lpv::bench::run(load);
  if (!measured) {
    std::cerr << "service_bench: " << measured.status().message() << "\n";
    return 1;
  }
  const nlohmann::json j = asJson(load, *measured);
  print(j);
  if (!jsonFile.empty()) std::ofstream(jsonFile) << j.dump(2) << "\n";
  if (!rowsFile.empty()) lpv::bench::Rows(rowsFile, measured->device).add(rowOf(rowName, load, *measured));
  if (!samplesFile.empty()) writeSamples(samplesFile, *measured);
  return 0;
}
