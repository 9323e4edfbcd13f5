#include "reference/shadowed.h"

#include "reference/ground_truth.h"
#include "scene/occluders.h"

namespace lpv::reference {
namespace {

constexpr double kOffset = 1e-5;  ///< metres, along a receiver's normal
constexpr double kEnd = 1.0 - 1e-6;

/// n^2 triangles of the same area.
std::vector<std::array<glm::dvec3, 3>> cut(const std::array<glm::dvec3, 3>& t, int n) {
  const auto at = [&](int i, int j) { return t[0] + double(i) / n * (t[1] - t[0]) + double(j) / n * (t[2] - t[0]); };
  std::vector<std::array<glm::dvec3, 3>> out;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      out.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + j + 1 < n) out.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return out;
}

}  // namespace

ShadowedLights::ShadowedLights(const Scene& scene, int pieces) : occlusion_(occludersOf(scene)) {
  int index = 0;
  for (const auto& [name, light] : scene.lights) {
    if (!light->enabled || radianceOf(*light) == glm::dvec3(0.0)) continue;
    for (const Emitter& whole : emittersOf(scene.grid, *light).triangles) {
      for (const auto& corners : cut(whole.corners, pieces)) {
        pieces_.push_back({whole, index});
        pieces_.back().emitter.corners = corners;
      }
    }
    ++index;
  }
}

glm::dvec3 ShadowedLights::irradiance(const Receiver& receiver) const {
  const glm::dvec3 from = receiver.position + kOffset * receiver.normal;
  glm::dvec3 sum(0.0);
  for (const Piece& piece : pieces_) {
    const glm::dvec3 e = irradianceOf({piece.emitter}, receiver.position, receiver.normal);
    if (e == glm::dvec3(0.0)) continue;
    const auto& c = piece.emitter.corners;
    const glm::dvec3 to = glm::mix(from, (c[0] + c[1] + c[2]) / 3.0, kEnd);
    if (occlusion_.meeting({from, to}, piece.light, 0.0) != Meeting::kSome) sum += e;
  }
  return sum;
}

std::vector<glm::dvec3> ShadowedLights::irradiances(const std::vector<Receiver>& receivers) const {
  std::vector<glm::dvec3> out;
  out.reserve(receivers.size());
  for (const Receiver& receiver : receivers) out.push_back(irradiance(receiver));
  return out;
}

}  // namespace lpv::reference
