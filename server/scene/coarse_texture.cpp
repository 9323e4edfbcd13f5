#include "scene/coarse_texture.h"

#include <algorithm>
#include <cmath>

namespace lpv {

namespace {

constexpr int kRowsOfABox = 4;

}  // namespace

CoarseTexture::CoarseTexture(const Texture& texture, const std::vector<float>& factors, int mostBoxes)
    : size_(std::min(texture.width, mostBoxes), std::min(texture.height, mostBoxes)),
      means_(std::size_t(size_.x) * std::size_t(size_.y)) {
  std::vector<double> counts(means_.size());
  std::vector<glm::vec3> row;
  std::vector<std::uint8_t> alphas;
  const int step = std::max(1, texture.height / (mostBoxes * kRowsOfABox));
  for (int y = 0; y < texture.height; y += step) {
    row.clear();
    appendLinearRow(texture, y, row);
    alphas.clear();
    if (!factors.empty()) appendAlphaRow(texture, y, alphas);
    for (int x = 0; x < texture.width; ++x) {
      const std::size_t box = indexOf({x * size_.x / texture.width, y * size_.y / texture.height});
      const double factor = factors.empty() ? 1.0 : double(factors[alphas[std::size_t(x)]]);
      means_[box] += factor * glm::dvec3(row[std::size_t(x)]);
      counts[box] += 1.0;
    }
  }
  for (std::size_t i = 0; i < means_.size(); ++i) means_[i] /= std::max(counts[i], 1.0);
}

glm::vec3 CoarseTexture::meanOver(const glm::dvec2 (&uvs)[3]) const {
  const glm::dvec2 right = uvs[1] - uvs[0], up = uvs[2] - uvs[0];
  const double boxes = 0.5 * std::abs(right.x * up.y - right.y * up.x) * double(size_.x) * double(size_.y);
  const int places = int(std::clamp(kPlacesOfBox * boxes, 1.0, double(kMostPlaces)));
  glm::dvec3 sum(0.0);
  for (int i = 0; i < places; ++i) {
    // A sequence that is spread evenly (Roberts 2018), folded over the diagonal; the first is the middle.
    glm::dvec2 w = glm::fract(1.0 / 3.0 + double(i) * glm::dvec2(0.7548776662, 0.5698402910));
    if (w.x + w.y > 1.0) w = 1.0 - w;
    sum += glm::dvec3(at(uvs[0] + w.x * right + w.y * up));
  }
  return glm::vec3(sum / double(places));
}

glm::vec3 CoarseTexture::at(const glm::dvec2& uv) const {
  const glm::dvec2 wrapped = uv - glm::floor(uv);
  return glm::vec3(means_[indexOf(glm::min(glm::ivec2(wrapped * glm::dvec2(size_)), size_ - 1))]);
}

}  // namespace lpv
