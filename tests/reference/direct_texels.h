#pragma once
// Lights as shaders/transport/emitter_list.glsl describes them, put together by hand, and what they send to a point,
// from the definitions (MATHS.md 3b.3-4, 3c, 5).

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "reference/gather.h"

namespace lpv::reference {

/// Grid space. Directions and areas as in Vpl, colours as shares of the light's brightest texel.
struct DirectVpl {
  glm::dvec3 position{0.0};
  double area = 0.0;
  glm::dvec3 areaNormal{0.0};
  glm::dmat3 extent{0.0};
  glm::dvec3 colour{1.0};
};

/// A leaf has no children.
struct DirectNode {
  glm::dvec3 centre{0.0};
  double edge = 1.0;
  std::vector<DirectVpl> vpls;
  std::vector<DirectNode> children;
};

/// Its triangles, counter-clockwise seen from the front, or else a tree.
struct DirectLight {
  glm::dvec3 radiance{0.0};
  bool twoSided = false;
  std::vector<std::array<glm::dvec3, 3>> triangles;
  DirectNode root;
  bool coloured = false;  ///< records of five texels, not four
};

/// Rounded to floats, as the shader and EmitterList read them.
std::vector<glm::vec4> directTexels(const std::vector<DirectLight>& lights, double k);

/// Irradiance at a grid position; a node whose centre is more than k edges away is taken whole.
glm::dvec3 directIrradiance(const std::vector<DirectLight>& lights, double k, const glm::dvec3& x, const glm::dvec3& n);

/// One light of random triangles, or a random tree of three levels, in [0, size]^3.
DirectLight randomPolygons(int count, bool twoSided, double size, std::uint32_t seed);
DirectLight randomTree(bool coloured, bool twoSided, double size, std::uint32_t seed);

}  // namespace lpv::reference
