#include "lpv/frame/subpixels.h"

#include <algorithm>

#include "gpu/gl.h"
#include "lpv/frame/parts.h"

namespace lpv {

namespace {

/// Pixels that are sampled at a time: 40 to 48 bytes each, and 350 where they are lit apart.
constexpr int kSampledPixels = 1 << 20;
constexpr int kSampledPixelsApart = 1 << 18;
/// Rows beside, whose places apart are looked at: whole blocks of pixels, so that each sends the rays that it would
/// send in one go.
constexpr int kRowsBeside = layout::kNearFieldTile;
static_assert(kRowsBeside % layout::kNearFieldBlockY == 0);

/// Places apart of a pixel: frames of a window, what they hide and what is behind all of it may meet in one. 44 bytes
/// each.
constexpr int kApartPlaces = 8;
constexpr int kMostApartWidth = 1 << 14;  // of their pictures together: what an OpenGL 4.5 has

glm::ivec2 sizeOfPlaces(const glm::ivec2& size) {
  return {size.x * std::clamp(kMostApartWidth / size.x, 1, kApartPlaces), size.y};
}

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

void dispatchTiles(gpu::Program& program, const glm::ivec2& pixels) {
  const glm::ivec2 tiles = partsOf(pixels, kTile);
  program.dispatch(std::uint32_t(tiles.x), std::uint32_t(tiles.y));
}

layout::SubpixelParams paramsOf(const SampledRows& rows) {
  layout::SubpixelParams params{};
  params.firstRow = rows.firstSampled;
  params.firstWanted = rows.first;
  params.endWanted = rows.end;
  return params;
}

}  // namespace

SubpixelBuffer::SubpixelBuffer(const glm::ivec2& size, bool isApart)
    : apart(isApart), radiance(texture("subpixel radiance", size, GL_RGBA32F)) {
  if (apart) return;
  own = texture("own subpixels", size, GL_RGBA16F);
  first = texture("first subpixels", size, GL_RGBA16F);
  second = texture("second subpixels", size, GL_RGBA16F);
}

ApartBuffer::ApartBuffer(const glm::ivec2& size)
    : albedo(texture("albedo apart", sizeOfPlaces(size), GL_RGBA16F)),
      place(texture("places apart", sizeOfPlaces(size), GL_RGBA32F)),
      normal(texture("normals apart", sizeOfPlaces(size), GL_RG16)),
      light(texture("light apart", sizeOfPlaces(size), GL_RGBA32F)) {}

SampleBuffer::SampleBuffer(const glm::ivec2& size, bool seesPanes, bool isApart)
    : gbuffer(size),
      emitters(size),
      drawnParams("sample params", sizeof(layout::FrameParams), gpu::BufferUse::kDynamic) {
  if (seesPanes) panes.emplace(size);
  if (isApart) apart.emplace(size);
}

std::vector<SampledRows> sampledRows(const glm::ivec2& size, bool apart) {
  const int beside = apart ? kRowsBeside : 0, pixels = apart ? kSampledPixelsApart : kSampledPixels;
  const int step = std::max(pixels / size.x / kRowsBeside, 1) * kRowsBeside;
  std::vector<SampledRows> out;
  for (int row = 0; row < size.y; row += step) {
    const int end = std::min(row + step, size.y), from = std::max(row - beside, 0);
    out.push_back({row, end, from, std::min(end + beside, size.y) - from});
  }
  return out;
}

void SubpixelPass::begin(const SubpixelBuffer& buffer) {
  for (const gpu::Texture* sum : {&buffer.radiance, &buffer.own, &buffer.first, &buffer.second}) {
    if (*sum) sum->fill(glm::vec4(0.0F));
  }
}

void SubpixelPass::bind(const SubpixelBuffer& buffer, const SampleBuffer& samples,
                        const SubpixelSources& sources) const {
  sources.frameParams.bindUniform(layout::kParams);
  params_.bindUniform(layout::kSubpixelParams);
  sources.middles.normal.bind(layout::kNormal);
  sources.middles.depth.bind(layout::kSurfaceDepth);
  sources.seenLights.depth.bind(layout::kEmitterDepth);
  samples.gbuffer.albedo.bind(layout::kSampleAlbedo);
  samples.gbuffer.normal.bind(layout::kSampleNormal);
  samples.gbuffer.depth.bind(layout::kSampleDepth);
  samples.emitters.emission.bind(layout::kSampleEmission);
  samples.emitters.depth.bind(layout::kSampleEmitterDepth);
  if (samples.panes) samples.panes->share.bind(layout::kPanes);
  if (sources.haze != nullptr) sources.haze->bind();
  buffer.radiance.bindImage(layout::kSubpixelRadianceOut, GL_READ_WRITE);
  if (samples.apart) {
    sources.light->bind(layout::kNearField);
    if (sources.gloss != nullptr) sources.gloss->bind(layout::kGloss);
    if (sources.shine != nullptr) sources.shine->bind(layout::kHaze);
    samples.apart->albedo.bindImage(layout::kApartAlbedoOut, GL_READ_WRITE);
    samples.apart->place.bindImage(layout::kApartPlaceOut, GL_READ_WRITE);
    samples.apart->normal.bindImage(layout::kApartNormalOut, GL_READ_WRITE);
  } else {
    buffer.own.bindImage(layout::kSubpixelOwnOut, GL_READ_WRITE);
    buffer.first.bindImage(layout::kSubpixelFirstOut, GL_READ_WRITE);
    buffer.second.bindImage(layout::kSubpixelSecondOut, GL_READ_WRITE);
  }
}

GpuTask SubpixelPass::sample(SubpixelBuffer& buffer, SampleBuffer& samples, const SampledRows& rows,
                             const SubpixelSources& sources, Pacing pacing) {
  const FrameRows& request = sources.request;
  const FrameView view(request);
  const int height = samples.gbuffer.target.size().y;
  const Scene& scene = sources.scene;
  const SceneResources& resources = sources.resources;
  const MeshDrawer& drawer = sources.drawer;
  layout::SubpixelParams params = paramsOf(rows);
  params.samples = request.samples;
  const bool apart = samples.apart.has_value();
  gpu::Program& add =
      add_.get({.panes = samples.panes.has_value(),
                .apart = apart,
                .shown = {.gloss = apart && sources.gloss != nullptr, .haze = sources.haze != nullptr}});
  if (samples.apart) samples.apart->albedo.fill(glm::vec4(0.0F));
  for (int i = 0; i < request.samples; ++i) {
    params.offset = offsetOf(i, request.samples);
    layout::FrameParams drawn{};
    drawn.samples = request.samples;
    drawn.clipFromEye = view.clipFromEye(glm::dvec2(params.offset), rows.firstSampled, height);
    samples.drawnParams.update(0, gpu::bytesOfValue(drawn));
    co_await gbuffer_.run(samples.gbuffer, request, scene, resources, drawer, samples.drawnParams, pacing);
    co_await emitters_.run(samples.emitters, request, scene, resources, drawer, samples.drawnParams, pacing);
    if (samples.panes) {
      co_await panes_.run(*samples.panes, samples.gbuffer, samples.emitters, request, scene, resources, drawer,
                          samples.drawnParams, pacing);
    }
    gpu::memoryBarrier();
    params_.update(0, gpu::bytesOfValue(params));
    bind(buffer, samples, sources);
    dispatchTiles(add, {request.size.x, rows.sampled});
    co_yield submitted(Stage::kShade, double(request.size.x) * rows.sampled);
  }
  gpu::memoryBarrier();
}

GpuTask SubpixelPass::sumApart(SubpixelBuffer& buffer, const ApartBuffer& apart, const SampledRows& rows,
                               const SubpixelSources& sources) {
  layout::SubpixelParams params = paramsOf(rows);
  params.rays = std::max(sources.rays, 1);
  params_.update(0, gpu::bytesOfValue(params));
  sources.frameParams.bindUniform(layout::kParams);
  params_.bindUniform(layout::kSubpixelParams);
  apart.albedo.bind(layout::kApartAlbedo);
  apart.place.bind(layout::kApartPlace);
  apart.normal.bind(layout::kApartNormal);
  apart.light.bind(layout::kApartLight);
  if (sources.gloss != nullptr) sources.gloss->bind(layout::kGloss);
  if (sources.shine != nullptr) sources.shine->bind(layout::kHaze);
  if (sources.haze != nullptr) sources.haze->bind();
  buffer.radiance.bindImage(layout::kSubpixelRadianceOut, GL_READ_WRITE);
  const glm::ivec2 pixels(sources.request.size.x, rows.end - rows.first);
  dispatchTiles(sum_.get({.gloss = sources.gloss != nullptr, .haze = sources.haze != nullptr}), pixels);
  gpu::memoryBarrier();
  co_yield submitted(Stage::kShade, double(pixels.x) * pixels.y);
}

}  // namespace lpv
