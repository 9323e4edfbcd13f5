// How steady light is, and how complete. "power": what injection puts into the grid, of what the light sends. "first
// tick": of the change that a moved light makes, the share that its first tick leaves out, against a session that never
// saw the light elsewhere. "flicker": a light that moves by a tenth of a cell a step; the second difference of
// (ours - truth) at points of the walls over three steps, relative to the truth there, which moves smoothly.
//   change_bench [--grids 32,64] [--steps N] [--rows FILE]
//
// LPV_BENCH_LUCY names the PLY file of Stanford's Lucy; a bumpy sphere of as many triangles takes its place.

#include <CLI/CLI.hpp>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <vector>

#include "bench/rows.h"
#include "core_scene.h"
#include "reference/meshes.h"
#include "reference/receivers.h"
#include "scene/lookup.h"

namespace {

using namespace lpv;
using bench::NamedMesh;
using Colours = std::vector<glm::dvec3>;

struct Way {
  std::string name;
  Transport transport;
  Injection injection;
  InjectionMethod method = InjectionMethod::kCompute;
  int samples = 0;
};

std::vector<Way> injections() {
  using enum InjectionMethod;
  constexpr auto kPropagate = Transport::kPropagate;
  return {{"PROPAGATE, dense 1", kPropagate, Injection::kCount, kDense, 1},
          {"PROPAGATE, dense 100", kPropagate, Injection::kCount, kDense, 100},
          {"PROPAGATE, COUNT", kPropagate, Injection::kCount},
          {"PROPAGATE, FLUX", kPropagate, Injection::kFlux}};
}

std::vector<Way> ways() {
  std::vector<Way> out = injections();
  out.push_back({"GATHER", Transport::kGather, Injection::kFlux});
  out.push_back({"DIRECT", Transport::kDirect, Injection::kFlux});
  return out;
}

/// In the unit cube's middle, a quarter of it across, turned.
Scene sceneOf(const NamedMesh& named, const Way& way, int cells, const glm::dvec3& moved) {
  Scene scene;
  scene.grid = {glm::dvec3(0.0), 1.0 / cells, glm::ivec3(cells)};
  scene.options.transport = way.transport;
  scene.options.followTransport();
  scene.options.injection = way.injection;
  scene.options.method = way.method;
  scene.options.denseSamples = way.samples;
  scene.options.visibility = Visibility::kOff;
  if (way.transport == Transport::kPropagate) scene.options.iterations = 2 * cells;
  auto light = std::make_shared<Light>();
  light->name = "light";
  light->mesh = named.mesh;
  const glm::dvec3 size = named.mesh->bounds.extent();
  Transform& t = light->transform;
  t.scale = glm::dvec3(0.25 / std::max({size.x, size.y, size.z}));
  t.rotation = glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, 3)));
  t.translation = glm::dvec3(0.5) - t.rotation * (t.scale * named.mesh->bounds.centre()) + moved / double(cells);
  scene.lights["light"] = light;
  return scene;
}

TickResult tick(const Scene& scene, SessionKey session, bool injected = false) {
  static std::uint64_t revision = 0;
  TickRequest request;
  request.session = session;
  auto copy = std::make_shared<Scene>(scene);
  copy->revision = ++revision;
  request.scene = copy;
  request.transported = !injected;
  request.injected = injected;
  return bench::tick(std::move(request));
}

Colours seen(const Volume& volume, const Scene& scene, const std::vector<reference::Receiver>& walls) {
  const bool direct = scene.options.transport == Transport::kDirect;
  const Lookup lookup = scene.options.lookup;
  Colours out;
  for (const reference::Receiver& wall : walls) {
    out.push_back((direct ? irradianceWithNearField(volume, lookup, wall.position, wall.normal)
                          : irradianceAt(volume, lookup, wall.position, wall.normal))
                      .rgb);
  }
  return out;
}

double distance(const Colours& a, const Colours& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += glm::dot(a[i] - b[i], a[i] - b[i]);
  return std::sqrt(sum);
}

bench::Row rowOf(const char* quantity, const NamedMesh& light, const Way& way, int cells) {
  return {light.name, quantity, {{"grid", double(cells)}, {"way", way.name}}, {}};
}

/// A lobe of a cell's power P has L00 = kLobe0 P / pi.
void power(const NamedMesh& light, const Way& way, int cells, bench::Rows* rows) {
  const Scene scene = sceneOf(light, way, cells, glm::dvec3(0.0));
  const VolumePtr injected = tick(scene, 1, true).injected;
  double sum = 0.0;
  for (std::size_t i = 0; i < injected->layers[0].coefficients.size(); i += 12)
    sum += injected->layers[0].coefficients[i];
  double sent = 0.0;
  for (const reference::Emitter& e : reference::emittersOf(scene).triangles) sent += e.area() * e.radiance.r;
  bench::Row row = rowOf("power", light, way, cells);
  const double share = sum / (sh::kLobe0 * sent);
  row.values = {{"share", share}, {"power_error", std::abs(share - 1.0)}};
  rows->add(row);
  bench::engine().forget(1);
}

void firstTick(const NamedMesh& light, const Way& way, int cells, bench::Rows* rows) {
  const Scene before = sceneOf(light, way, cells, glm::dvec3(0.0));
  const Scene after = sceneOf(light, way, cells, {3.3, -2.6, 1.9});
  const std::vector<reference::Receiver> walls = reference::wallReceivers(before.grid);
  const Colours old = seen(*tick(before, 1).transported, before, walls);
  const Colours first = seen(*tick(after, 1).transported, after, walls);
  const Colours fresh = seen(*tick(after, 2).transported, after, walls);
  bench::Row row = rowOf("first tick", light, way, cells);
  row.values = {{"missing_error", distance(first, fresh) / distance(old, fresh)}};
  rows->add(row);
  for (const SessionKey session : {1, 2}) bench::engine().forget(session);
}

void flicker(const NamedMesh& light, const Way& way, int cells, int steps, bench::Rows* rows) {
  std::vector<Colours> errors;
  std::vector<double> seconds;
  for (int step = 0; step < steps; ++step) {
    const Scene scene = sceneOf(light, way, cells, 0.1 * step * glm::normalize(glm::dvec3(3, 1, 2)));
    const std::vector<reference::Receiver> walls = reference::wallReceivers(scene.grid);
    const Colours truth = reference::irradiances(reference::emittersOf(scene).triangles, walls);
    Colours error = seen(*tick(scene, 1).transported, scene, walls);
    double mean = 0.0;
    for (const glm::dvec3& t : truth) mean += t.r / double(truth.size());
    for (std::size_t i = 0; i < error.size(); ++i) {
      error[i] -= truth[i];
      if (step < 2) continue;
      const double second = error[i].r - 2.0 * errors[step - 1][i].r + errors[step - 2][i].r;
      seconds.push_back(std::abs(second) / std::max(truth[i].r, 0.05 * mean));
    }
    errors.push_back(std::move(error));
  }
  bench::engine().forget(1);
  double squares = 0.0;
  for (const double s : seconds) squares += s * s;
  bench::Row row = rowOf("flicker", light, way, cells);
  row.values = {{"second_difference_rms_error", std::sqrt(squares / double(seconds.size()))},
                {"second_difference_worst", *std::max_element(seconds.begin(), seconds.end())}};
  rows->add(row);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<int> grids = {32, 64};
  int steps = 40;
  std::string rowsFile;
  CLI::App app("Power, what arrives with the first tick, and how steady light is while a lamp moves");
  app.add_option("--grids", grids, "Cells along an edge; flicker and first ticks with the first")->delimiter(',');
  app.add_option("--steps", steps, "of a tenth of a cell")->check(CLI::Range(3, 1000))->capture_default_str();
  app.add_option("--rows", rowsFile, bench::kRowsHelp);
  CLI11_PARSE(app, argc, argv);
  bench::Rows rows(rowsFile, bench::engine().device().name);
  for (const NamedMesh& light : bench::paperMeshes()) {
    for (const int cells : grids) {
      for (const Way& way : injections()) power(light, way, cells, &rows);
    }
  }
  const std::vector<NamedMesh> moving = {bench::paperMeshes()[0], bench::paperMeshes()[3]};
  for (const NamedMesh& light : moving) {
    for (const Way& way : ways()) firstTick(light, way, grids.front(), &rows);
  }
  for (const NamedMesh& light : moving) {
    for (const Way& way : ways()) flicker(light, way, grids.front(), steps, &rows);
  }
  return 0;
}
