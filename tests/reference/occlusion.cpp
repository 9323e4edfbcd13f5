#include "reference/occlusion.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <stdexcept>

namespace lpv::reference {
namespace {

glm::dvec3 transformed(const glm::dmat4& m, const glm::dvec3& p) { return glm::dvec3(m * glm::dvec4(p, 1.0)); }

glm::dvec3 asFloats(const glm::dvec3& p) { return glm::dvec3(glm::vec3(p)); }

/// By how much the segment passes inside of the triangle and of its own ends, the least of all; negative outside.
double insideBy(const glm::dvec3 (&c)[3], const Segment& s) {
  const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]), direction = s.to - s.from;
  const double slope = glm::dot(normal, direction), size2 = glm::dot(normal, normal);
  if (size2 == 0.0) return -1.0;
  if (slope == 0.0) return glm::dot(normal, c[0] - s.from) == 0.0 ? 0.0 : -1.0;
  const double at = glm::dot(normal, c[0] - s.from) / slope;
  const glm::dvec3 p = s.from + at * direction;
  double least = std::min(at, 1.0 - at);
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 &a = c[(i + 1) % 3], &b = c[(i + 2) % 3];
    least = std::min(least, glm::dot(glm::cross(b - a, p - a), normal) / size2);
  }
  return least;
}

}  // namespace

Occlusion::Occlusion(const std::vector<Occluder>& occluders, const glm::dmat4& spaceFromWorld) {
  for (const Occluder& o : occluders) {
    const glm::dmat4 m = spaceFromWorld * o.worldFromObject;
    for (const glm::uvec3& t : o.mesh->triangles) {
      Triangle triangle = {.corners = {}, .blocks = o.blocks};
      for (int i = 0; i < 3; ++i) triangle.corners[i] = transformed(m, glm::dvec3(o.mesh->positions[t[i]]));
      triangles_.push_back(triangle);
    }
  }
}

Meeting Occlusion::meeting(const Segment& segment, int light, double margin) const {
  Meeting out = Meeting::kNone;
  for (const Triangle& t : triangles_) {
    if (t.blocks != kAllLights && light != kFromSurfaces && t.blocks != light) continue;
    const double inside = insideBy(t.corners, segment);
    if (inside > margin) return Meeting::kSome;
    if (inside >= -margin) out = Meeting::kUnclear;
  }
  return out;
}

std::vector<Segment> randomSegments(std::size_t count, const glm::dvec3& lower, const glm::dvec3& upper,
                                    std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const auto point = [&] {
    const double x = share(random), y = share(random);
    return asFloats(glm::mix(lower, upper, glm::dvec3(x, y, share(random))));
  };
  std::vector<Segment> out(count);
  for (Segment& s : out) {
    s.from = point();
    s.to = point();
  }
  return out;
}

std::vector<Segment> segmentsThroughEdges(const Occluder& occluder, const glm::dvec3& from, std::size_t count,
                                          const glm::dmat4& spaceFromWorld) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const Mesh& mesh = *occluder.mesh;
  std::uniform_int_distribution<std::size_t> any(0, mesh.triangles.size() - 1);
  const glm::dmat4 m = spaceFromWorld * occluder.worldFromObject;
  std::vector<Segment> out;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::uvec3& t = mesh.triangles[any(random)];
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]);
    const double along = i % 3 == 0 ? 0.0 : i % 3 == 1 ? 0.5 : share(random);
    const glm::dvec3 through = transformed(m, glm::mix(a, b, along));
    out.push_back({asFloats(from), asFloats(2.0 * through - from)});
  }
  return out;
}

glm::dmat4 turn(double angle) { return glm::rotate(glm::dmat4(1.0), angle, glm::normalize(glm::dvec3(1, 2, 3))); }

MeshPtr turned(const MeshPtr& mesh, double angle) {
  Mesh out = *mesh;
  out.normals.clear();
  for (glm::vec3& p : out.positions) p = glm::vec3(transformed(turn(angle), glm::dvec3(p)));
  if (const Status s = finishMesh(out); !s.ok()) throw std::logic_error(s.message());
  return std::make_shared<Mesh>(std::move(out));
}

}  // namespace lpv::reference
