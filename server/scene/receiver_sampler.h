#pragma once
// Points of the scene's lit surfaces, chosen at random with a known density.

#include <cstddef>
#include <glm/glm.hpp>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "scene/emitter_list.h"
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
  explicit LitSides(const Scene& scene) : LitSides(scene, scene.grid) {}
  /// With the walls of `grid` where there are no surfaces.
  LitSides(const Scene& scene, const Grid& grid);

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

/// What emits in a scene: where light leaves it, and the closed form of what arrives. Textures are taken as their mean,
/// emission directions as normals.
class AreaLights {
 public:
  /// Of a light with many more triangles than `most` every second, third, .., which stand for those left out.
  explicit AreaLights(const Scene& scene, std::size_t most = std::numeric_limits<std::size_t>::max());

  std::size_t triangles() const { return running_.size(); }
  std::size_t lights() const { return lights_.size(); }
  const glm::dvec3& radiance(std::size_t light) const { return lights_[light].radiance; }
  const std::string& group(std::size_t light) const { return lights_[light].group; }
  /// Whether receivers near the light see it as VPLs, not as triangles.
  bool isTree(std::size_t light) const { return lights_[light].tree; }
  /// Metres, the diagonal of its mesh's box.
  double across(std::size_t light) const { return lights_[light].across; }
  /// W; the mean of red, green and blue.
  double power() const { return running_.empty() ? 0.0 : running_.back(); }
  /// The same power from about `most` triangles: of each light that has more than its part of them, and more than a
  /// few, triangles chosen by area (stratified), each of which stands for as much area.
  AreaLights thinned(std::size_t most, Random& random) const;
  /// A point and direction in which a share of power() leaves that is the same for every sample.
  void emit(Random& random, glm::dvec3* origin, glm::dvec3* direction) const;
  /// W/m^2, unoccluded (Lambert; Arvo 1995; MATHS.md 5.1). Of a thinned light no more than from all around.
  glm::dvec3 irradiance(const Receiver& at) const;
  /// Of a share of each light.
  glm::dvec3 irradiance(const Receiver& at, std::span<const double> shares) const;
  /// Adds `weight` times what each light would send to a point with unit radiance (MATHS.md 5).
  void addMoments(const glm::dvec3& at, double weight, std::vector<Arriving>& perLight) const;
  /// Metres to the nearest emitter, `limit` where there is none nearer.
  double distance(const glm::dvec3& from, double limit) const;
  /// The same for each light that is a tree.
  std::vector<double> distancesToTrees(const glm::dvec3& from) const;

 private:
  /// Triangles that a thinned light keeps at least.
  static constexpr std::size_t kLeastOfALight = 4;

  struct Triangle {
    glm::dvec3 corners[3];  ///< counter-clockwise seen from the front
    std::size_t light = 0;
    double share = 1.0;  ///< area that it stands for, by its own
    double reach = 0.0;  ///< metres around it that it stands for
  };
  struct Emission {
    glm::dvec3 radiance{0.0};
    int sides = 1;
    std::string group;
    bool tree = false;
    double across = 0.0;
    bool thinned = false;
  };

  AreaLights() = default;
  void add(const Triangle& triangle);
  static double distanceTo(const Triangle& triangle, const glm::dvec3& from, double limit);

  std::vector<Triangle> triangles_;
  std::vector<Emission> lights_;
  std::vector<double> running_;  ///< power up to and with each triangle
};

/// Where rays from the lights cross the surfaces.
struct LitPoints {
  std::vector<Receiver> at;
  double received = 0.0;  ///< W; the integral of irradiance over the surfaces, mean of the colours
};

/// About a thousand rays, fewer where that takes more than `mostTests` tests of a ray against a triangle.
LitPoints litPoints(const LitSides& sides, const AreaLights& lights, std::size_t mostTests, Random& random);

}  // namespace lpv
