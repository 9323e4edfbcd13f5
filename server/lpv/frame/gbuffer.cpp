#include "lpv/frame/gbuffer.h"

#include "gpu/gl.h"
#include "scene/transparency.h"

namespace lpv {

namespace {

/// Those of which cameras see something that is not a pane.
std::vector<DrawItem> visibleSurfaces(const FrameView& view, const Scene& scene, const SceneResources& resources) {
  std::vector<DrawItem> items;
  for (const auto& [name, surface] : scene.surfaces) {
    if (!surface->visibleToCamera || !view.sees(surface->mesh->bounds, surface->transform.worldFromObject())) continue;
    DrawItem item = drawItemOf(view, *surface, resources);
    if (!item.alphaVaries && item.params.opacity < item.params.leastAlpha) continue;
    if (!item.alphaVaries) item.params.colour *= item.params.opacity;
    items.push_back(item);
  }
  return items;
}

gpu::Defines variantOf(const DrawItem& item) {
  return {{"LPV_NORMALS", item.mesh->normals != nullptr ? "1" : "0"},
          {"LPV_TEXTURE", item.texture != nullptr ? "1" : "0"},
          gpu::define("LPV_NORMAL_MAP", item.normals != nullptr),
          gpu::define("LPV_ALPHA", item.alphaVaries)};
}

}  // namespace

DrawItem drawItemOf(const FrameView& view, const Surface& surface, const SceneResources& resources) {
  DrawItem item;
  item.mesh = resources.meshes.at(surface.mesh).get();
  if (surface.albedoTexture != nullptr && item.mesh->uvs != nullptr)
    item.texture = resources.textures.at(surface.albedoTexture).get();
  if (surface.normalTexture != nullptr && item.mesh->uvs != nullptr && surface.normalScale > 0.0)
    item.normals = resources.textures.at(surface.normalTexture).get();
  item.mirrored = surface.transform.mirrors();
  item.cullBack = !surface.twoSided;
  item.params = placed(view, surface.transform.worldFromObject());
  item.params.colour = glm::vec3(surface.albedo);
  item.params.normalScale = float(surface.normalScale);
  item.params.transmission = glm::vec3(surface.transmission);
  item.alphaVaries = alphaVaries(surface);
  const bool masked = surface.alphaMode == AlphaMode::kMask;
  item.params.opacity = float(item.alphaVaries ? surface.opacity : alphaOf(surface, 255));
  item.params.leastAlpha = float(masked && item.alphaVaries ? surface.alphaCutoff : kSeenAlpha);
  item.params.masked = masked ? 1.0F : 0.0F;
  return item;
}

Gbuffer::Gbuffer(const glm::ivec2& size)
    : albedo(gpu::Texture::make2d("albedo", size, GL_RGBA16F, gpu::Sampling::kNearestClamp)),
      normal(gpu::Texture::make2d("normal", size, GL_RG16, gpu::Sampling::kNearestClamp)),
      depth(gpu::Texture::make2d("surface depth", size, GL_DEPTH_COMPONENT32F, gpu::Sampling::kNearestClamp)),
      target("G-buffer", {&albedo, &normal}, &depth) {}

GbufferInputs gbufferInputs(const FrameRows& request, const Scene& scene) {
  GbufferInputs inputs;
  inputs.camera = request.camera;
  inputs.firstRow = request.firstRow;
  for (const auto& [name, surface] : scene.surfaces) inputs.surfaces.push_back(surface);
  return inputs;
}

GpuTask GbufferRenderer::run(Gbuffer& gbuffer, const FrameRows& request, const Scene& scene,
                             const SceneResources& resources, const MeshDrawer& drawer, const gpu::Buffer& frameParams,
                             Pacing pacing) {
  const std::vector<DrawItem> items = visibleSurfaces(FrameView(request), scene, resources);
  const auto programOf = [this](const DrawItem& item) -> gpu::Program& { return programs_.get(variantOf(item)); };
  co_await drawer.run(Stage::kGbuffer, gbuffer.target, frameParams, items, programOf, pacing);
}

}  // namespace lpv
