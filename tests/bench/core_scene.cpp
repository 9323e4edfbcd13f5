#include "core_scene.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <future>
#include <iostream>
#include <sstream>

#include "engine/device_choice.h"
#include "reference/meshes.h"

namespace lpv::bench {

namespace {

template <typename T>
T orExit(Expected<T> value, const char* what) {
  if (value.ok()) return std::move(*value);
  std::cerr << what << ": " << value.status().message() << "\n";
  std::exit(1);
}

std::size_t countAfter(const std::string& header, const std::string& key) {
  const auto at = header.find(key);
  return at == std::string::npos ? 0 : std::stoul(header.substr(at + key.size()));
}

template <typename T>
T next(std::istream& in) {
  T value{};
  in.read(reinterpret_cast<char*>(&value), sizeof value);
  return value;
}

/// Binary little-endian PLY of float x, y, z, nx, ny, nz and triangles: what the shared Lucy is.
MeshPtr readLucy(const char* path) {
  std::ifstream in(path, std::ios::binary);
  std::string header;
  for (std::string line; std::getline(in, line) && line != "end_header";) header += line + "\n";
  Mesh mesh;
  mesh.positions.resize(countAfter(header, "element vertex "));
  mesh.triangles.resize(countAfter(header, "element face "));
  for (glm::vec3& p : mesh.positions) {
    p = next<glm::vec3>(in) * 0.001F;
    next<glm::vec3>(in);
  }
  for (glm::uvec3& t : mesh.triangles) {
    next<std::uint8_t>(in);
    t = next<glm::uvec3>(in);
  }
  const Status status = finishMesh(mesh);
  if (!in || !status.ok()) {
    std::cerr << path << " cannot be read: " << status.message() << "\n";
    std::exit(1);
  }
  return std::make_shared<Mesh>(std::move(mesh));
}

}  // namespace

Engine& engine() {
  static const std::unique_ptr<Engine> made = orExit(startEngine({}), "no device");
  return *made;
}

TickResult tick(TickRequest request) {
  std::promise<Expected<TickResult>> promise;
  auto future = promise.get_future();
  engine().submit(std::move(request), [&](Expected<TickResult> result) { promise.set_value(std::move(result)); });
  return orExit(future.get(), "tick");
}

MeshPtr statue() {
  static const MeshPtr mesh = [] {
    const char* path = std::getenv("LPV_BENCH_LUCY");
    return path != nullptr ? readLucy(path) : reference::bumpySphere(33446);
  }();
  return mesh;
}

std::vector<NamedMesh> paperMeshes() {
  return {{"quad", reference::quad()},
          {"pyramid", reference::pyramid()},
          {"tube", reference::tube()},
          {"sphere 720", reference::sphere()},
          {std::getenv("LPV_BENCH_LUCY") != nullptr ? "Lucy" : "bumpy 33446", statue()}};
}

Scene roomWith(const MeshPtr& mesh, const glm::dvec3& position, int cells) {
  Scene scene;
  const Bounds room{glm::dvec3(-2.0, 0.0, -2.0), glm::dvec3(2.0, 3.0, 2.0)};
  scene.options = LightingSettings::paper();
  scene.options.grid.longest = cells;
  scene.grid = orExit(makeGrid(scene.options.grid, room), "grid");
  auto light = std::make_shared<Light>();
  light->name = "light";
  light->mesh = mesh;
  light->transform.translation = position;
  light->transform.scale = glm::dvec3(1.0 / glm::length(mesh->bounds.extent()));
  light->radiance = glm::dvec3(10.0);
  scene.lights[light->name] = light;
  auto walls = std::make_shared<Surface>();
  walls->name = "walls";
  walls->mesh = reference::box(room.min, room.max, true);
  scene.surfaces[walls->name] = walls;
  return scene;
}

/// By multiples of irrational numbers.
glm::dvec3 spreadInRoom(int i) {
  const glm::dvec3 unit = glm::fract(double(i) * glm::dvec3(0.8191725134, 0.6710436067, 0.5497004779));
  return glm::dvec3(-1.8, 0.2, -1.8) + unit * glm::dvec3(3.6, 2.6, 3.6);
}

Scene roomOfLights(int lights, int cells) {
  Scene scene = roomWith(reference::sphere(), {0.0, 1.5, 0.0}, cells);
  scene.options = {};
  scene.options.transport = Transport::kGather;
  scene.options.followTransport();
  scene.options.visibility = Visibility::kOff;
  scene.options.bounces = 0;
  const Light lamp = *scene.lights.begin()->second;
  for (int i = 1; i < lights; ++i) {
    auto light = std::make_shared<Light>(lamp);
    light->name = "light" + std::to_string(i);
    light->transform.translation = spreadInRoom(i);
    light->transform.scale = glm::dvec3(0.1 / std::sqrt(double(lights)));
    scene.lights[light->name] = light;
  }
  return scene;
}

ScenePtr movedTo(const Scene& scene, const glm::dvec3& position) {
  auto moved = std::make_shared<Scene>(scene);
  for (auto& [name, light] : moved->lights) {
    auto copy = std::make_shared<Light>(*light);
    copy->transform.translation = position;
    light = copy;
  }
  moved->revision++;
  return moved;
}

double secondsOf(const TickReport& report, Stage stage) {
  for (const StageTime& time : report.stages) {
    if (time.stage == stage) return time.seconds;
  }
  return 0.0;
}

}  // namespace lpv::bench
