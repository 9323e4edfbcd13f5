#include "gpu/frame/light_views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace lpv::test {
namespace {

constexpr double kAlbedo = 0.5;
constexpr double kHeight = 2.0;  ///< of the camera above the floor

/// Lowest point of a light.
double lowest(const Light& light) {
  double least = std::numeric_limits<double>::infinity();
  for (const glm::vec3& p : light.mesh->positions)
    least = std::min(least, (light.transform.worldFromObject() * glm::dvec4(glm::dvec3(p), 1.0)).z);
  return least;
}

}  // namespace

Scene floorScene(Transport transport, const MeshPtr& mesh) {
  Scene scene = smallScene();
  scene.options = {};
  scene.options.transport = transport;
  scene.options.followTransport();
  scene.options.quality = Quality::kAccurate;  // frames with a near field
  scene.options.visibility = Visibility::kOff;  // truthOn has no shadows
  scene.grid = {glm::dvec3(-2.0), 0.2, glm::ivec3(20)};
  Light& light = lightOf(scene);
  light.mesh = mesh;
  const glm::dvec3 size = mesh->bounds.extent();
  light.transform.scale = glm::dvec3(1.0 / std::max({size.x, size.y, size.z}));
  light.transform.rotation = rotationFromEulerDegrees({180.0, 0.0, 13.0});
  light.transform.translation = {0.07, -0.11, 0.23};
  Surface& floor = addSurface(scene, "floor", reference::quad());
  floor.transform.scale = glm::dvec3(3.6);
  floor.albedo = glm::dvec3(kAlbedo);
  return scene;
}

FloorView floorView(Scene& scene, double cellsBelow, const glm::ivec2& size) {
  const double z = lowest(*scene.lights.at("light")) - cellsBelow * scene.grid.cell;
  auto floor = std::make_shared<Surface>(*scene.surfaces.at("floor"));
  floor->transform.translation.z = z;
  scene.surfaces["floor"] = floor;
  ++scene.revision;
  FloorView view;
  Camera camera;
  camera.eye = {0.0, 0.0, z + kHeight};
  camera.target = {0.0, 0.0, z};
  camera.fovDegrees = 80.0;  // 1.68 m up and down
  camera.near = kHeight - 0.5 * std::min(cellsBelow, 1.0) * scene.grid.cell;
  view.frame = linearFrame(camera, size);
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const glm::dvec3 ray = camera.rayDirection((x + 0.5) / size.x, (y + 0.5) / size.y, double(size.x) / size.y);
      view.points.push_back({camera.eye + ray * (-kHeight / ray.z), {0, 0, 1}});
    }
  }
  return view;
}

std::vector<glm::dvec3> floorIrradiance(const Frame& frame, const FloorView& view) {
  std::vector<glm::dvec3> out;
  for (std::size_t i = 0; i < view.points.size(); ++i) {
    const int width = frame.size.x;
    out.push_back(std::acos(-1.0) / kAlbedo * pixel(frame, int(i) % width, int(i) / width));
  }
  return out;
}

std::vector<glm::dvec3> truthOn(const Scene& scene, const FloorView& view) {
  return reference::irradiances(reference::emittersOf(scene).triangles, view.points);
}

std::vector<reference::Receiver> receiversAway(const Grid& grid, const std::vector<reference::Emitter>& emitters,
                                               double cells, std::size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0.02, 0.98);
  std::normal_distribution<double> normal;
  std::vector<reference::Receiver> out;
  while (out.size() < count) {
    const double x = share(random), y = share(random), z = share(random);
    const double nx = normal(random), ny = normal(random), nz = normal(random);
    const glm::dvec3 p = grid.worldFromGrid(glm::dvec3(x, y, z) * glm::dvec3(grid.dims));
    double solidAngle = 0.0, nearest = 1e9;
    for (const reference::Emitter& e : emitters) {
      const glm::dvec3 a = e.corners[0] - p, b = e.corners[1] - p, c = e.corners[2] - p;
      const double sign = glm::dot(glm::cross(b - a, c - a), a) > 0.0 ? 1.0 : -1.0;
      solidAngle += sign * reference::triangleSolidAngle(a, b, c);
      nearest = std::min(nearest, reference::distanceToTriangle(p, e.corners));
    }
    const bool inside = solidAngle > 6.5;  // 4 pi in a closed mesh
    if (!inside && nearest >= cells * grid.cell) out.push_back({p, glm::normalize(glm::dvec3(nx, ny, nz))});
  }
  return out;
}

reference::Errors relativeErrors(const std::vector<glm::dvec3>& got, const std::vector<glm::dvec3>& want) {
  EXPECT_EQ(got.size(), want.size());
  return got.size() == want.size() ? reference::errors(got, want) : reference::Errors{1e9, 1e9, 1e9};
}

}  // namespace lpv::test
