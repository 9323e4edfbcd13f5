#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "reference/emitter.h"
#include "scene/scene.h"

namespace lpv::evaluation {

/// Unoccluded irradiance by the closed form of polygons (tests/reference/ground_truth.h), which has no noise. Available
/// where no light has a texture and all together have few enough triangles.
class ClosedForm {
 public:
  explicit ClosedForm(const Scene& scene);

  bool available() const { return available_; }
  /// W/m^2; `normal` is of unit length.
  glm::dvec3 irradiance(const glm::dvec3& position, const glm::dvec3& normal) const;

 private:
  std::vector<reference::Emitter> emitters_;
  bool available_ = true;
};

}  // namespace lpv::evaluation
