#include "lpv/frame/emitters.h"

#include "gpu/gl.h"

namespace lpv {

namespace {

glm::dmat4 placeOf(const FrameView& view, const Light& light) {
  return light.distant ? view.worldFromDistant(light) : light.transform.worldFromObject();
}

bool isVisible(const FrameView& view, const Light& light) {
  if (!light.enabled || !light.visibleToCamera) return false;
  return light.distant || view.sees(light.mesh->bounds, placeOf(view, light));
}

/// Every enabled light that cameras see, also one whose radiance is 0: it is there, and black. So is the back of a
/// one-sided light.
std::vector<DrawItem> visibleLights(const FrameView& view, const Scene& scene, const SceneResources& resources) {
  std::vector<DrawItem> items;
  for (const auto& [name, light] : scene.lights) {
    if (!isVisible(view, *light)) continue;
    const glm::dmat4 worldFromObject = placeOf(view, *light);
    DrawItem& item = items.emplace_back();
    item.mesh = resources.meshes.at(light->mesh).get();
    if (light->texture != nullptr && item.mesh->uvs != nullptr)
      item.texture = &resources.lightTextures.at(light->texture)->radiance;
    item.mirrored = light->transform.mirrors();
    item.params = placed(view, worldFromObject);
    item.params.colour = glm::vec3(emittedRadiance(*light));
    item.params.atInfinity = light->distant ? 1.0F : 0.0F;
    item.params.backColour = light->twoSided ? item.params.colour : glm::vec3(0.0F);
  }
  return items;
}

}  // namespace

PicturePart partOfLights(const FrameRows& request, const Scene& scene) {
  const FrameView view(request);
  PicturePart out;
  for (const auto& [name, light] : scene.lights) {
    if (isVisible(view, *light)) out.add(view.partOf(light->mesh->bounds, placeOf(view, *light)));
  }
  return out;
}

EmitterBuffer::EmitterBuffer(const glm::ivec2& size)
    : emission(gpu::Texture::make2d("emission", size, GL_RGBA32F, gpu::Sampling::kNearestClamp)),
      depth(gpu::Texture::make2d("emitter depth", size, GL_DEPTH_COMPONENT32F, gpu::Sampling::kNearestClamp)),
      target("emitters", {&emission}, &depth) {}

GpuTask EmitterRenderer::run(const EmitterBuffer& buffer, const FrameRows& request, const Scene& scene,
                             const SceneResources& resources, const MeshDrawer& drawer, const gpu::Buffer& frameParams,
                             Pacing pacing, std::optional<PixelRange> pixels) {
  const std::vector<DrawItem> items = visibleLights(FrameView(request), scene, resources);
  const auto programOf = [this](const DrawItem& item) -> gpu::Program& {
    return programs_.get({{"LPV_TEXTURE", item.texture != nullptr ? "1" : "0"}});
  };
  co_await drawer.run(Stage::kEmitters, buffer.target, frameParams, items, programOf, pacing, DrawMode::kNearest,
                      pixels);
}

}  // namespace lpv
