#include "bench/codec_scene.h"

#include <array>
#include <cstdlib>
#include <string>

#include "bench/core_scene.h"
#include "engine/engine.h"
#include "scene/scene.h"

namespace lpv::bench {
namespace {

using Corners = std::array<glm::vec3, 4>;

/// The room, metres, +Y up, and its windows: those of "The White Room" (Jay-Artist).
constexpr glm::dvec3 kRoomMin(-2.6, 0.0, -0.4);
constexpr glm::dvec3 kRoomMax(3.1, 3.2, 8.2);
const Corners kLeft{
    {{-0.853F, 1.044F, -0.166F}, {-0.665F, 2.547F, 0.454F}, {-1.401F, 2.547F, 0.853F}, {-1.817F, 1.044F, 0.357F}}};
const Corners kMiddle{
    {{-0.345F, 2.547F, 0.367F}, {-0.521F, 1.044F, -0.268F}, {0.943F, 1.044F, -0.268F}, {0.773F, 2.547F, 0.367F}}};
const Corners kRight{
    {{2.25F, 1.044F, 0.36F}, {1.829F, 2.547F, 0.853F}, {1.093F, 2.547F, 0.454F}, {0.808F, 1.044F, -0.425F}}};
const Corners kBack{
    {{-1.7F, 1.065F, 8.173F}, {-1.7F, 2.991F, 8.173F}, {1.414F, 2.991F, 8.173F}, {1.414F, 1.065F, 8.173F}}};
constexpr double kWindow = 5.0;  // W/(sr m^2)
constexpr double kBackWindow = 1.6;
/// The television: 1.105 x 0.695 m over the fireplace, facing +X.
constexpr float kScreenX = -1.881F;
constexpr float kScreenLow = 1.499F;
constexpr float kScreenHigh = 2.194F;
constexpr float kScreenFrom = 2.326F;
constexpr float kScreenTo = 3.431F;

void add(Scene& scene, const std::string& name, const Corners& corners, const glm::dvec3& radiance, bool twoSided) {
  auto mesh = std::make_shared<Mesh>();
  mesh->positions.assign(corners.begin(), corners.end());
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  if (!finishMesh(*mesh).ok()) std::exit(1);
  auto light = std::make_shared<Light>();
  light->name = name;
  light->mesh = mesh;
  light->radiance = radiance;
  light->twoSided = twoSided;
  scene.lights[name] = light;
}

/// A band of the screen, from share `low` to share `high` of its height.
Corners band(float low, float high, float shift) {
  const float bottom = kScreenLow + low * (kScreenHigh - kScreenLow);
  const float top = kScreenLow + high * (kScreenHigh - kScreenLow);
  const float from = kScreenFrom + shift;
  const float to = kScreenTo + shift;
  return {{{kScreenX, top, from}, {kScreenX, top, to}, {kScreenX, bottom, to}, {kScreenX, bottom, from}}};
}

Scene livingRoom() {
  Scene scene;
  scene.options.grid.dims = glm::ivec3(32);
  scene.options.followTransport();
  scene.grid = *makeGrid(scene.options.grid, {kRoomMin, kRoomMax});
  add(scene, "left", kLeft, glm::dvec3(kWindow), true);
  add(scene, "middle", kMiddle, glm::dvec3(kWindow), true);
  add(scene, "right", kRight, glm::dvec3(kWindow), true);
  add(scene, "back", kBack, glm::dvec3(kBackWindow), true);
  return scene;
}

}  // namespace

std::vector<VolumePtr> movingTelevision(int results, double cellsPerResult) {
  Scene scene = livingRoom();
  std::vector<VolumePtr> out;
  for (int i = 0; i < results; ++i) {
    const auto shift = float(cellsPerResult * scene.grid.cell * i);
    add(scene, "sky", band(0.6F, 1.0F, shift), {1.2, 2.2, 6.0}, false);
    add(scene, "sun", band(0.3F, 0.6F, shift), {7.0, 4.0, 1.2}, false);
    add(scene, "hills", band(0.0F, 0.3F, shift), {0.6, 1.8, 0.5}, false);
    ++scene.revision;
    TickRequest request;
    request.session = 1;
    request.scene = std::make_shared<const Scene>(scene);
    request.transported = true;
    out.push_back(tick(std::move(request)).transported);
  }
  return out;
}

}  // namespace lpv::bench
