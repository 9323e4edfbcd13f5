#include "scene/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <string>

namespace lpv {
namespace {

Status checkVector(const char* field, const glm::dvec3& v) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isfinite(v[axis]) && std::abs(v[axis]) <= 1e9) continue;
    return invalid(field, std::string("camera.") + field + " must be finite and within 1e9 m");
  }
  return {};
}

/// Either way. False for no length and for no number.
bool isAlong(const glm::dvec3& view, const glm::dvec3& up) {
  return glm::length(glm::cross(glm::normalize(view), glm::normalize(up))) < 1e-6;
}

}  // namespace

void Camera::setRangeByDistance() {
  constexpr double kShare = 0.01;
  const Camera usual;
  const double distance = glm::distance(eye, target);
  near = std::min(usual.near, std::max(kShare * distance, 1e-9));
  far = std::max(usual.far, distance / kShare);
}

void Camera::setUpByView() {
  up = {0.0, 1.0, 0.0};
  if (isAlong(target - eye, up)) up = {0.0, 0.0, -1.0};
}

glm::dmat4 Camera::viewFromWorld() const { return glm::lookAt(eye, target, up); }

glm::dmat4 Camera::clipFromView(double aspect) const {
  return glm::perspective(glm::radians(fovDegrees), aspect, near, far);
}

glm::dvec3 Camera::rayDirection(double u, double v, double aspect) const {
  const glm::dvec3 forward = glm::normalize(target - eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, up));
  const glm::dvec3 above = glm::cross(right, forward);
  const double height = std::tan(glm::radians(fovDegrees) * 0.5);
  return glm::normalize(forward + right * ((2.0 * u - 1.0) * height * aspect) + above * ((1.0 - 2.0 * v) * height));
}

Status checkCamera(const Camera& c) {
  if (Status s = checkVector("eye", c.eye); !s.ok()) return s;
  if (Status s = checkVector("target", c.target); !s.ok()) return s;
  if (Status s = checkVector("up", c.up); !s.ok()) return s;
  const glm::dvec3 view = c.target - c.eye;
  if (glm::length(view) < 1e-9) return invalid("target", "camera.target is where camera.eye is; give another point");
  if (glm::length(c.up) < 1e-9) return invalid("up", "camera.up has no length");
  if (isAlong(view, c.up)) {
    return invalid("up", "camera.up is parallel to the view direction; give another");
  }
  if (!(c.fovDegrees >= 1.0 && c.fovDegrees <= 170.0)) {
    return invalid("fov_degrees", "camera.fov_degrees is " + std::to_string(c.fovDegrees) + ", allowed are 1..170");
  }
  if (!(c.near > 0.0 && std::isfinite(c.near))) return invalid("near", "camera.near must be above 0");
  if (!(c.far > c.near && std::isfinite(c.far))) return invalid("far", "camera.far must be above camera.near");
  return {};
}

Camera defaultCamera(const Bounds& content) {
  Camera camera;
  if (content.empty()) return camera;
  const glm::dvec3 extent = glm::max(content.extent(), glm::dvec3(1e-3));
  const double size = glm::length(extent);
  camera.target = content.centre();
  camera.eye = camera.target + glm::normalize(glm::dvec3(0.6, 0.45, 1.0)) * (1.15 * size);
  camera.near = size * 1e-3;
  camera.far = size * 10.0;
  return camera;
}

}  // namespace lpv
