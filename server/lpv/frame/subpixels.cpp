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

/// Of so many more: the mirror image of as many evenly spread ones, which with the others is spread best. An edge's
/// share is off by .022 in the mean with 32 samples, by .015 with 16 of these, and by .013 with all 32.
glm::vec2 offsetOfMore(int sample, int samples) { return glm::vec2(-1.0F, 1.0F) * offsetOf(sample, samples); }

/// The pixels of some rows that a part of the picture meets, in whole tiles.
PixelRange pixelsOf(const PicturePart& part, const glm::ivec2& size, const SampledRows& rows) {
  const glm::dvec2 low = 0.5 * (glm::dvec2(part.low.x, -part.high.y) + 1.0) * glm::dvec2(size) - 1.0;
  const glm::dvec2 high = 0.5 * (glm::dvec2(part.high.x, -part.low.y) + 1.0) * glm::dvec2(size) + 1.0;
  const glm::ivec2 first(0, rows.firstSampled), end(size.x, rows.firstSampled + rows.sampled);
  const glm::ivec2 from(glm::floor(glm::clamp(low, glm::dvec2(first), glm::dvec2(end))));
  const glm::ivec2 to(glm::ceil(glm::clamp(high, glm::dvec2(first), glm::dvec2(end))));
  return {from - first, glm::min(kTile * partsOf(to - from, kTile), end - from)};
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
  if (apart) {
    lights = texture("subpixel lights", size, GL_RGBA32F);
    return;
  }
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
  if (!isApart) return;
  apart.emplace(size);
  depth = gpu::Framebuffer("depth of samples", {}, &gbuffer.depth);
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
  for (const gpu::Texture* sum : {&buffer.radiance, &buffer.lights, &buffer.own, &buffer.first, &buffer.second}) {
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
    buffer.lights.bindImage(layout::kSubpixelLightsOut, GL_READ_WRITE);
  } else {
    buffer.own.bindImage(layout::kSubpixelOwnOut, GL_READ_WRITE);
    buffer.first.bindImage(layout::kSubpixelFirstOut, GL_READ_WRITE);
    buffer.second.bindImage(layout::kSubpixelSecondOut, GL_READ_WRITE);
  }
}

SubpixelPass::LitPart SubpixelPass::litPart(const SampledRows& rows, const SubpixelSources& sources) {
  const PicturePart lights = partOfLights(sources.request, sources.scene);
  return {pixelsOf(lights, sources.request.size, rows),
          surfacesIn(lights, sources.request, sources.scene, sources.resources)};
}

GpuTask SubpixelPass::draw(SampleBuffer& samples, const SampledRows& rows, const SubpixelSources& sources,
                           const glm::vec2& offset, const LitPart* lights, Pacing pacing) {
  const FrameRows& request = sources.request;
  const Scene& scene = sources.scene;
  const SceneResources& resources = sources.resources;
  const MeshDrawer& drawer = sources.drawer;
  layout::FrameParams drawn{};
  drawn.samples = request.samples;
  drawn.clipFromEye =
      FrameView(request).clipFromEye(glm::dvec2(offset), rows.firstSampled, samples.gbuffer.target.size().y);
  samples.drawnParams.update(0, gpu::bytesOfValue(drawn));
  if (lights != nullptr) {
    co_await gbuffer_.runDepth(samples.depth, lights->pixels, lights->surfaces, drawer, samples.drawnParams, pacing);
    co_await emitters_.run(samples.emitters, request, scene, resources, drawer, samples.drawnParams, pacing,
                           lights->pixels);
  } else {
    co_await gbuffer_.run(samples.gbuffer, request, scene, resources, drawer, samples.drawnParams, pacing);
    co_await emitters_.run(samples.emitters, request, scene, resources, drawer, samples.drawnParams, pacing);
  }
  if (samples.panes) {
    co_await panes_.run(*samples.panes, samples.gbuffer, samples.emitters, request, scene, resources, drawer,
                        samples.drawnParams, pacing);
  }
  gpu::memoryBarrier();
}

GpuTask SubpixelPass::sample(SubpixelBuffer& buffer, SampleBuffer& samples, const SampledRows& rows,
                             const SubpixelSources& sources, Pacing pacing) {
  const FrameRows& request = sources.request;
  layout::SubpixelParams params = paramsOf(rows);
  params.samples = request.samples;
  const bool apart = samples.apart.has_value();
  gpu::Program& add =
      add_.get({.panes = samples.panes.has_value(),
                .apart = apart,
                .shown = {.gloss = apart && sources.gloss != nullptr, .haze = sources.haze != nullptr}});
  if (samples.apart) samples.apart->albedo.fill(glm::vec4(0.0F));
  const LitPart lit = apart ? litPart(rows, sources) : LitPart();
  const PixelRange whole = {glm::ivec2(0), {request.size.x, rows.sampled}};
  const int more = lit.pixels.size.x > 0 && lit.pixels.size.y > 0 ? request.samples / 2 : 0;
  params.samplesOfLights = request.samples + more;
  for (int i = 0; i < params.samplesOfLights; ++i) {
    const bool ofLights = i >= request.samples;
    const PixelRange& pixels = ofLights ? lit.pixels : whole;
    params.ofLights = ofLights ? 1 : 0;
    params.begin = pixels.begin;
    params.offset = ofLights ? offsetOfMore(i - request.samples, more) : offsetOf(i, request.samples);
    co_await draw(samples, rows, sources, params.offset, ofLights ? &lit : nullptr, pacing);
    params_.update(0, gpu::bytesOfValue(params));
    bind(buffer, samples, sources);
    dispatchTiles(add, pixels.size);
    co_yield submitted(Stage::kShade, double(pixels.size.x) * pixels.size.y);
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
  buffer.lights.bindImage(layout::kSubpixelLightsOut, GL_READ_ONLY);
  const glm::ivec2 pixels(sources.request.size.x, rows.end - rows.first);
  dispatchTiles(sum_.get({.gloss = sources.gloss != nullptr, .haze = sources.haze != nullptr}), pixels);
  gpu::memoryBarrier();
  co_yield submitted(Stage::kShade, double(pixels.x) * pixels.y);
}

}  // namespace lpv
