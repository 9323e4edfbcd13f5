// reference_renderer: path-traced references of the scene files that `lpvctl scene load` takes.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <glm/glm.hpp>
#include <glm/gtx/component_wise.hpp>
#include <iostream>
#include <optional>
#include <sstream>
#include <thread>

#include "import/image.h"
#include "import/scene_file.h"
#include "renderer/closed_form.h"
#include "renderer/dump.h"
#include "renderer/parallel.h"
#include "renderer/picture.h"
#include "scene/default_view.h"
#include "scene/distant_lights.h"
#include "values.h"

namespace lpv::evaluation {
namespace {

/// All of the command line.
struct Options {
  std::string file;
  cli::ImportOptions import;
  std::string sky;
  std::string camera;
  std::optional<glm::dvec3> eye, target, up;
  double fov = 50.0;
  std::optional<glm::ivec2> size;
  std::vector<std::string> bounces{"0"};
  PixelFilter filter = PixelFilter::kCentre;
  bool gloss = false;
  Sampling sampling;
  std::string output;
  std::string points;
  std::string dump;
};

void addTo(CLI::App& app, Options& o) {
  app.add_option("file", o.file, "Scene file: glb, gltf, obj, ply or stl")->required()->type_name("FILE");
  app.add_option("--scale", o.import.scale, "Metres per unit of the file (default: 1)")->type_name("S");
  app.add_option("--sky", o.sky, "Equirectangular picture of the sky that lights the scene, too (default: none)")
      ->type_name("IMG");
  app.add_option("--camera", o.camera, "Camera of the file (default: the view that the server would choose)")
      ->type_name("NAME");
  cli::addVec3(app, "--eye", o.eye, "Position of the camera, metres");
  cli::addVec3(app, "--target", o.target, "Point the camera looks at, metres");
  cli::addVec3(app, "--up-vector", o.up, "Up direction (default: 0,1,0)");
  app.add_option("--fov", o.fov, "Vertical field of view, degrees (default: 50)")->type_name("DEGREES");
  cli::addParsed<glm::ivec2>(app, "--size", o.size, "WxH", cli::parseSize, "Size, pixels (default: 320x180)");
  app.add_option("--bounces", o.bounces,
                 "Numbers of bounces, separated by commas; 0: direct light only; all (default: 0)")
      ->delimiter(',')
      ->type_name("N|all");
  app.add_option_function<std::string>(
         "--filter",
         [&o](const std::string& name) { o.filter = name == "box" ? PixelFilter::kBox : PixelFilter::kCentre; },
         "centre: the ray through a pixel's centre, as the server renders (default); box: the mean over the pixel")
      ->check(CLI::IsMember({"centre", "box"}));
  app.add_flag("--gloss", o.gloss, "Surfaces that the camera sees have GGX lobes where they are metal or smooth");
  app.add_option("--samples", o.sampling.samples, "Paths per pixel or point (default: 256)")
      ->check(CLI::Range(8, 1 << 24));
  app.add_option("--seed", o.sampling.seed, "Of the random numbers (default: 1)");
  app.add_option("--threads", o.sampling.threads, "Threads (default: one per core)")->check(CLI::Range(1, 1024));
  app.add_option("-o,--output", o.output, "Writes OUTPUT-bounces-N.exr for every number of bounces")
      ->type_name("OUTPUT");
  app.add_option("--points", o.points, "File of points, one line x,y,z,nx,ny,nz each: prints their irradiance instead")
      ->type_name("FILE.csv");
  app.add_option("--dump", o.dump, "Writes the scene as it was read to this folder, for other renderers, and ends")
      ->type_name("DIR");
}

std::optional<std::vector<int>> levelsOf(const std::vector<std::string>& words) {
  std::vector<int> levels;
  for (const std::string& word : words) {
    const auto number = cli::parseNumbers(word, {1});
    if (word != "all" && (!number || (*number)[0] < 0.0 || (*number)[0] > 1000.0)) return {};
    levels.push_back(word == "all" ? kAllBounces : int((*number)[0]));
  }
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  return levels;
}

std::string levelName(int level) { return level == kAllBounces ? "all" : std::to_string(level); }

constexpr double kSkyDistance = 2000.0;  ///< of the content's longest edge

/// The sky as one sphere around the content.
Expected<LightPtr> skyAround(const Scene& scene, const std::string& picture) {
  Expected<Texture> read = cli::readImage(picture);
  if (!read) return read.status();
  Mesh mesh = skyMesh();
  if (Status status = finishMesh(mesh); !status.ok()) return status;
  const Bounds content = contentBounds(scene);
  auto sky = std::make_shared<Light>();
  sky->name = "sky";
  sky->mesh = std::make_shared<const Mesh>(std::move(mesh));
  sky->texture = std::make_shared<const Texture>(std::move(*read));
  sky->distant = true;
  sky->transform.translation = content.centre();
  sky->transform.scale = glm::dvec3(kSkyDistance * glm::compMax(content.extent()));
  return LightPtr(sky);
}

/// Objects under names that keep the file's order.
Scene sceneOf(const cli::ImportedScene& imported) {
  Scene scene;
  int number = 100000000;
  for (const Light& light : imported.lights)
    scene.lights[std::to_string(number++)] = std::make_shared<const Light>(light);
  for (const Surface& s : imported.surfaces)
    scene.surfaces[std::to_string(number++)] = std::make_shared<const Surface>(s);
  return scene;
}

Expected<Camera> cameraOf(const Options& o, const cli::ImportedScene& imported, const Scene& scene,
                          const glm::ivec2& size) {
  if (!o.camera.empty()) {
    for (const auto& [name, camera] : imported.cameras) {
      if (name == o.camera) return camera;
    }
    return Status(Code::kNotFound, "the file has no camera named " + o.camera, "camera");
  }
  if (!o.eye || !o.target) return DefaultView(scene).camera(double(size.x) / size.y);
  Camera camera;
  camera.eye = *o.eye;
  camera.target = *o.target;
  if (o.up) camera.up = *o.up;
  camera.fovDegrees = o.fov;
  if (Status status = checkCamera(camera); !status.ok()) return status;
  return camera;
}

std::string text(const glm::dvec3& v) {
  std::ostringstream out;
  out.precision(17);
  out << v.x << "," << v.y << "," << v.z;
  return out.str();
}

/// What was rendered, for programs to read.
void printJson(const Camera& camera, const glm::ivec2& size, const TracedScene& scene) {
  std::size_t lights = 0;
  std::size_t triangles = 0;
  for (const TracedObject& object : scene.objects()) {
    lights += object.emits ? 1 : 0;
    triangles += object.triangles.size();
  }
  std::cout.precision(17);
  std::cout << "{\"eye\":[" << text(camera.eye) << "],\"target\":[" << text(camera.target) << "],\"up\":["
            << text(camera.up) << "],\"fov\":" << camera.fovDegrees << ",\"size\":[" << size.x << "," << size.y
            << "],\"lights\":" << lights << ",\"objects\":" << scene.objects().size() << ",\"triangles\":" << triangles
            << "}\n";
}

Expected<std::vector<Receiver>> readPoints(const std::string& path) {
  std::ifstream file(path);
  std::vector<Receiver> points;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    const auto n = cli::parseNumbers(line, {6});
    if (!n) return invalid("points", path + ": a line must be six numbers x,y,z,nx,ny,nz, not: " + line);
    const glm::dvec3 normal = glm::normalize(glm::dvec3((*n)[3], (*n)[4], (*n)[5]));
    points.push_back({{(*n)[0], (*n)[1], (*n)[2]}, normal, normal});
  }
  if (points.empty()) return invalid("points", path + ": the file has no points");
  return points;
}

/// A line per point: x,y,z,nx,ny,nz, the unoccluded direct irradiance, then per level irradiance and standard error.
Status measurePoints(const Options& o, const PathTracer& tracer, const ClosedForm* exact) {
  const auto points = readPoints(o.points);
  if (!points) return points.status();
  std::vector<IrradianceEstimate> answers(points->size());
  parallelFor(int(points->size()), o.sampling.threads, [&](int i) {
    answers[std::size_t(i)] =
        estimateIrradiance(tracer, (*points)[std::size_t(i)], o.sampling, std::uint32_t(i), exact);
  });
  std::cout << "x,y,z,nx,ny,nz,unoccluded_r,unoccluded_g,unoccluded_b,unoccluded_se_r,unoccluded_se_g,unoccluded_se_b";
  for (const int level : tracer.levels()) {
    for (const char* colour : {"r", "g", "b"}) std::cout << ",e" << levelName(level) << "_" << colour;
    for (const char* colour : {"r", "g", "b"}) std::cout << ",se" << levelName(level) << "_" << colour;
  }
  std::cout << "\n";
  for (std::size_t i = 0; i < answers.size(); ++i) {
    std::cout << text((*points)[i].position) << "," << text((*points)[i].normal) << "," << text(answers[i].unoccluded)
              << "," << text(answers[i].unoccludedError);
    for (std::size_t level = 0; level < answers[i].mean.size(); ++level) {
      std::cout << "," << text(answers[i].mean[level]) << "," << text(answers[i].error[level]);
    }
    std::cout << "\n";
  }
  return {};
}

Status writePictures(const Options& o, const Picture& picture) {
  for (std::size_t level = 0; level < picture.levels.size(); ++level) {
    const std::string path = o.output + "-bounces-" + levelName(picture.levels[level]) + ".exr";
    if (Status status = writeExr(path, picture, level); !status.ok()) return status;
  }
  return {};
}

Status run(Options& o) {
  const auto levels = levelsOf(o.bounces);
  if (!levels) return invalid("bounces", "--bounces takes numbers from 0 to 1000, and all");
  const Expected<cli::ImportedScene> imported = cli::importScene(o.file, o.import);
  if (!imported) return imported.status();
  for (const std::string& warning : imported->warnings) std::cerr << "reference_renderer: " << warning << "\n";
  Scene scene = sceneOf(*imported);
  if (!o.sky.empty()) {
    const Expected<LightPtr> sky = skyAround(scene, o.sky);
    if (!sky) return sky.status();
    scene.lights["sky"] = *sky;
  }
  const TracedScene traced(scene);
  if (!o.dump.empty()) return dumpScene(traced, o.dump);
  const PathTracer tracer(traced, *levels);
  const ClosedForm closedForm(traced);
  const ClosedForm* exact = closedForm.available() ? &closedForm : nullptr;
  if (!o.points.empty()) return measurePoints(o, tracer, exact);
  const glm::ivec2 size = o.size.value_or(glm::ivec2(320, 180));
  const Expected<Camera> camera = cameraOf(o, *imported, scene, size);
  if (!camera) return camera.status();
  printJson(*camera, size, traced);
  if (o.output.empty()) return {};
  return writePictures(o, renderPicture(traced, tracer, *camera, size, o.filter, o.sampling, exact, o.gloss));
}

}  // namespace
}  // namespace lpv::evaluation

int main(int argc, char** argv) {
  CLI::App app(
      "reference_renderer: path-traced references of the scene files that lpvctl loads. Prints the camera and the size "
      "as JSON; without --output and --points that is all it does.");
  lpv::evaluation::Options options;
  options.sampling.threads = int(std::max(1U, std::thread::hardware_concurrency()));
  lpv::evaluation::addTo(app, options);
  CLI11_PARSE(app, argc, argv);
  const lpv::Status status = lpv::evaluation::run(options);
  if (!status.ok()) std::cerr << "reference_renderer: " << status.message() << "\n";
  return status.ok() ? 0 : 1;
}
