#include "lpv/frame/subpixels.h"

#include <algorithm>
#include <optional>

#include "gpu/gl.h"

namespace lpv {

namespace {

/// Pixels that are sampled at a time: 40 to 48 bytes each.
constexpr int kSampledPixels = 1 << 20;

/// Of `samples`, a power of two, from the pixel's middle: Hammersley's points, of which every part of a pixel that has
/// the area for one has one, wide or high as it may be (a (0, m, 2)-net). Edges along rows and columns are as even as
/// others.
glm::vec2 offsetOf(int sample, int samples) {
  int reversed = 0;
  for (int bit = 1, value = samples / 2; bit < samples; bit *= 2, value /= 2)
    reversed += (sample & bit) != 0 ? value : 0;
  return (glm::vec2(sample, reversed) + 0.5F) / float(samples) - 0.5F;
}

gpu::Texture texture(const char* label, const glm::ivec2& size, GLenum format) {
  return gpu::Texture::make2d(label, size, format, gpu::Sampling::kNearestClamp);
}

}  // namespace

/// What a sample of each pixel of some rows shows.
struct SubpixelPass::Rows {
  Rows(const glm::ivec2& size, bool seesPanes) : gbuffer(size), emitters(size) {
    if (seesPanes) panes.emplace(size);
  }
  Gbuffer gbuffer;
  EmitterBuffer emitters;
  std::optional<PaneBuffer> panes;
};

ApartBuffer::ApartBuffer(const glm::ivec2& size)
    : albedo(texture("subpixels apart", size, GL_RGBA16F)),
      place(texture("places of subpixels apart", size, GL_RGBA32F)),
      normal(texture("normals of subpixels apart", size, GL_RG16)),
      light(texture("light of subpixels apart", size, GL_RGBA32F)) {}

SubpixelBuffer::SubpixelBuffer(const glm::ivec2& size, bool hasApart)
    : emission(texture("subpixel emission", size, GL_RGBA32F)),
      own(texture("own subpixels", size, GL_RGBA16F)),
      first(texture("first subpixels", size, GL_RGBA16F)),
      second(texture("second subpixels", size, GL_RGBA16F)) {
  if (hasApart) apart.emplace(size);
}

GpuTask SubpixelPass::run(SubpixelBuffer& buffer, const Gbuffer& middles, const EmitterBuffer& seenLights,
                          const FrameRows& request, const Scene& scene, const SceneResources& resources,
                          const MeshDrawer& drawer, const gpu::Buffer& frameParams, const GpuOccluders* haze,
                          Pacing pacing) {
  const glm::ivec2 size = request.size;
  const int height = std::clamp(kSampledPixels / size.x, 1, size.y);
  Rows rows({size.x, height}, PaneRenderer::needed(request, scene));
  const FrameView view(request);
  gpu::Buffer sampleParams("sample params", sizeof(layout::FrameParams), gpu::BufferUse::kDynamic);
  gpu::Buffer subpixelParams("subpixel params", sizeof(layout::SubpixelParams), gpu::BufferUse::kDynamic);
  gpu::Program& add =
      add_.get({.panes = rows.panes.has_value(), .haze = haze != nullptr, .apart = buffer.apart.has_value()});
  for (int row = 0; row < size.y; row += height) {
    for (int i = 0; i < request.samples; ++i) {
      const glm::vec2 offset = offsetOf(i, request.samples);
      layout::FrameParams drawn{};
      drawn.samples = request.samples;
      drawn.clipFromEye = view.clipFromEye(glm::dvec2(offset), row, height);
      sampleParams.update(0, gpu::bytesOfValue(drawn));
      co_await gbuffer_.run(rows.gbuffer, request, scene, resources, drawer, sampleParams, pacing);
      co_await emitters_.run(rows.emitters, request, scene, resources, drawer, sampleParams, pacing);
      if (rows.panes) {
        co_await panes_.run(*rows.panes, rows.gbuffer, rows.emitters, request, scene, resources, drawer, sampleParams,
                            pacing);
      }
      gpu::memoryBarrier();
      layout::SubpixelParams params{};
      params.offset = offset;
      params.sampleIndex = i;
      params.samples = request.samples;
      params.firstRow = row;
      subpixelParams.update(0, gpu::bytesOfValue(params));
      frameParams.bindUniform(layout::kParams);
      subpixelParams.bindUniform(layout::kSubpixelParams);
      middles.normal.bind(layout::kNormal);
      middles.depth.bind(layout::kSurfaceDepth);
      seenLights.depth.bind(layout::kEmitterDepth);
      rows.gbuffer.albedo.bind(layout::kSampleAlbedo);
      rows.gbuffer.normal.bind(layout::kSampleNormal);
      rows.gbuffer.depth.bind(layout::kSampleDepth);
      rows.emitters.emission.bind(layout::kSampleEmission);
      rows.emitters.depth.bind(layout::kSampleEmitterDepth);
      if (rows.panes) rows.panes->share.bind(layout::kPanes);
      if (haze != nullptr) haze->bind();
      buffer.emission.bindImage(layout::kSubpixelEmissionOut, GL_READ_WRITE);
      buffer.own.bindImage(layout::kSubpixelOwnOut, GL_READ_WRITE);
      buffer.first.bindImage(layout::kSubpixelFirstOut, GL_READ_WRITE);
      buffer.second.bindImage(layout::kSubpixelSecondOut, GL_READ_WRITE);
      if (buffer.apart) {
        buffer.apart->albedo.bindImage(layout::kSubpixelApartOut, GL_READ_WRITE);
        buffer.apart->place.bindImage(layout::kApartPlaceOut, GL_WRITE_ONLY);
        buffer.apart->normal.bindImage(layout::kApartNormalOut, GL_WRITE_ONLY);
      }
      const glm::ivec2 tiles = (glm::ivec2(size.x, height) + layout::kNearFieldTile - 1) / layout::kNearFieldTile;
      add.dispatch(std::uint32_t(tiles.x), std::uint32_t(tiles.y));
      co_yield submitted(Stage::kShade, double(size.x) * height);
    }
  }
  gpu::memoryBarrier();
}

}  // namespace lpv
