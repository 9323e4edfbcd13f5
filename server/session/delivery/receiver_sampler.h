#pragma once
// Points of the scene's lit surfaces, chosen at random with a known density.

#include <cstddef>
#include <glm/glm.hpp>
#include <random>
#include <vector>

#include "scene/scene.h"

namespace lpv {

using Random = std::mt19937;

/// A point of a surface, world space, metres, and the unit normal of the side that is looked at.
struct Receiver {
  glm::dvec3 position{0.0};
  glm::dvec3 normal{0.0, 0.0, 1.0};
};

/// The sides of triangles that can be lit: those of the scene's surfaces, two of each where a surface has two sides.
/// Where there are none, the walls of a room a tenth smaller than the grid on each side, from within.
class LitSides {
 public:
  explicit LitSides(const Scene& scene);

  /// m^2; a triangle with two sides counts twice.
  double area() const { return running_.empty() ? 0.0 : running_.back(); }
  /// Uniform over area(), which is not 0.
  Receiver sample(Random& random) const;
  /// Appends where a ray from `origin` along the unit vector `direction` crosses a side that faces it. Nothing
  /// occludes: a ray crosses all sides on its way. Returns the number of triangles that were looked at.
  std::size_t cross(const glm::dvec3& origin, const glm::dvec3& direction, std::vector<Receiver>* out) const;

 private:
  struct Triangle {
    glm::dvec3 corners[3];
    glm::dvec3 normal;  ///< unit
    bool twoSided = false;
  };
  /// Triangles that follow each other, and the box around them.
  struct Range {
    std::size_t begin = 0, end = 0;
    Bounds box;
  };

  void add(const Surface& surface);
  void addWalls(const Grid& grid);
  void add(const glm::dvec3 (&corners)[3], bool twoSided, Range* range);

  std::vector<Triangle> triangles_;
  std::vector<double> running_;  ///< area up to and with each triangle
  std::vector<Range> ranges_;
};

/// What emits in a scene, without textures and emission directions: where light leaves it, and the closed form of what
/// arrives.
class AreaLights {
 public:
  explicit AreaLights(const Scene& scene);

  std::size_t triangles() const { return running_.size(); }
  /// W; the mean of red, green and blue.
  double power() const { return running_.empty() ? 0.0 : running_.back(); }
  /// A point and direction in which a share of power() leaves that is the same for every sample.
  void emit(Random& random, glm::dvec3* origin, glm::dvec3* direction) const;
  /// W/m^2, unoccluded (Lambert; Arvo 1995; MATHS.md 5.1).
  glm::dvec3 irradiance(const Receiver& at) const;

 private:
  struct Triangle {
    glm::dvec3 corners[3];  ///< counter-clockwise seen from the front
    std::size_t light = 0;
  };
  struct Emission {
    glm::dvec3 radiance{0.0};
    int sides = 1;
  };

  std::vector<Triangle> triangles_;
  std::vector<Emission> lights_;
  std::vector<double> running_;  ///< power up to and with each triangle
};

}  // namespace lpv
