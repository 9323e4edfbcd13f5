#include "scene/transparency.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "base/mutex.h"

namespace lpv {

namespace {

constexpr int kSamplesOfABox = 8;  ///< rows and columns of its texels that are looked at, at most
constexpr int kBlended = -1;       ///< as a threshold: alpha as it is

/// The lowest alpha of a texel that a mask takes for covered: 256 where none is.
int thresholdOf(const Surface& surface) {
  int level = 0;
  while (level < 256 && surface.opacity * level / 255.0 < surface.alphaCutoff) ++level;
  return level;
}

AlphaMap mapOf(const Texture& texture, int threshold) {
  AlphaMap out;
  out.size = glm::min(glm::ivec2(texture.width, texture.height), glm::ivec2(kMostAlphaBoxes));
  const glm::ivec2 step =
      glm::max(glm::ivec2(texture.width, texture.height) / (out.size * kSamplesOfABox), glm::ivec2(1));
  std::vector<std::uint32_t> sums(std::size_t(out.size.x) * std::size_t(out.size.y)), counts(sums.size());
  std::vector<std::uint8_t> row;
  for (int y = 0; y < texture.height; y += step.y) {
    row.clear();
    appendAlphaRow(texture, y, row);
    const std::size_t first = std::size_t(y * out.size.y / texture.height) * std::size_t(out.size.x);
    for (int x = 0; x < texture.width; x += step.x) {
      const std::size_t box = first + std::size_t(x * out.size.x / texture.width);
      const int alpha = row[std::size_t(x)];
      sums[box] += threshold == kBlended ? std::uint32_t(alpha) : (alpha >= threshold ? 255U : 0U);
      counts[box]++;
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i)
    out.alphas.push_back(std::uint8_t((sums[i] + counts[i] / 2) / std::max(counts[i], 1U)));
  return out;
}

/// The maps that are in use.
class KnownMaps {
 public:
  AlphaMapPtr of(const TexturePtr& texture, int threshold) LPV_EXCLUDES(mutex_) {
    const Key key{texture, threshold};
    if (AlphaMapPtr known = find(key)) return known;
    auto made = std::make_shared<const AlphaMap>(mapOf(*texture, threshold));
    const MutexLock lock(mutex_);
    std::erase_if(maps_, [](const auto& entry) { return entry.second.expired(); });
    std::weak_ptr<const AlphaMap>& kept = maps_[key];
    if (AlphaMapPtr first = kept.lock()) return first;  // another thread's
    kept = made;
    return made;
  }

 private:
  struct Key {
    std::weak_ptr<const Texture> texture;
    int threshold = 0;

    bool operator<(const Key& other) const {
      if (texture.owner_before(other.texture)) return true;
      return !other.texture.owner_before(texture) && threshold < other.threshold;
    }
  };
  AlphaMapPtr find(const Key& key) LPV_EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    const auto known = maps_.find(key);
    return known == maps_.end() ? nullptr : known->second.lock();
  }

  Mutex mutex_;
  std::map<Key, std::weak_ptr<const AlphaMap>> maps_ LPV_GUARDED_BY(mutex_);
};

AlphaMapPtr mapOf(const Surface& surface) {
  static KnownMaps known;
  return known.of(surface.albedoTexture, surface.alphaMode == AlphaMode::kMask ? thresholdOf(surface) : kBlended);
}

}  // namespace

double AlphaMap::at(const glm::dvec2& uv) const {
  const glm::dvec2 wrapped = uv - glm::floor(uv);
  const glm::ivec2 box = glm::min(glm::ivec2(wrapped * glm::dvec2(size)), size - 1);
  return alphas[std::size_t(box.y) * std::size_t(size.x) + std::size_t(box.x)] / 255.0;
}

bool Coverage::isOpaque() const {
  if (transmission == glm::dvec3(0.0)) return true;
  return alpha == 1.0 && (map == nullptr || std::ranges::all_of(map->alphas, [](auto a) { return a == 255; }));
}

bool Coverage::letsAllThrough() const {
  if (transmission != glm::dvec3(1.0)) return false;
  return alpha == 0.0 || (map != nullptr && std::ranges::all_of(map->alphas, [](auto a) { return a == 0; }));
}

glm::dvec3 Coverage::through(const glm::dvec2& uv) const {
  return (1.0 - (map == nullptr ? alpha : alpha * map->at(uv))) * transmission;
}

double alphaOf(const Surface& surface, std::uint8_t texel) {
  if (surface.alphaMode == AlphaMode::kOpaque) return 1.0;
  const double alpha = surface.opacity * texel / 255.0;
  return surface.alphaMode == AlphaMode::kBlend ? alpha : (alpha >= surface.alphaCutoff ? 1.0 : 0.0);
}

bool alphaVaries(const Surface& surface) {
  return surface.alphaMode != AlphaMode::kOpaque && surface.albedoTexture != nullptr &&
         hasAlpha(*surface.albedoTexture) && !surface.mesh->uvs.empty();
}

Coverage coverageOf(const Surface& surface) {
  Coverage out;
  if (surface.alphaMode == AlphaMode::kOpaque) return out;
  out.transmission = surface.transmission;
  if (!alphaVaries(surface)) {
    out.alpha = alphaOf(surface, 255);
    return out;
  }
  out.map = mapOf(surface);
  if (surface.alphaMode == AlphaMode::kBlend) out.alpha = surface.opacity;
  return out;
}

bool canStop(const Surface& surface) {
  if (!surface.castsShadow) return false;
  return alphaVaries(surface) || surface.transmission != glm::dvec3(1.0) || alphaOf(surface, 255) > 0.0;
}

}  // namespace lpv
