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

}  // namespace

gpu::Defines GbufferRenderer::Variant::defines() const {
  return {gpu::define("LPV_NORMALS", normals), gpu::define("LPV_TEXTURE", texture),
          gpu::define("LPV_ALPHA", alpha),     gpu::define("LPV_NORMAL_MAP", normalMap),
          gpu::define("LPV_GLOSS", gloss),     gpu::define("LPV_GLOSS_MAP", glossMap)};
}

GbufferRenderer::Variant GbufferRenderer::variantOf(const DrawItem& item, bool glossy) {
  return {item.mesh->normals != nullptr,  item.texture != nullptr, item.normals != nullptr, item.alphaVaries, glossy,
          glossy && item.gloss != nullptr};
}

DrawItem drawItemOf(const FrameView& view, const Surface& surface, const SceneResources& resources) {
  DrawItem item;
  item.mesh = resources.meshes.at(surface.mesh).get();
  if (surface.albedoTexture != nullptr && item.mesh->uvs != nullptr)
    item.texture = resources.textures.at(surface.albedoTexture).get();
  if (surface.normalTexture != nullptr && item.mesh->uvs != nullptr && surface.normalScale > 0.0)
    item.normals = resources.textures.at(surface.normalTexture).get();
  if (const auto gloss = resources.textures.find(surface.glossTexture);
      gloss != resources.textures.end() && item.mesh->uvs != nullptr)
    item.gloss = gloss->second.get();
  item.mirrored = surface.transform.mirrors();
  item.cullBack = !surface.twoSided;
  item.params = placed(view, surface.transform.worldFromObject());
  item.params.colour = glm::vec3(surface.albedo);
  item.params.normalScale = float(surface.normalScale);
  item.params.roughness = float(surface.roughness);
  item.params.metalness = float(surface.metalness);
  item.params.transmission = glm::vec3(surface.transmission);
  item.alphaVaries = alphaVaries(surface);
  const bool masked = surface.alphaMode == AlphaMode::kMask;
  item.params.opacity = float(item.alphaVaries ? surface.opacity : alphaOf(surface, 255));
  item.params.leastAlpha = float(masked && item.alphaVaries ? surface.alphaCutoff : kSeenAlpha);
  item.params.masked = masked ? 1.0F : 0.0F;
  return item;
}

Gbuffer::Gbuffer(const glm::ivec2& size, bool glossy)
    : albedo(gpu::Texture::make2d("albedo", size, GL_RGBA16F, gpu::Sampling::kNearestClamp)),
      normal(gpu::Texture::make2d("normal", size, GL_RG16, gpu::Sampling::kNearestClamp)),
      depth(gpu::Texture::make2d("surface depth", size, GL_DEPTH_COMPONENT32F, gpu::Sampling::kNearestClamp)),
      material(glossy ? gpu::Texture::make2d("material", size, GL_RG16, gpu::Sampling::kNearestClamp) : gpu::Texture()),
      target(glossy ? gpu::Framebuffer("G-buffer", {&albedo, &normal, &material}, &depth)
                    : gpu::Framebuffer("G-buffer", {&albedo, &normal}, &depth)) {}

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
  const bool glossy = bool(gbuffer.material);
  const auto programOf = [this, glossy](const DrawItem& item) -> gpu::Program& {
    return programs_.get(variantOf(item, glossy));
  };
  co_await drawer.run(Stage::kGbuffer, gbuffer.target, frameParams, items, programOf, pacing);
}

}  // namespace lpv
