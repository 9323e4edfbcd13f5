#include "reference/direct_texels.h"

#include <algorithm>
#include <initializer_list>
#include <random>

#include "reference/ground_truth.h"

namespace lpv::reference {
namespace {

using Random = std::mt19937;

/// Numbers that floats hold: what is compared must not differ by rounding.
double uniform(Random& random, double low, double high) {
  return double(float(std::uniform_real_distribution<double>(low, high)(random)));
}

glm::dvec3 pointIn(Random& random, double low, double high) {
  const double x = uniform(random, low, high), y = uniform(random, low, high);
  return {x, y, uniform(random, low, high)};
}

glm::dmat3 inFloats(const glm::dmat3& m) { return glm::dmat3(glm::mat3(m)); }

Vpl vplOf(const DirectVpl& v) {
  Vpl vpl;
  vpl.area = vpl.weight = v.area;
  vpl.areaNormal = v.areaNormal;
  vpl.weightedPosition = v.area * v.position;
  vpl.weightedSquare = v.area * (v.extent + glm::outerProduct(v.position, v.position));
  return vpl;
}

std::size_t recordsOf(const DirectNode& node) {
  std::size_t records = 1 + node.vpls.size();
  for (const DirectNode& child : node.children) records += recordsOf(child);
  return records;
}

/// Depth first; `at`: the record that comes next.
void addRecords(const DirectNode& node, bool coloured, std::size_t at, std::vector<glm::vec4>& out) {
  const auto add = [&](std::initializer_list<glm::vec4> texels) {
    out.insert(out.end(), texels.begin(), texels.end() - (coloured ? 0 : 1));
  };
  const glm::vec4 none(0.0F);
  add({glm::vec4(node.centre, node.edge),
       {float(node.vpls.size()), float(at + recordsOf(node)), 0, 0},
       none,
       none,
       none});
  for (const DirectVpl& v : node.vpls) {
    const glm::dmat3& e = v.extent;
    add({glm::vec4(v.position, v.area), glm::vec4(v.areaNormal, std::max(spreadOf(vplOf(v)), 1e-6 * v.area)),
         glm::vec4(e[0][0], e[1][1], e[2][2], e[0][0] + e[1][1] + e[2][2]), glm::vec4(e[0][1], e[0][2], e[1][2], 2.0),
         glm::vec4(v.colour, 0.0)});
  }
  at += 1 + node.vpls.size();
  for (const DirectNode& child : node.children) {
    addRecords(child, coloured, at, out);
    at += recordsOf(child);
  }
}

glm::dvec3 ofVpl(const DirectVpl& v, bool twoSided, const glm::dvec3& x, const glm::dvec3& n) {
  const Vpl front = vplOf(v);
  glm::dvec3 flux = momentsOf(front, x, 1.0).vectorIrradiance;
  if (twoSided) {
    Vpl back = front;
    back.areaNormal = -front.areaNormal;
    flux += momentsOf(back, x, 1.0).vectorIrradiance;
  }
  return irradianceOf(flux, front, x, n, 1.0) * v.colour;
}

glm::dvec3 ofNode(const DirectNode& node, bool twoSided, double k, const glm::dvec3& x, const glm::dvec3& n) {
  glm::dvec3 sum(0.0);
  if (node.children.empty() || glm::length(node.centre - x) > k * node.edge) {
    for (const DirectVpl& v : node.vpls) sum += ofVpl(v, twoSided, x, n);
  } else {
    for (const DirectNode& child : node.children) sum += ofNode(child, twoSided, k, x, n);
  }
  return sum;
}

DirectNode randomNode(Random& random, const glm::dvec3& corner, double edge, int levels) {
  DirectNode node;
  node.centre = corner + 0.5 * edge;
  node.edge = edge;
  for (int i = 0; i < 1 + int(random() % 2); ++i) {
    DirectVpl v;
    v.position = corner + edge * glm::floor(pointIn(random, 0.0, 4096.0)) / 4096.0;
    v.areaNormal = edge * edge * pointIn(random, -0.4, 0.4);
    v.area = double(float((1.0 + 0.2 * i) * glm::length(v.areaNormal)));
    v.colour = pointIn(random, 0.1, 1.0);
    const glm::dvec3 a = 0.3 * edge * pointIn(random, -1.0, 1.0), b = 0.2 * edge * pointIn(random, -1.0, 1.0);
    v.extent = inFloats(glm::outerProduct(a, a) + glm::outerProduct(b, b));
    node.vpls.push_back(v);
  }
  for (int child = 0; levels > 1 && child < 8; ++child) {
    if (random() % 3 == 0) continue;
    const glm::dvec3 offset(child & 1, child >> 1 & 1, child >> 2);
    node.children.push_back(randomNode(random, corner + 0.5 * edge * offset, 0.5 * edge, levels - 1));
  }
  return node;
}

}  // namespace

std::vector<glm::vec4> directTexels(const std::vector<DirectLight>& lights, double k) {
  std::vector<glm::vec4> out(1 + 2 * lights.size());
  out[0] = {float(lights.size()), float(k), 0, 0};
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const DirectLight& light = lights[i];
    const bool tree = light.triangles.empty();
    const std::size_t count = tree ? recordsOf(light.root) : light.triangles.size();
    out[1 + 2 * i] = glm::vec4(light.radiance, tree ? 1.0 : 0.0);
    out[2 + 2 * i] = {float(out.size()), float(count), light.twoSided ? 2 : 1, tree ? light.coloured ? 5 : 4 : 0};
    if (tree) addRecords(light.root, light.coloured, 0, out);
    for (const auto& triangle : light.triangles) {
      for (const glm::dvec3& corner : triangle) out.emplace_back(corner, 0.0);
    }
  }
  return out;
}

glm::dvec3 directIrradiance(const std::vector<DirectLight>& lights, double k, const glm::dvec3& x,
                            const glm::dvec3& n) {
  glm::dvec3 sum(0.0);
  for (const DirectLight& light : lights) {
    for (const auto& t : light.triangles) {
      sum += light.radiance * triangleIrradiance(t, x, n);
      if (light.twoSided) sum += light.radiance * triangleIrradiance({t[0], t[2], t[1]}, x, n);
    }
    if (light.triangles.empty()) sum += light.radiance * ofNode(light.root, light.twoSided, k, x, n);
  }
  return sum;
}

DirectLight randomPolygons(int count, bool twoSided, double size, std::uint32_t seed) {
  Random random(seed);
  DirectLight light;
  light.radiance = pointIn(random, 0.2, 3.0);
  light.twoSided = twoSided;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 a = pointIn(random, 0.0, size), b = pointIn(random, 0.0, size);
    light.triangles.push_back({a, b, pointIn(random, 0.0, size)});
  }
  return light;
}

DirectLight randomTree(bool coloured, bool twoSided, double size, std::uint32_t seed) {
  Random random(seed);
  DirectLight light;
  light.radiance = pointIn(random, 0.2, 3.0);
  light.twoSided = twoSided;
  light.coloured = coloured;
  light.root = randomNode(random, glm::dvec3(0.0), size, 3);
  if (coloured) return light;
  const auto white = [](const auto& self, DirectNode& node) -> void {
    for (DirectVpl& v : node.vpls) v.colour = glm::dvec3(1.0);
    for (DirectNode& child : node.children) self(self, child);
  };
  white(white, light.root);
  return light;
}

}  // namespace lpv::reference
