#include "lpv/frame/gbuffer.h"

#include <algorithm>

#include "gpu/gl.h"
#include "scene/transparency.h"

namespace lpv {

namespace {

/// Triangles that are looked at together; those that follow each other in a mesh mostly lie together.
constexpr std::size_t kTrianglesTogether = 256;

/// What of an item may be in a part of the picture.
void addIn(const PicturePart& part, const FrameView& view, const Surface& surface, const DrawItem& item,
           std::vector<DrawItem>& items) {
  const glm::dmat4 worldFromObject = surface.transform.worldFromObject();
  const Mesh& mesh = *surface.mesh;
  bool follows = false;
  for (std::size_t first = 0; first < mesh.triangles.size(); first += kTrianglesTogether) {
    const std::size_t end = std::min(first + kTrianglesTogether, mesh.triangles.size());
    Bounds box;
    for (std::size_t i = first; i < end; ++i) {
      for (int corner = 0; corner < 3; ++corner) box.add(glm::dvec3(mesh.positions[mesh.triangles[i][corner]]));
    }
    const bool isIn = part.meets(view.partOf(box, worldFromObject));
    if (isIn && !follows) {
      items.push_back(item);
      items.back().first = int(first);
    }
    if (isIn) items.back().count += int(end - first);
    follows = isIn;
  }
}

/// Those of which cameras see something that is not a pane; `part`: of the picture, null for all of it.
std::vector<DrawItem> visibleSurfaces(const FrameView& view, const PicturePart* part, const Scene& scene,
                                      const SceneResources& resources) {
  std::vector<DrawItem> items;
  for (const auto& [name, surface] : scene.surfaces) {
    if (!surface->visibleToCamera || !view.sees(surface->mesh->bounds, surface->transform.worldFromObject())) continue;
    DrawItem item = drawItemOf(view, *surface, resources);
    if (!item.alphaVaries && item.params.opacity < item.params.leastAlpha) continue;
    if (!item.alphaVaries) item.params.colour *= item.params.opacity;
    if (part != nullptr) {
      addIn(*part, view, *surface, item, items);
    } else {
      items.push_back(item);
    }
  }
  return items;
}

}  // namespace

std::vector<DrawItem> surfacesIn(const PicturePart& part, const FrameRows& request, const Scene& scene,
                                 const SceneResources& resources) {
  return visibleSurfaces(FrameView(request), &part, scene, resources);
}

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
  const std::vector<DrawItem> items = visibleSurfaces(FrameView(request), nullptr, scene, resources);
  const bool glossy = bool(gbuffer.material);
  const auto programOf = [this, glossy](const DrawItem& item) -> gpu::Program& {
    return programs_.get(variantOf(item, glossy));
  };
  co_await drawer.run(Stage::kGbuffer, gbuffer.target, frameParams, items, programOf, pacing);
}

GpuTask GbufferRenderer::runDepth(const gpu::Framebuffer& target, const PixelRange& pixels,
                                  const std::vector<DrawItem>& surfaces, const MeshDrawer& drawer,
                                  const gpu::Buffer& frameParams, Pacing pacing) {
  const auto programOf = [this](const DrawItem& item) -> gpu::Program& {
    return programs_.get(variantOf(item, false));
  };
  co_await drawer.run(Stage::kGbuffer, target, frameParams, surfaces, programOf, pacing, DrawMode::kNearest, pixels);
}

}  // namespace lpv
