#include "lpv/resources/gloss_scene.h"

#include <algorithm>
#include <bit>
#include <glm/gtc/packing.hpp>
#include <set>
#include <span>

#include "gpu/gl.h"
#include "scene/coarse_texture.h"
#include "scene/gloss.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

using Texel = glm::uvec4;

std::uint32_t bitsOf(double value) { return std::bit_cast<std::uint32_t>(float(value)); }

Texel colourTexel(const glm::dvec3& colour, std::uint32_t flags) {
  return {bitsOf(colour.r), bitsOf(colour.g), bitsOf(colour.b), flags};
}

glm::uvec2 boxesOf(const Texture& texture) {
  return glm::uvec2(glm::min(glm::ivec2(texture.width, texture.height), glm::ivec2(kMostReflectedBoxes)));
}

}  // namespace

/// Means of boxes with shared exponents, four to a texel.
const GlossScene::Packed& GlossScene::pictureOf(const TexturePtr& texture) {
  Packed& packed = pictures_[texture];
  if (!packed.empty()) return packed;
  const CoarseTexture coarse(*texture, {}, kMostReflectedBoxes);
  packed.reserve(coarse.means().size() + 3);
  for (const glm::dvec3& mean : coarse.means()) packed.push_back(glm::packF3x9_E1x5(glm::vec3(mean)));
  packed.resize((packed.size() + 3) / 4 * 4);
  return packed;
}

void GlossScene::update(const Scene& scene, bool surfaces, const std::vector<EmittingLight>& lights,
                        const LightPools& pools, Stamp pooled) {
  Inputs inputs = {{}, pooled};
  if (surfaces)
    for (const auto& [name, surface] : scene.surfaces) inputs.surfaces.push_back(surface);
  if (made_.holds(inputs)) return;
  std::set<TexturePtr> used;
  const std::size_t firstLight = 1 + layout::kGlossSurfaceTexels * inputs.surfaces.size();
  std::size_t count = firstLight + layout::kGlossLightTexels * lights.size();
  std::map<TexturePtr, std::uint32_t> places;
  const auto placeOf = [&](const TexturePtr& texture) {
    if (texture == nullptr) return Texel(0);
    if (used.insert(texture).second) {
      places[texture] = std::uint32_t(count);
      count += pictureOf(texture).size() / 4;
    }
    const glm::uvec2 boxes = boxesOf(*texture);
    return Texel(places[texture], boxes.x, boxes.y, 0);
  };
  std::vector<Texel> texels = {{std::uint32_t(firstLight), std::uint32_t(lights.size()), 0, 0}};
  for (const SurfacePtr& surface : inputs.surfaces) {
    texels.push_back(colourTexel(surface->albedo, surface->twoSided ? layout::kGlossBothSides : 0));
    texels.push_back(placeOf(surface->mesh->uvs.empty() ? nullptr : surface->albedoTexture));
  }
  double power = 0.0, before = 0.0;
  for (const LightPool& range : pools.ranges) power += range.power;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const EmittingLight& light = lights[i];
    const LightPool& range = pools.ranges[i];
    before += range.power;
    const bool passed = light.source != nullptr && !light.source->castsShadow && !light.source->distant;
    const std::uint32_t flags = (light.twoSided ? layout::kGlossBothSides : 0U) |
                                (light.mesh->directions.empty() ? 0U : layout::kGlossDirected) |
                                (passed ? layout::kGlossUnseen : 0U);
    texels.push_back(colourTexel(light.radiance, flags));
    Texel picture = placeOf(light.texture);
    picture.w = bitsOf(before / std::max(power, 1e-300));
    texels.push_back(picture);
    texels.emplace_back(std::uint32_t(range.firstPoint), std::uint32_t(range.points), bitsOf(range.area),
                        bitsOf(range.power / std::max(power, 1e-300)));
  }
  texels.resize(count);
  for (const auto& [texture, place] : places) {
    const Packed& packed = pictureOf(texture);
    for (std::size_t i = 0; i < packed.size(); i += 4)
      texels[place + i / 4] = {packed[i], packed[i + 1], packed[i + 2], packed[i + 3]};
  }
  std::erase_if(pictures_, [&used](const auto& entry) { return !used.contains(entry.first); });
  const std::size_t bytes = std::bit_ceil(texels.size() * sizeof(Texel));
  if (texels_.size() < bytes) {
    view_ = {};
    texels_ = {};  // first the old memory, then the new
    texels_ = gpu::Buffer("what reflections show", bytes, gpu::BufferUse::kDynamic, gpu::Undefined{});
    view_ = gpu::BufferTexture("what reflections show", texels_, gpu::BufferTexel::kUvec4);
  }
  texels_.update(0, gpu::bytesOf(std::span<const Texel>(texels)));
  if (!shares_) {
    shares_ = gpu::Texture::make2d("shares of lobes", glm::ivec2(kGlossTable), GL_RG32F, gpu::Sampling::kLinearClamp);
    shares_.uploadRows(0, kGlossTable, GL_RG, GL_FLOAT, glossTable().data());
  }
  made_.set(std::move(inputs));
}

void GlossScene::bind() const {
  view_.bind(layout::kGlossScene);
  shares_.bind(layout::kGlossShares);
}

}  // namespace lpv
