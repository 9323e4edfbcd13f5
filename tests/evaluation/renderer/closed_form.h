#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "renderer/traced_scene.h"

namespace lpv::evaluation {

/// Unoccluded direct irradiance without noise. A light's triangle is a polygon in closed form (MATHS.md 5.1) near a
/// receiver and a point farther than 16 times its size, where that is right to 1e-3 of what it sends. Textured
/// triangles are cut into pieces of about a texel, each of its own mean radiance. Not available where that makes too
/// many pieces.
class ClosedForm {
 public:
  explicit ClosedForm(const TracedScene& scene);

  bool available() const { return available_; }
  /// W/m^2; `normal` is of unit length.
  glm::dvec3 irradiance(const glm::dvec3& position, const glm::dvec3& normal) const;

 private:
  struct Piece {
    glm::dvec3 a, b, c;         ///< corners, counter-clockwise from the front
    glm::dvec3 centre, areaNormal;
    glm::dvec3 radiance;
    double reachSquared;        ///< beyond this distance it is a point
    bool twoSided;
  };
  void add(const TracedObject& object, const glm::uvec3& triangle);

  std::vector<Piece> pieces_;
  bool available_ = true;
};

}  // namespace lpv::evaluation
