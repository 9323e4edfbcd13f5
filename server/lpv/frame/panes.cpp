#include "lpv/frame/panes.h"

#include "gpu/gl.h"
#include "scene/transparency.h"

namespace lpv {

namespace {

/// Whether cameras see through some of a surface, and something changes on the way.
bool isPane(const Surface& surface) {
  if (!surface.visibleToCamera || surface.alphaMode == AlphaMode::kOpaque) return false;
  const bool tints = surface.transmission != glm::dvec3(1.0);
  if (alphaVaries(surface)) return tints || surface.alphaMode == AlphaMode::kBlend;
  const double alpha = alphaOf(surface, 255);
  return alpha < kSeenAlpha && (tints || alpha > 0.0);
}

bool isInPicture(const FrameView& view, const Surface& surface) {
  return isPane(surface) && view.sees(surface.mesh->bounds, surface.transform.worldFromObject());
}

}  // namespace

PaneBuffer::PaneBuffer(const glm::ivec2& size)
    : share(gpu::Texture::make2d("panes", size, GL_RGBA16F, gpu::Sampling::kNearestClamp)),
      target("panes", {&share}, nullptr) {}

bool PaneRenderer::needed(const FrameRows& request, const Scene& scene) {
  const FrameView view(request);
  for (const auto& [name, surface] : scene.surfaces) {
    if (isInPicture(view, *surface)) return true;
  }
  return false;
}

GpuTask PaneRenderer::run(const PaneBuffer& buffer, const Gbuffer& gbuffer, const EmitterBuffer& emitters,
                          const FrameRows& request, const Scene& scene, const SceneResources& resources,
                          const MeshDrawer& drawer, const gpu::Buffer& frameParams, Pacing pacing) {
  const FrameView view(request);
  std::vector<DrawItem> items;
  for (const auto& [name, surface] : scene.surfaces) {
    if (isInPicture(view, *surface)) items.push_back(drawItemOf(view, *surface, resources));
  }
  const auto programOf = [&](const DrawItem& item) -> gpu::Program& {
    gbuffer.depth.bind(layout::kSurfaceDepth);
    emitters.depth.bind(layout::kEmitterDepth);
    return programs_.get({gpu::define("LPV_ALPHA", item.alphaVaries)});
  };
  co_await drawer.run(Stage::kGbuffer, buffer.target, frameParams, items, programOf, pacing, DrawMode::kMultiply);
}

}  // namespace lpv
