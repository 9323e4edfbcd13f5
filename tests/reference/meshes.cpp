#include "reference/meshes.h"

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <utility>

namespace lpv::reference {
namespace {

constexpr double kPi = std::numbers::pi;

MeshPtr finished(Mesh mesh) {
  const Status status = finishMesh(mesh);
  if (!status.ok()) throw std::logic_error("procedural mesh refused: " + status.message());
  return std::make_shared<const Mesh>(std::move(mesh));
}

/// Adds two triangles for the quadrilateral a, b, c, d, counter-clockwise from the front.
void addQuad(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  mesh.triangles.emplace_back(a, b, c);
  mesh.triangles.emplace_back(a, c, d);
}

/// A latitude-longitude ball about y whose radius depends on the direction.
template <typename Radius>
Mesh ball(int slices, int stacks, Radius radius) {
  Mesh mesh;
  const auto put = [&](const glm::dvec3& w) { mesh.positions.emplace_back(w * radius(w)); };
  put({0, 1, 0});
  for (int i = 1; i < stacks; ++i) {
    const double polar = kPi * i / stacks;
    for (int j = 0; j < slices; ++j) {
      const double azimuth = 2.0 * kPi * j / slices;
      put({std::sin(polar) * std::sin(azimuth), std::cos(polar), std::sin(polar) * std::cos(azimuth)});
    }
  }
  put({0, -1, 0});
  const auto ring = [&](int i, int j) { return std::uint32_t(1 + (i - 1) * slices + j % slices); };
  const auto last = std::uint32_t(mesh.positions.size() - 1);
  for (int j = 0; j < slices; ++j) {
    mesh.triangles.emplace_back(0, ring(1, j), ring(1, j + 1));
    for (int i = 1; i + 1 < stacks; ++i) addQuad(mesh, ring(i, j), ring(i + 1, j), ring(i + 1, j + 1), ring(i, j + 1));
    mesh.triangles.emplace_back(last, ring(stacks - 1, j + 1), ring(stacks - 1, j));
  }
  return mesh;
}

/// FairQueue one triangle into three by a vertex at its centroid: the surface stays where it is.
void split(Mesh& mesh, std::size_t triangle) {
  const glm::uvec3 t = mesh.triangles[triangle];
  const auto middle = std::uint32_t(mesh.positions.size());
  mesh.positions.push_back((mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0F);
  mesh.triangles[triangle] = {t.x, t.y, middle};
  mesh.triangles.emplace_back(t.y, t.z, middle);
  mesh.triangles.emplace_back(t.z, t.x, middle);
}

glm::dvec3 randomDirection(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

}  // namespace

MeshPtr quad() { return quadOf(1); }

MeshPtr quadOf(int n) {
  Mesh mesh;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const glm::dvec2 uv(double(i) / n, double(j) / n);
      mesh.positions.emplace_back(uv.x - 0.5, 0.5 - uv.y, 0.0);
      mesh.uvs.emplace_back(uv);
    }
  }
  const auto at = [n](int i, int j) { return std::uint32_t(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) addQuad(mesh, at(i, j + 1), at(i + 1, j + 1), at(i + 1, j), at(i, j));
  }
  return finished(std::move(mesh));
}

MeshPtr pyramid() {
  Mesh mesh;
  mesh.positions = {
      {-0.5F, -0.5F, 0.5F}, {0.5F, -0.5F, 0.5F}, {0.5F, -0.5F, -0.5F}, {-0.5F, -0.5F, -0.5F}, {0.0F, 0.5F, 0.0F}};
  addQuad(mesh, 3, 2, 1, 0);
  for (std::uint32_t k = 0; k < 4; ++k) mesh.triangles.emplace_back(k, (k + 1) % 4, 4);
  return finished(std::move(mesh));
}

MeshPtr tube() {
  constexpr int kSides = 6;
  Mesh mesh;
  for (int j = 0; j < kSides; ++j) {
    const double angle = 2.0 * kPi * j / kSides;
    const glm::dvec3 outward(0.0, std::cos(angle), std::sin(angle));
    for (const double x : {-1.0, 1.0}) {
      mesh.positions.emplace_back(glm::dvec3(x, 0, 0) + 0.1 * outward);
      mesh.normals.emplace_back(outward);
    }
  }
  for (std::uint32_t j = 0; j < kSides; ++j) {
    const std::uint32_t next = (j + 1) % kSides;
    addQuad(mesh, 2 * j, 2 * next, 2 * next + 1, 2 * j + 1);
  }
  return finished(std::move(mesh));
}

MeshPtr sphere() { return sphereOf(24, 16); }

MeshPtr sphereOf(int slices, int stacks, bool normals) {
  Mesh mesh = ball(slices, stacks, [](const glm::dvec3&) { return 0.5; });
  if (normals) {
    for (const glm::vec3& p : mesh.positions) mesh.normals.push_back(glm::normalize(p));
  }
  return finished(std::move(mesh));
}

MeshPtr bumpySphere(std::size_t n) {
  if (n < 100 || n % 2 != 0) throw std::invalid_argument("bumpySphere: n is even and at least 100");
  const int stacks = int(std::sqrt(double(n) / 4.0));
  const int slices = int(n / 2) / (stacks - 1);
  Mesh mesh = ball(slices, stacks, [](const glm::dvec3& w) {
    return 0.5 + 0.05 * (std::sin(9.0 * w.x) * std::cos(7.0 * w.y) + std::sin(11.0 * w.z));
  });
  for (std::size_t next = 0; mesh.triangles.size() < n; ++next) split(mesh, next);
  return finished(std::move(mesh));
}

MeshPtr slivers(int n, double width, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-0.1, 0.1);
  Mesh mesh;
  for (int i = 0; i < n; ++i) {
    const glm::dvec3 centre(place(random), place(random), place(random));
    const glm::dvec3 along = randomDirection(random);
    const glm::dvec3 across = glm::normalize(glm::cross(along, randomDirection(random)));
    const auto first = std::uint32_t(mesh.positions.size());
    mesh.positions.emplace_back(centre - 0.5 * along);
    mesh.positions.emplace_back(centre + 0.5 * along);
    mesh.positions.emplace_back(centre + 0.5 * along + width * across);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  return finished(std::move(mesh));
}

MeshPtr box(const glm::dvec3& min, const glm::dvec3& max, bool inward) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const auto first = std::uint32_t(mesh.positions.size());
      for (const glm::ivec2 corner : {glm::ivec2(0, 0), glm::ivec2(1, 0), glm::ivec2(1, 1), glm::ivec2(0, 1)}) {
        glm::dvec3 p(0.0);
        p[axis] = side ? max[axis] : min[axis];
        p[(axis + 1) % 3] = corner.x ? max[(axis + 1) % 3] : min[(axis + 1) % 3];
        p[(axis + 2) % 3] = corner.y ? max[(axis + 2) % 3] : min[(axis + 2) % 3];
        mesh.positions.emplace_back(p);
      }
      if ((side == 1) != inward) {
        addQuad(mesh, first, first + 1, first + 2, first + 3);
      } else {
        addQuad(mesh, first, first + 3, first + 2, first + 1);
      }
    }
  }
  return finished(std::move(mesh));
}

}  // namespace lpv::reference
