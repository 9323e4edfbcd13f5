// The paper's figures 5 and 6, diffuse: the light of each of its meshes in a room, 64^3 cells, injected by dense
// samples, 1, 100 and 1000 a triangle, by COUNT ("our method" there) and by FLUX, transported by PROPAGATE as there,
// and by this server's own GATHER. Frames of irradiance, each against the truth: closed forms for polygons, without
// occluders; the light is not shown, so every pixel is of a wall. The lights: the five meshes, a quad with a texture,
// one with emission directions (paper 3.2, 3.3). Pictures are raw floats, red, green and blue, rows from the top:
// FOLDER/LIGHT/METHOD.f32.
//   paper_bench [--pictures FOLDER] [--grid N] [--light NAME] [--rows FILE]
//
// LPV_BENCH_LUCY names the PLY file of Stanford's Lucy; a bumpy sphere of as many triangles takes its place.

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <vector>

#include "bench/rows.h"
#include "core_scene.h"
#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "reference/receivers.h"
#include "reference/texel.h"
#include "reference/textures.h"

namespace {

using namespace lpv;
using Colours = std::vector<glm::dvec3>;

constexpr glm::ivec2 kSize{160, 90};
const Bounds kRoom{glm::dvec3(-2.0, 0.0, -2.0), glm::dvec3(2.0, 3.0, 2.0)};

struct Named {
  std::string name;
  MeshPtr mesh;
  TexturePtr texture = nullptr;
};

struct Method {
  std::string name;
  Transport transport;
  Injection injection;
  InjectionMethod method;
  int samples = 0;
};

/// Directions that open like a bowl, 45 degrees at the corners.
MeshPtr directedQuad(int n) {
  Mesh mesh = *reference::quadOf(n);
  const glm::vec3 normal =
      glm::normalize(glm::cross(mesh.positions[mesh.triangles[0].y] - mesh.positions[mesh.triangles[0].x],
                                mesh.positions[mesh.triangles[0].z] - mesh.positions[mesh.triangles[0].x]));
  const glm::vec3 centre(mesh.bounds.centre());
  const float corner = glm::length(glm::vec3(mesh.bounds.extent())) / 2.0F;
  for (const glm::vec3& p : mesh.positions) mesh.directions.push_back(glm::normalize(normal + (p - centre) / corner));
  if (!finishMesh(mesh).ok()) std::exit(1);
  return std::make_shared<const Mesh>(std::move(mesh));
}

std::vector<Named> lights() {
  std::vector<Named> out;
  for (const auto& [name, mesh] : bench::paperMeshes()) out.push_back({name, mesh});
  out.push_back({"quad with a texture", reference::quad(), reference::noise(8, 8)});
  out.push_back({"quad with emission directions", directedQuad(4)});
  return out;
}

std::vector<Method> methods() {
  using enum InjectionMethod;
  constexpr auto kPropagate = Transport::kPropagate;
  return {{"dense 1", kPropagate, Injection::kCount, kDense, 1},
          {"dense 100", kPropagate, Injection::kCount, kDense, 100},
          {"dense 1000", kPropagate, Injection::kCount, kDense, 1000},
          {"COUNT", kPropagate, Injection::kCount, kCompute},
          {"FLUX", kPropagate, Injection::kFlux, kCompute},
          {"FLUX, GATHER", Transport::kGather, Injection::kFlux, kCompute}};
}

/// In the middle of the room, turned, 1 m across, seen from a corner.
Scene sceneOf(const Named& named, const Method& method, int cells) {
  Scene scene = bench::roomWith(named.mesh, {0.0, 1.5, 0.0}, cells);
  LightingSettings options = method.transport == Transport::kPropagate ? LightingSettings::paper() : LightingSettings();
  options.grid = scene.options.grid;
  if (method.transport != Transport::kPropagate) options.followTransport();
  options.injection = method.injection;
  options.method = method.method;
  options.denseSamples = method.samples;
  options.visibility = Visibility::kOff;
  if (method.transport == Transport::kPropagate) options.iterations = 2 * cells;
  scene.options = options;
  auto light = std::make_shared<Light>(*scene.lights.at("light"));
  light->texture = named.texture;
  light->visibleToCamera = false;  // so that every pixel shows a wall
  light->transform.rotation = glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, 3)));
  const glm::dvec3 size = named.mesh->bounds.extent();
  light->transform.scale = glm::dvec3(1.0 / std::max({size.x, size.y, size.z}));
  light->transform.translation =
      glm::dvec3(0.0, 1.5, 0.0) - light->transform.rotation * (light->transform.scale * named.mesh->bounds.centre());
  scene.lights["light"] = light;
  return scene;
}

Camera fromTheCorner() {
  Camera camera;
  camera.eye = {1.9, 2.4, 1.9};
  camera.target = {-0.4, 1.0, -0.4};
  camera.fovDegrees = 60.0;
  return camera;
}

/// Where the ray from the inside of the room leaves it.
reference::Receiver wallAt(const glm::dvec3& eye, const glm::dvec3& ray) {
  reference::Receiver out;
  double nearest = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    if (ray[axis] == 0.0) continue;
    const double wall = ray[axis] > 0.0 ? kRoom.max[axis] : kRoom.min[axis];
    const double t = (wall - eye[axis]) / ray[axis];
    if (t >= nearest) continue;
    nearest = t;
    out.normal = glm::dvec3(0.0);
    out.normal[axis] = ray[axis] > 0.0 ? -1.0 : 1.0;
  }
  out.position = eye + nearest * ray;
  return out;
}

std::vector<reference::Receiver> wallsSeen() {
  const Camera camera = fromTheCorner();
  std::vector<reference::Receiver> out;
  for (int y = 0; y < kSize.y; ++y) {
    for (int x = 0; x < kSize.x; ++x) {
      const double u = (x + 0.5) / kSize.x, v = (y + 0.5) / kSize.y;
      out.push_back(wallAt(camera.eye, camera.rayDirection(u, v, double(kSize.x) / kSize.y)));
    }
  }
  return out;
}

/// Lobes of parts so small that each is a point.
glm::dvec3 irradianceOfLobes(const std::vector<reference::Emitter>& parts, const reference::Receiver& at) {
  glm::dvec3 sum(0.0);
  for (const reference::Emitter& part : parts) {
    const glm::dvec3 third(1.0 / 3.0);
    const glm::dvec3 to = part.positionAt(third) - at.position;
    const double r = glm::length(to);
    const double cosines =
        std::max(0.0, glm::dot(at.normal, to) / r) * std::max(0.0, -glm::dot(part.directionAt(third), to) / r);
    sum += part.radiance * (part.area() * cosines / (r * r));
  }
  return sum;
}

Colours truthOf(Named named, const std::vector<reference::Receiver>& walls) {
  const TexturePtr texture = named.texture;
  const bool directed = !named.mesh->directions.empty();
  named.texture = nullptr;
  if (texture != nullptr) named.mesh = reference::quadOf(96);
  if (directed) named.mesh = directedQuad(64);
  std::vector<reference::Emitter> parts = reference::emittersOf(sceneOf(named, methods().front(), 64)).triangles;
  if (texture != nullptr) {
    for (reference::Emitter& e : parts) e.radiance *= reference::bilinear(*texture, e.uvAt(glm::dvec3(1.0 / 3.0)));
  }
  if (!directed) return reference::irradiances(parts, walls);
  Colours out;
  for (const reference::Receiver& wall : walls) out.push_back(irradianceOfLobes(parts, wall));
  return out;
}

Colours coloursOf(const Frame& frame) {
  Colours out;
  for (std::size_t i = 0; i < frame.rgb32f.size(); i += 3)
    out.emplace_back(frame.rgb32f[i], frame.rgb32f[i + 1], frame.rgb32f[i + 2]);
  return out;
}

void write(const std::string& folder, const std::string& light, const std::string& name, const Colours& colours) {
  if (folder.empty()) return;
  std::filesystem::create_directories(std::filesystem::path(folder) / light);
  std::ofstream file(std::filesystem::path(folder) / light / (name + ".f32"), std::ios::binary);
  for (const glm::dvec3& c : colours) {
    const glm::vec3 rounded(c);
    file.write(reinterpret_cast<const char*>(&rounded), sizeof rounded);
  }
}

/// The frame, and what a tick took in which the light had moved, ms.
std::pair<Colours, double> measure(const Scene& scene) {
  static std::uint64_t revision = 0;
  const glm::dvec3 place = scene.lights.at("light")->transform.translation;
  std::vector<double> took;
  TickRequest request;
  TickResult result;
  for (const double away : {0.02, 0.01, 0.0}) {  // the last is the one that is looked at
    auto moved = std::make_shared<Scene>(*bench::movedTo(scene, place + glm::dvec3(away, 0.0, 0.0)));
    moved->revision = ++revision;
    request.session = 1;
    request.scene = moved;
    FrameRequest frame;
    frame.view = 1;
    frame.camera = fromTheCorner();
    frame.size = kSize;
    frame.format = PixelFormat::kRgb32F;
    frame.quantity = FrameQuantity::kIrradiance;
    request.frames = {frame};
    const auto begun = std::chrono::steady_clock::now();
    result = bench::tick(request);
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - begun;
    if (away < 0.02) took.push_back(ms.count());
  }
  return {coloursOf(*result.frames[0]), bench::medianOf(took)};
}

double nrmse(const Colours& ours, const Colours& truth) {
  double squares = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const glm::dvec3 apart = ours[i] - truth[i];
    squares += glm::dot(apart, apart) / 3.0;
    mean += (truth[i].r + truth[i].g + truth[i].b) / 3.0;
  }
  const auto n = double(truth.size());
  return std::sqrt(squares / n) / (mean / n);
}

void compare(const Named& light, int cells, const std::string& folder, bench::Rows* rows) {
  const std::vector<reference::Receiver> walls = wallsSeen();
  const Colours truth = truthOf(light, walls);
  write(folder, light.name, "truth", truth);
  for (const Method& method : methods()) {
    const auto [ours, milliseconds] = measure(sceneOf(light, method, cells));
    write(folder, light.name, method.name, ours);
    const reference::Errors errors = reference::errors(ours, truth);
    rows->add({light.name,
               "paper's pictures",
               {{"grid", double(cells)}, {"method", method.name}},
               {{"raw_l2", errors.raw},
                {"shape_l2", errors.shape},
                {"nrmse", nrmse(ours, truth)},
                {"worst", errors.worst},
                {"log_ratio_p95", errors.logRatio95},
                {"moved_tick_ms", milliseconds}}});
  }
}

}  // namespace

int main(int argc, char** argv) {
  int cells = 64;
  std::string folder;
  std::string only;
  std::string rowsFile;
  CLI::App app("The paper's figures 5 and 6, diffuse, against the truth");
  app.add_option("--grid", cells, "cells along the longest edge")->check(CLI::Range(8, 128))->capture_default_str();
  app.add_option("--light", only, "Only the light whose name begins so");
  app.add_option("--pictures", folder, "Write the irradiance of every frame there, as floats");
  app.add_option("--rows", rowsFile, bench::kRowsHelp);
  CLI11_PARSE(app, argc, argv);
  bench::Rows rows(rowsFile, bench::engine().device().name);
  for (const Named& light : lights()) {
    if (light.name.rfind(only, 0) == 0) compare(light, cells, folder, &rows);
  }
  return 0;
}
