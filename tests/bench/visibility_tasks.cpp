#include "visibility_tasks.h"

#include <cmath>
#include <memory>
#include <random>

#include "reference/meshes.h"
#include "reference/occlusion.h"

namespace lpv::bench {

namespace {

constexpr int kTrueStrata = 48;
constexpr double kOffset = 1e-6;  ///< metres, along a receiver's normal
constexpr double kEnd = 1.0 - 1e-6;
const glm::dvec3 kUp(0, 1, 0);

glm::dquat about(const glm::dvec3& axis, double degrees) { return glm::angleAxis(glm::radians(degrees), axis); }

void add(Scene& scene, const std::string& name, const MeshPtr& mesh, const Transform& transform) {
  auto surface = std::make_shared<Surface>();
  surface->name = name;
  surface->mesh = mesh;
  surface->transform = transform;
  scene.surfaces[name] = surface;
}

void addFloor(Scene& scene) {
  add(scene, "floor", reference::quad(), {{0, 0, 0}, about({1, 0, 0}, -90), {3.9, 3.9, 1}});
}

/// `rotation`: of a quad that faces +z.
void addLamp(Scene& scene, const glm::dvec3& at, const glm::dquat& rotation, double edge) {
  auto lamp = std::make_shared<Light>();
  lamp->name = "lamp";
  lamp->mesh = reference::quad();
  lamp->transform = {at, rotation, {edge, edge, 1}};
  scene.lights["lamp"] = lamp;
}

MeshPtr unitBox() { return reference::box(glm::dvec3(-0.5), glm::dvec3(0.5)); }

VisibilityTask withTruth(VisibilityTask task) {
  const reference::Occlusion occlusion(occludersOf(task.scene));
  std::uint32_t seed = 1u << 20;
  for (const reference::Receiver& r : task.receivers) {
    const glm::dvec3 from = r.position + kOffset * r.normal;
    int seen = 0;
    for (const glm::dvec3& p : lampPoints(task.scene, kTrueStrata, seed++))
      seen += int(occlusion.meeting({from, glm::mix(from, p, kEnd)}, 0, 0.0) != reference::Meeting::kSome);
    task.truth.push_back(double(seen) / (kTrueStrata * kTrueStrata));
  }
  return task;
}

/// Points of a square about `middle`, one in each of n x n strata.
std::vector<reference::Receiver> square(const glm::dvec3& middle, const glm::dvec3& right, const glm::dvec3& up, int n,
                                        const glm::dvec3& normal) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<reference::Receiver> out;
  for (int i = 0; i < n * n; ++i) {
    const double u = (i % n + share(random)) / n - 0.5, v = (int(i / n) + share(random)) / n - 0.5;
    out.push_back({middle + u * right + v * up, normal});
  }
  return out;
}

}  // namespace

VisibilityTask penumbra() {
  VisibilityTask task = {.name = "penumbra", .scene = {}, .receivers = {}, .truth = {}};
  addFloor(task.scene);
  add(task.scene, "box", unitBox(), {{0.03, 0.8, -0.02}, about(kUp, 17), {0.8, 0.4, 0.8}});
  addLamp(task.scene, {0, 2.4, 0}, about({1, 0, 0}, 90), 1.0);
  task.receivers = square(glm::dvec3(0), {3.2, 0, 0}, {0, 0, 3.2}, 24, kUp);
  return withTruth(std::move(task));
}

VisibilityTask bars(double lamp, double depth) {
  const std::string size = lamp < 1.0 ? std::to_string(int(std::lround(100.0 * lamp))) + " cm" : "1 m";
  VisibilityTask task = {.name = (depth < 0.05 ? "flat 5 cm bars, lamp of " : "5 cm bars, lamp of ") + size,
                         .scene = {},
                         .receivers = {},
                         .truth = {}};
  add(task.scene, "wall", reference::quad(), {{0, 1.5, -1}, glm::dquat(1, 0, 0, 0), {3.8, 2.8, 1}});
  for (int i = 0; i < 24; ++i) {
    const Transform pose = {{0.1 * i - 1.17, 1.5, 0}, glm::dquat(1, 0, 0, 0), {0.05, 2.8, depth}};
    add(task.scene, "bar " + std::to_string(i), unitBox(), pose);
  }
  addLamp(task.scene, {0, 1.5, 1.5}, about(kUp, 180), lamp);
  task.receivers = square({0, 1.5, -1}, {1, 0, 0}, {0, 1, 0}, 12, {0, 0, 1});
  return withTruth(std::move(task));
}

VisibilityTask behindWall(double metres, double degrees) {
  VisibilityTask task = {.name = "behind a wall", .scene = {}, .receivers = {}, .truth = {}};
  addFloor(task.scene);
  const glm::dquat turn = about(kUp, degrees);
  add(task.scene, "wall", reference::quad(), {{0.0, 1.5, 0.0}, turn * about(kUp, 90), {3.6, 3.0, 1}});
  addLamp(task.scene, turn * glm::dvec3(-1.3, 1.5, 0), turn * about(kUp, 90), 0.8);
  for (int i = 0; i < 16; ++i) task.receivers.push_back({turn * glm::dvec3(metres, 0, 0.1 * i - 0.77), kUp});
  return withTruth(std::move(task));
}

VisibilityTask atFoot(double metres, double degrees) {
  VisibilityTask task = {.name = "at the foot of a box", .scene = {}, .receivers = {}, .truth = {}};
  addFloor(task.scene);
  const glm::dquat turn = about(kUp, degrees);
  add(task.scene, "box", unitBox(), {{0, 0.25, 0}, turn, {0.8, 0.5, 0.8}});
  addLamp(task.scene, turn * glm::dvec3(0.4, 2.4, 0), turn * about({1, 0, 0}, 90), 1.0);
  for (int i = 0; i < 8; ++i) task.receivers.push_back({turn * glm::dvec3(0.4 + metres, 0, 0.05 * i - 0.17), kUp});
  return withTruth(std::move(task));
}

Grid taskGrid(int cells, int place) {
  const double cell = kTaskEdge / cells;
  // The golden ratio's fractions, so that surfaces lie anywhere in their cells.
  const glm::dvec3 shift = glm::fract(double(place + 1) * glm::dvec3(0.618, 0.382, 0.854));
  return {glm::dvec3(-2.0, -0.5, -2.0) + cell * (shift - 0.5), cell, glm::ivec3(cells)};
}

std::vector<glm::dvec3> lampPoints(const Scene& scene, int n, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const glm::dmat4 m = scene.lights.at("lamp")->transform.worldFromObject();
  std::vector<glm::dvec3> out;
  for (int i = 0; i < n * n; ++i) {
    const double u = (i % n + share(random)) / n - 0.5, v = (int(i / n) + share(random)) / n - 0.5;
    out.emplace_back(m * glm::dvec4(u, v, 0.0, 1.0));
  }
  return out;
}

glm::dvec3 lampNormal(const Scene& scene) { return scene.lights.at("lamp")->transform.rotation * glm::dvec3(0, 0, 1); }

}  // namespace lpv::bench
