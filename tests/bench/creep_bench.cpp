// How evenly light changes while a lamp creeps past an edge: 100 steps of a hundredth of a cell. At receivers on the
// floor below, the second difference of (ours - truth) over three steps, relative to what the receiver would get with
// nothing in the way: a jump of a share s shows as s. Receivers with less than 5 % of the largest unoccluded irradiance
// are left out. Truth is exact: the plate is so long that what a receiver sees of the lamp is a rectangle.
//   creep_bench [--grid N] [--steps N] [--rows FILE]

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "bench/rows.h"
#include "core_scene.h"
#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "scene/lookup.h"

namespace {

using namespace lpv;

constexpr double kHalfFloor = 2.0, kPlate = 1.0, kLamp = 2.0, kHalfLamp = 0.3;  ///< metres; heights above the floor
constexpr double kFar = 50.0;  ///< end of the plate, metres
constexpr int kPixels = 128;
constexpr double kLeast = 0.05;  ///< of the largest unoccluded irradiance: receivers with less are left out

/// A horizontal rectangle that faces down, or up.
MeshPtr rectangle(const glm::dvec2& low, const glm::dvec2& high, bool down) {
  Mesh mesh;
  mesh.positions = {{low.x, 0, low.y}, {high.x, 0, low.y}, {high.x, 0, high.y}, {low.x, 0, high.y}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  if (!down) mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  if (!finishMesh(mesh).ok()) std::exit(1);
  return std::make_shared<const Mesh>(std::move(mesh));
}

void put(Scene& scene, const std::string& name, const MeshPtr& mesh, double height) {
  auto surface = std::make_shared<Surface>();
  surface->name = name;
  surface->mesh = mesh;
  surface->transform.translation.y = height;
  scene.surfaces[name] = surface;
}

/// A lamp above the edge, at x = 0, of a plate that covers everything with x < 0.
Scene edgeScene(int cells) {
  Scene scene;
  scene.options.transport = Transport::kGather;
  scene.options.followTransport();
  scene.options.visibility = Visibility::kAuto;
  scene.options.grid.longest = cells;
  const Bounds bounds{{-kHalfFloor, 0.0, -kHalfFloor}, {kHalfFloor, kLamp + 0.5, kHalfFloor}};
  const Expected<Grid> grid = makeGrid(scene.options.grid, bounds);
  if (!grid) std::exit(1);
  scene.grid = *grid;
  put(scene, "floor", rectangle(glm::dvec2(-kHalfFloor), glm::dvec2(kHalfFloor), false), 0.0);
  put(scene, "plate", rectangle({-kFar, -kFar}, {0.0, kFar}, true), kPlate);
  auto lamp = std::make_shared<Light>();
  lamp->name = "lamp";
  lamp->mesh = rectangle(glm::dvec2(-kHalfLamp), glm::dvec2(kHalfLamp), true);
  lamp->radiance = glm::dvec3(1.0);
  lamp->transform.translation.y = kLamp;
  scene.lights["lamp"] = lamp;
  return scene;
}

/// Irradiance at p, on the floor, of the lamp's part with x from `left`, when its middle is at `x`.
double irradiance(const glm::dvec3& p, double x, double left) {
  const double low = std::max(x - kHalfLamp, left);
  const double high = x + kHalfLamp;
  if (low >= high) return 0.0;
  const glm::dvec3 corners[] = {
      {low, kLamp, -kHalfLamp}, {high, kLamp, -kHalfLamp}, {high, kLamp, kHalfLamp}, {low, kLamp, kHalfLamp}};
  double sum = 0.0;
  for (const auto& [b, c] : {std::pair{1, 2}, std::pair{2, 3}}) {
    sum += reference::triangleIrradiance({corners[0], corners[b], corners[c]}, p, {0.0, 1.0, 0.0});
  }
  return sum;
}

double open(const glm::dvec3& p, double x) { return irradiance(p, x, -kFar); }
/// A point of the lamp is seen where the line to it passes the plate's height at x > 0.
double truth(const glm::dvec3& p, double x) { return irradiance(p, x, p.x * (1.0 - kLamp / kPlate)); }

Camera belowThePlate() {
  Camera camera;
  camera.eye = {0.0, 0.9 * kPlate, 0.0};
  camera.target = {0.0, 0.0, 0.0};
  camera.up = {0.0, 0.0, 1.0};
  camera.fovDegrees = 110.0;
  return camera;
}

std::vector<glm::dvec3> floorPoints() {
  const Camera camera = belowThePlate();
  std::vector<glm::dvec3> out;
  for (int y = 0; y < kPixels; ++y) {
    for (int x = 0; x < kPixels; ++x) {
      const glm::dvec3 ray = camera.rayDirection((x + 0.5) / kPixels, (y + 0.5) / kPixels, 1.0);
      out.push_back(camera.eye - ray * (camera.eye.y / ray.y));
    }
  }
  return out;
}

/// Errors of one way to ask, step by step.
class Course {
 public:
  explicit Course(const char* name) : name_(name) {}
  /// Irradiance at every point, and where the lamp is.
  void add(const std::vector<double>& ours, const std::vector<glm::dvec3>& points, double x) {
    std::vector<double> error(points.size());
    double most = 0.0;
    for (const glm::dvec3& p : points) most = std::max(most, open(p, x));
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double whole = open(points[i], x);
      error[i] = ours[i] - truth(points[i], x);
      if (errors_.size() < 2 || whole < kLeast * most) continue;
      const double second = error[i] - 2.0 * errors_.back()[i] + errors_[errors_.size() - 2][i];
      seconds_.push_back(std::abs(second) / whole);
      squares_ += error[i] * error[i];
      wholes_ += whole * whole;
    }
    errors_.push_back(std::move(error));
  }
  /// Shares of the unoccluded irradiance.
  bench::Row row(int cells) {
    std::sort(seconds_.begin(), seconds_.end());
    double sum = 0.0;
    for (const double s : seconds_) sum += s * s;
    const auto percentile = [&](double share) { return seconds_[std::size_t(share * double(seconds_.size() - 1))]; };
    return {name_,
            "creeping light",
            {{"grid", double(cells)}},
            {{"second_difference_rms_error", std::sqrt(sum / double(seconds_.size()))},
             {"second_difference_p95_error", percentile(0.95)},
             {"second_difference_p99_error", percentile(0.99)},
             {"second_difference_worst", percentile(1.0)},
             {"raw_l2", std::sqrt(squares_ / wholes_)}}};
  }

 private:
  const char* name_;
  std::vector<std::vector<double>> errors_;
  std::vector<double> seconds_;
  double squares_ = 0.0;
  double wholes_ = 0.0;
};

std::vector<double> redOf(const Frame& frame) {
  std::vector<double> out(frame.rgb32f.size() / 3);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = frame.rgb32f[3 * i];
  return out;
}

TickRequest requestAt(const Scene& scene, double x) {
  TickRequest request;
  request.session = 1;
  request.scene = bench::movedTo(scene, {x, kLamp, 0.0});
  request.transported = request.probed = true;
  FrameRequest frame;
  frame.camera = belowThePlate();
  frame.size = glm::ivec2(kPixels);
  frame.format = PixelFormat::kRgb32F;
  frame.quantity = FrameQuantity::kIrradiance;
  request.frames = {frame, frame};
  request.frames[1].view = 1;
  request.frames[1].reduced = true;
  return request;
}

}  // namespace

int main(int argc, char** argv) {
  int cells = 32;
  int steps = 100;
  std::string rowsFile;
  CLI::App app("Second differences of the error while a lamp creeps past an edge");
  app.add_option("--grid", cells, "along the longest edge")->check(CLI::Range(8, 128))->capture_default_str();
  app.add_option("--steps", steps, "of a hundredth of a cell")->check(CLI::Range(3, 10000))->capture_default_str();
  app.add_option("--rows", rowsFile, bench::kRowsHelp);
  CLI11_PARSE(app, argc, argv);
  const Scene scene = edgeScene(cells);
  const std::vector<glm::dvec3> points = floorPoints();
  Course volume("volume");
  Course probes("probes");
  Course frames("single frames");
  Course streams("frames of a stream");
  for (int step = 0; step < steps; ++step) {
    const double x = (step - 0.5 * steps) * 0.01 * scene.grid.cell;
    const TickResult result = bench::tick(requestAt(scene, x));
    std::vector<double> looked;
    std::vector<double> probed;
    for (const glm::dvec3& p : points) {
      looked.push_back(irradianceAt(*result.transported, Lookup::kCap, p, {0.0, 1.0, 0.0}).rgb.x);
      probed.push_back(irradianceWithNearField(*result.transported, Lookup::kCap, p, {0.0, 1.0, 0.0}).rgb.x);
    }
    volume.add(looked, points, x);
    probes.add(probed, points, x);
    frames.add(redOf(*result.frames[0]), points, x);
    streams.add(redOf(*result.frames[1]), points, x);
  }
  bench::Rows rows(rowsFile, bench::engine().device().name);
  for (Course* course : {&volume, &probes, &frames, &streams}) rows.add(course->row(cells));
  return 0;
}
