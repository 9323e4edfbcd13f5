#include "shadow_rays.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <map>
#include <random>

#include "gpu/gl.h"
#include "reference/room.h"
#include "shaders/layout.h"

namespace lpv::bench {

namespace {

constexpr std::size_t kRaysOfCell = 32;
constexpr std::uint32_t kGroup = 128;

struct Start {
  glm::vec3 position, normal;
};

/// Points of all triangles in proportion to area, kShadowOffset above them, cell by cell.
std::vector<Start> starts(const Scene& scene, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::map<std::size_t, std::vector<Start>> byCell;
  for (const auto& [name, surface] : scene.surfaces) {
    const glm::dmat4 m = scene.grid.gridFromWorldMatrix() * surface->transform.worldFromObject();
    for (const glm::uvec3& t : surface->mesh->triangles) {
      glm::dvec3 c[3];
      for (int i = 0; i < 3; ++i) c[i] = glm::dvec3(m * glm::dvec4(glm::dvec3(surface->mesh->positions[t[i]]), 1.0));
      const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
      const double points = 20.0 * glm::length(normal) + share(random);
      for (int i = 0; i < int(points); ++i) {
        const double u = std::sqrt(share(random)), v = share(random);
        const glm::dvec3 unit = glm::normalize(normal);
        const glm::dvec3 p =
            c[0] * (1.0 - u) + c[1] * (u * (1.0 - v)) + c[2] * (u * v) + double(layout::kShadowOffset) * unit;
        byCell[scene.grid.index(glm::clamp(glm::ivec3(p), glm::ivec3(0), scene.grid.dims - 1))].push_back({p, unit});
      }
    }
  }
  std::vector<const std::vector<Start>*> cells;
  for (const auto& [cell, points] : byCell) cells.push_back(&points);
  std::vector<Start> out;
  const std::size_t wanted = kRays / kRaysOfCell;
  for (std::size_t k = 0; k < wanted; ++k) {
    const std::vector<Start>& points = *cells[k * cells.size() / wanted];
    for (std::size_t i = 0; i < kRaysOfCell; ++i) out.push_back(points[i % points.size()]);
  }
  return out;
}

}  // namespace

gpu::Context& deviceContext() {
  static gpu::Context context = [] {
    for (const gpu::Device& device : gpu::preferredOrder(gpu::listDevices())) {
      Expected<gpu::Context> made = gpu::Context::make(device, false);
      if (made.ok()) return std::move(*made);
    }
    std::cerr << "no device\n";
    std::exit(1);
  }();
  return context;
}

Scene roomAround(const MeshPtr& mesh, int cells) {
  Scene scene = reference::smallRoom(cells);
  scene.surfaces.erase("tall");
  auto surface = std::make_shared<Surface>(*scene.surfaces.at("short"));
  const double size = 1.6 / std::max({mesh->bounds.extent().x, mesh->bounds.extent().y, mesh->bounds.extent().z});
  surface->mesh = mesh;
  surface->transform.scale = glm::dvec3(size);
  surface->transform.translation = -size * (surface->transform.rotation * mesh->bounds.centre());
  scene.surfaces["short"] = surface;
  return scene;
}

std::vector<ShadowRay> shadowRays(const Scene& scene, bool toLamp) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  const glm::dmat4 lamp = scene.grid.gridFromWorldMatrix() * scene.lights.at("lamp")->transform.worldFromObject();
  const glm::vec3 lampNormal(glm::normalize(glm::cross(glm::dvec3(lamp[0]), glm::dvec3(lamp[1]))));
  std::vector<ShadowRay> out;
  for (const Start& start : starts(scene, random)) {
    const double x = share(random), y = share(random);
    const glm::vec3 target(lamp * glm::dvec4(x, y, 0.0, 1.0));
    const float dx = normal(random), dy = normal(random);
    const glm::vec3 anywhere = start.position + 2.0F * glm::normalize(glm::vec3(dx, dy, normal(random)));
    out.push_back({start.position, toLamp ? target : anywhere, start.normal, toLamp ? lampNormal : glm::vec3(0.0F)});
  }
  return out;
}

RayProgram::RayProgram(const std::string& name, const std::string& head, const gpu::Defines& defines)
    : program_(gpu::Program::computeOfText(
          name,
          "#include \"layout.h\"\n" + head + "layout(local_size_x = " + std::to_string(kGroup) +
              ") in;\n"
              "layout(std430, binding = kTestIn) readonly buffer In { vec4 rays[]; };\n"
              "layout(std430, binding = kTestOut) writeonly buffer Out { vec2 answers[]; };\n"
              "void main() {\n  const uint i = gl_GlobalInvocationID.x;\n"
              "  if (i < uint(answers.length())) answers[i] = answer(rays[2u * i].xyz, rays[2u * i + 1u].xyz);\n}\n",
          defines)) {}

void RayProgram::dispatch(const gpu::Buffer& rays, const gpu::Buffer& answers) {
  rays.bindStorage(layout::kTestIn);
  answers.bindStorage(layout::kTestOut);
  program_.dispatch(std::uint32_t((answers.size() / sizeof(glm::vec2) + kGroup - 1) / kGroup));
  glFinish();
}

RayProgram trianglesProgram() {
  return {"triangles",
          "#define LPV_TRANSPARENT 0\n#include \"visibility/occluders.glsl\"\n"
          "vec2 answer(vec3 from, vec3 to) {\n  int rounds = 0;\n"
          "  const float seen = transmitted(from, to, 0, rounds).x;\n  return vec2(seen, float(rounds));\n}\n"};
}

gpu::Buffer rayBuffer(std::span<const ShadowRay> rays) {
  std::vector<glm::vec4> out;
  for (const ShadowRay& ray : rays) {
    out.emplace_back(ray.from, 0.0F);
    out.emplace_back(ray.to, 0.0F);
  }
  return {"rays", gpu::bytesOf(std::span<const glm::vec4>(out))};
}

gpu::Buffer answerBuffer(std::size_t rays) { return {"answers", rays * sizeof(glm::vec2)}; }

std::vector<glm::vec2> answersOf(const gpu::Buffer& answers) {
  gpu::memoryBarrier();
  std::vector<glm::vec2> out(answers.size() / sizeof(glm::vec2));
  glGetNamedBufferSubData(answers.id(), 0, GLsizeiptr(answers.size()), out.data());
  return out;
}

}  // namespace lpv::bench
