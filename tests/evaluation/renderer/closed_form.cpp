#include "renderer/closed_form.h"

#include "reference/ground_truth.h"

namespace lpv::evaluation {

namespace {

constexpr std::size_t kMostTriangles = 4000;  ///< .4 ms a receiver, as much as some hundred paths

}  // namespace

ClosedForm::ClosedForm(const Scene& scene) {
  for (const auto& [name, light] : scene.lights) {
    if (!light->enabled) continue;
    const bool textured = light->texture != nullptr && !light->mesh->uvs.empty();
    available_ = available_ && !textured && emitters_.size() + light->mesh->triangles.size() <= kMostTriangles;
    if (!available_) return;
    const std::vector<reference::Emitter> more = reference::emittersOf(Grid(), *light).triangles;
    emitters_.insert(emitters_.end(), more.begin(), more.end());
  }
}

glm::dvec3 ClosedForm::irradiance(const glm::dvec3& position, const glm::dvec3& normal) const {
  return reference::irradianceOf(emitters_, position, normal);
}

}  // namespace lpv::evaluation
