#include "import/gltf_extras.h"

#include <cmath>

namespace lpv::cli {
namespace {

EmissiveMaterial materialFrom(const JsonPlace& place) {
  EmissiveMaterial out;
  out.name = place.at("name").text();
  const JsonPlace factor = place.at("emissiveFactor");
  for (int c = 0; c < 3; ++c) out.factor[c] = factor.at(std::size_t(c)).number(0.0);
  const JsonPlace strength = place.at("extensions").at("KHR_materials_emissive_strength").at("emissiveStrength");
  if (std::isfinite(strength.number(1.0))) out.strength = strength.number(1.0);
  return out;
}

}  // namespace

GltfExtras readGltfExtras(const JsonPlace& root) {
  GltfExtras out;
  const JsonPlace materials = root.at("materials");
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const EmissiveMaterial material = materialFrom(materials.at(i));
    if (material.factor != glm::dvec3(0.0)) out.emissive.push_back(material);
  }
  const JsonPlace nodes = root.at("nodes");
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const JsonPlace node = nodes.at(i);
    const auto camera = node.at("camera").index(root.at("cameras").size(), "cameras");
    const double fov = camera ? root.at("cameras").at(*camera).at("perspective").at("yfov").number(0.0) : 0.0;
    if (node.at("name").present() && fov > 0.0) out.verticalFov[node.at("name").text()] = fov;
  }
  return out;
}

double GltfExtras::strengthOf(const std::string& name, const glm::dvec3& factor) const {
  for (const EmissiveMaterial& material : emissive) {
    const glm::dvec3 difference = glm::abs(material.factor - factor);
    if (material.name == name && difference.x + difference.y + difference.z < 1e-5) return material.strength;
  }
  return 1.0;
}

}  // namespace lpv::cli
