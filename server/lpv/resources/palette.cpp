#include "lpv/resources/palette.h"

#include <algorithm>
#include <glm/gtx/component_wise.hpp>

namespace lpv {

namespace {

/// Index of the channel whose colour is that of `c` up to a factor, or -1.
int channelOf(const Palette& palette, int used, const glm::dvec3& c) {
  for (int k = 0; k < used; ++k) {
    const glm::dvec3& p = palette.radiance[std::size_t(k)];
    const double tolerance = 1e-12 * glm::compMax(c) * glm::compMax(p);
    if (glm::all(glm::lessThanEqual(glm::abs(c * glm::compMax(p) - p * glm::compMax(c)), glm::dvec3(tolerance))))
      return k;
  }
  return -1;
}

Palette redGreenBlue(const std::vector<EmittingLight>& lights) {
  Palette palette;
  palette.channels = 3;
  glm::dvec3 most(0.0);
  for (const EmittingLight& light : lights) most = glm::max(most, light.radiance);
  for (int k = 0; k < 3; ++k) palette.radiance[std::size_t(k)][k] = most[k];
  for (const EmittingLight& light : lights) {
    glm::dvec3 weight(0.0);
    for (int k = 0; k < 3; ++k) weight[k] = most[k] > 0.0 ? light.radiance[k] / most[k] : 0.0;
    palette.weights.push_back(weight);
  }
  return palette;
}

}  // namespace

Palette choosePalette(const std::vector<EmittingLight>& lights) {
  if (std::any_of(lights.begin(), lights.end(), [](const EmittingLight& l) { return l.texture != nullptr; }))
    return redGreenBlue(lights);
  Palette palette;
  std::vector<int> channels;
  int used = 0;
  for (const EmittingLight& light : lights) {
    int k = channelOf(palette, used, light.radiance);
    if (k < 0 && used == 2) return redGreenBlue(lights);
    if (k < 0) palette.radiance[std::size_t(k = used++)] = light.radiance;
    glm::dvec3& unit = palette.radiance[std::size_t(k)];
    if (glm::compMax(light.radiance) > glm::compMax(unit)) unit = light.radiance;
    channels.push_back(k);
  }
  palette.channels = std::max(used, 1);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    glm::dvec3 weight(0.0);
    weight[channels[i]] = glm::compMax(lights[i].radiance) / glm::compMax(palette.radiance[std::size_t(channels[i])]);
    palette.weights.push_back(weight);
  }
  return palette;
}

}  // namespace lpv
