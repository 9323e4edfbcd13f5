#include "lpv/pipeline_stages.h"

namespace lpv {

namespace {

/// Frames of a stream look at lights of many triangles with .7 of k, at half the price. Irradiance around a statue of
/// 33,446 triangles is .31 % off then, .16 % with all of k (k = 2), and points between are interpolated at 3 %.
constexpr float kOpeningShareOfStreams = 0.7F;

/// What each pool of lights, and last what surfaces reflect, sends to a view is made from; empty where no picture of
/// each is kept.
std::vector<PoolPictureInputs> poolPictures(const SessionState& s, const Scene& scene, const FrameRequest& frame,
                                            const View& view) {
  const StageProducts& made = *s.products;
  const std::size_t count = made.pools.pools.size() + (made.reflecting() != nullptr ? 1 : 0);
  if (!frame.reduced || !s.looksAtLights || !keepsPools(frame.size, count)) return {};
  PoolPictureInputs shared;
  shared.picture = view.gbuffer->shown.stamp();
  shared.blockers = made.occluders.surfaces();
  shared.grid = s.memory.product()->grid;
  shared.openingRatio = scene.options.openingRatio();
  shared.turns = s.shadowed ? shadowTurns(frame, scene.options) : 0;
  std::vector<PoolPictureInputs> out;
  for (const LightPool& pool : made.pools.pools) {
    PoolPictureInputs& inputs = out.emplace_back(shared);
    for (int i = pool.firstLight; i < pool.lightsEnd; ++i) inputs.lights.push_back(lookedAt(s.lights[std::size_t(i)]));
  }
  if (made.reflecting() == nullptr) return out;
  PoolPictureInputs& reflected = out.emplace_back(shared);
  reflected.reflected = made.reflected.stamp();
  reflected.turns = s.reflectionsBlocked ? reflectedTurns(frame, scene.options) : 0;
  return out;
}

/// Larger pictures are made in bands of so many pixels: some 100 bytes each, and 50 more with shadows.
constexpr int kMostPixelsAtOnce = 1 << 21;
constexpr int kBandPixels = 1 << 20;
/// Rows of a band and beside it, which pixels look at: whole blocks of those that decide together
/// (frame/shadow_rays.comp), so that each has the light that it would have in one go.
constexpr int kBesideBand = layout::kNearFieldTile;
static_assert(kBesideBand % layout::kNearFieldBlockY == 0 && kBesideBand > 4);

/// The rows from `row` on, with those beside them.
FrameRows bandOf(const FrameRequest& frame, int row, int rows) {
  FrameRows band(frame);
  band.firstRow = std::max(0, row - kBesideBand);
  band.size.y = std::min(frame.size.y, row + rows + kBesideBand) - band.firstRow;
  return band;
}

/// Another buffer where the one that is there has another size; first the old memory goes.
template <typename Buffer>
void keepSize(std::unique_ptr<Buffer>& buffer, const glm::ivec2& size) {
  if (buffer != nullptr && buffer->size == size) return;
  buffer = nullptr;
  buffer = std::make_unique<Buffer>(size);
}

/// Light of all surfaces has no edges as fine as this, radians, but those of what is seen, where every pixel looks.
constexpr double kLatticeAngle = 4e-3;

/// Pixels from one that looks at what surfaces reflect to the next.
int latticeOf(const FrameRows& frame) {
  const double heights = frame.camera.clipFromView(1.0)[1][1];  // of the picture, in half its distance
  return 2.0 / (heights * frame.pictureHeight) <= kLatticeAngle ? 2 : 1;
}

/// Samples apart are a part of their pixel: half of the rays tell as much of it, and a quarter of those all around.
ShadowCasters castersForApart(ShadowCasters all) {
  for (int* turns : {&all.turns, &all.reflectedTurns}) *turns = (*turns + 1) / 2;
  all.foldTurns = all.foldTurns > 0 ? std::max(all.foldTurns / 4, 1) : 0;
  return all;
}

}  // namespace

bool looksApart(const SessionState& s, const FrameRequest& frame) {
  return frame.samples > 1 && !frame.reduced && frame.quantity == FrameQuantity::kRadiance && !s.lights.empty() &&
         s.memory.product()->transport != Transport::kPropagate;
}

bool drawnInBands(const FrameRequest& frame) {
  const bool exposedAsAWhole = frame.format == PixelFormat::kRgb8 && frame.exposure.automatic;
  return frame.view == 0 && !frame.reduced && !exposedAsAWhole && frame.size.x * frame.size.y > kMostPixelsAtOnce;
}

ShadowCasters Pipeline::Stages::shadowCasters(const SessionState& s, const Scene& scene, const FrameRows& frame) const {
  const StageProducts& made = *s.products;
  const int turns = shadowTurns(frame, scene.options);
  return {&made.pools,
          &made.occluders,
          s.shadowed ? turns : 0,
          made.reflecting(),
          s.reflectionsBlocked ? reflectedTurns(frame, scene.options) : 0,
          frame.reduced ? 0 : foldTurns(scene.options)};
}

GpuTask Pipeline::Stages::lookAtLights(SessionState& s, const Scene& scene, const FrameRows& frame, View& view) {
  keepSize(view.nearField, frame.size);
  const StageProducts& made = *s.products;
  const ShadowCasters shadows = shadowCasters(s, scene, frame);
  const bool inTheWay = s.shadowed || s.bounces.turns > 0;
  const NearFieldSources sources = {{&made.emitters, s.looksAtLights ? nullptr : &s.field().textures->emitterDistance},
                                    inTheWay ? &shadows : nullptr,
                                    frame.reduced,
                                    latticeOf(frame),
                                    frame.firstRow,
                                    inTheWay ? poolPictures(s, scene, frame, view) : std::vector<PoolPictureInputs>()};
  co_await nearFieldPass.run(*view.nearField, *view.gbuffer, view.targets->emitters, sources, view.targets->frameParams,
                             pacing(s));
}

GpuTask Pipeline::Stages::reflectLikeMirrors(SessionState& s, const Scene& scene, const FrameRows& frame, View& view) {
  if (!s.glossy || frame.quantity == FrameQuantity::kIrradiance) {
    view.gloss = nullptr;
    co_return;
  }
  keepSize(view.gloss, frame.size);
  const StageProducts& made = *s.products;
  ShadowCasters shadows = shadowCasters(s, scene, frame);
  shadows.turns = (shadows.turns + layout::kGlossPlaces - 1) / layout::kGlossPlaces;
  const GlossSources sources = {made.glossScene,
                                made.finePools,
                                made.emitters,
                                shadows,
                                glossTurns(frame, scene.options),
                                s.shadowed,
                                frame.reduced ? layout::kGlossReach : 1,
                                frame.firstRow};
  co_await glossPass.run(*view.gloss, *view.gbuffer, view.targets->emitters, sources, view.targets->frameParams,
                         pacing(s));
}

GpuTask Pipeline::Stages::scatter(SessionState& s, const Scene& scene, const FrameRows& frame, View& view) {
  const LightingSettings& options = scene.options;
  if (options.haze == 0.0 || s.lights.empty() || frame.quantity == FrameQuantity::kIrradiance) {
    view.haze = nullptr;
    co_return;
  }
  keepSize(view.haze, frame.size);
  const StageProducts& made = *s.products;
  const Grid& grid = s.field().grid;
  const HazeSources sources = {s.lights,
                               made.finePools,
                               made.glossScene,
                               made.emitters,
                               made.occluders,
                               made.reflecting(),
                               grid.dims,
                               options.haze * (1.0 - options.hazeAbsorption) * grid.cell,
                               options.hazeAnisotropy,
                               hazeTurns(frame, options),
                               frame.firstRow,
                               PaneRenderer::needed(frame, scene)};
  co_await hazePass.run(*view.haze, *view.gbuffer, view.targets->emitters, sources, view.targets->frameParams,
                        pacing(s));
}

GpuTask Pipeline::Stages::drawPanes(SessionState& s, const Scene& scene, const FrameRows& frame, View& view) {
  if (frame.samples > 1 || !PaneRenderer::needed(frame, scene)) {
    view.panes = nullptr;
    co_return;
  }
  if (view.panes == nullptr || view.panes->target.size() != frame.size) {
    view.panes = nullptr;
    view.panes = std::make_unique<PaneBuffer>(frame.size);
  }
  co_await paneRenderer.run(*view.panes, *view.gbuffer, view.targets->emitters, frame, scene, s.resources, drawer,
                            view.targets->frameParams, pacing(s));
}

GpuTask Pipeline::Stages::drawSubpixels(SessionState& s, const Scene& scene, const FrameRows& frame, View& view) {
  if (frame.samples == 1) {
    view.subpixels = nullptr;
    co_return;
  }
  const bool apart = looksApart(s, frame);
  if (view.subpixels == nullptr || view.subpixels->size() != frame.size || view.subpixels->apart != apart) {
    view.subpixels = nullptr;
    view.subpixels = std::make_unique<SubpixelBuffer>(frame.size, apart);
  }
  SubpixelBuffer& buffer = *view.subpixels;
  const GpuOccluders& occluders = s.products->occluders;
  const GpuOccluders* haze = scene.options.haze > 0.0 ? &occluders : nullptr;
  SubpixelInputs inputs = {view.gbuffer->shown.stamp(), {}, frame.samples, haze != nullptr ? occluders.surfaces() : 0};
  for (const auto& [name, light] : scene.lights) inputs.lights.push_back(light);
  if (!apart && buffer.shown.holds(inputs)) co_return;
  const gpu::Buffer& frameParams = view.targets->frameParams;
  const ShadowCasters shadows = castersForApart(shadowCasters(s, scene, frame));
  const SubpixelSources sources = {.middles = *view.gbuffer,
                                   .seenLights = view.targets->emitters,
                                   .request = frame,
                                   .scene = scene,
                                   .resources = s.resources,
                                   .drawer = drawer,
                                   .frameParams = frameParams,
                                   .haze = haze,
                                   .light = apart ? &view.nearField->irradiance : nullptr,
                                   .shine = view.haze != nullptr ? &view.haze->scattered : nullptr,
                                   .gloss = view.gloss != nullptr ? &view.gloss->gloss : nullptr,
                                   .rays = 4 * std::max(shadows.turns, shadows.reflectedTurns)};
  const std::vector<SampledRows> parts = sampledRows(frame.size, apart);
  int height = 0;
  for (const SampledRows& rows : parts) height = std::max(height, rows.sampled);
  SampleBuffer samples({frame.size.x, height}, PaneRenderer::needed(frame, scene), apart);
  SubpixelPass::begin(buffer);
  for (const SampledRows& rows : parts) {
    co_await subpixelPass.sample(buffer, samples, rows, sources, pacing(s));
    if (!samples.apart) continue;
    const ApartPlaces places = {*samples.apart, frameParams, frame.firstRow + rows.firstSampled};
    co_await nearFieldPass.lookFromApart(*view.nearField, places, s.products->emitters, shadows, pacing(s));
    co_await subpixelPass.sumApart(buffer, *samples.apart, rows, sources);
  }
  buffer.shown.set(std::move(inputs));
}

GpuTask Pipeline::Stages::drawFrame(SessionState& s, const Scene& scene, const FrameRows& frame, View& view) {
  if (view.targets == nullptr || !view.targets->fits(frame)) {
    view.targets = nullptr;
    view.targets = std::make_unique<FrameTargets>(frame.size, frame.format, frame.exposure.automatic);
  }
  if (view.gbuffer == nullptr || view.gbuffer->target.size() != frame.size ||
      bool(view.gbuffer->material) != s.glossy) {
    view.gbuffer = nullptr;
    view.gbuffer = std::make_unique<Gbuffer>(frame.size, s.glossy);
  }
  layout::FrameParams params = FrameView(frame).params(s.field().grid);
  params.palette = glm::vec3(s.palette().radiance[0]);
  params.samples = frame.samples;
  params.openingShare = frame.reduced ? kOpeningShareOfStreams : 1.0F;
  params.exposure = exposureParams(frame.exposure);
  FrameTargets& targets = *view.targets;
  targets.frameParams.update(0, gpu::bytesOfValue(params));

  Gbuffer& gbuffer = *view.gbuffer;
  const GpuOccluders& occluders = s.products->occluders;
  GbufferInputs shown = gbufferInputs(frame, scene);
  if (s.reflectionsBlocked || s.glossy) shown.blockers = occluders.surfaces();
  if (!gbuffer.shown.holds(shown)) {
    co_await gbufferRenderer.run(gbuffer, frame, scene, s.resources, drawer, targets.frameParams, pacing(s));
    if (shown.blockers != 0) co_await buriedPass.run(gbuffer, occluders, targets.frameParams, pacing(s));
    gbuffer.shown.set(shown);
  }
  co_await emitterRenderer.run(targets.emitters, frame, scene, s.resources, drawer, targets.frameParams, pacing(s));
  co_await drawPanes(s, scene, frame, view);
  const LightField& field = s.field();
  const bool sampled =
      s.shadowed || s.bounces.turns > 0 || (frame.reduced && field.transport == Transport::kGather && !s.looksAtLights);
  if (sampled) co_await lookAtLights(s, scene, frame, view);
  co_await reflectLikeMirrors(s, scene, frame, view);
  co_await scatter(s, scene, frame, view);
  IrradianceSources lit = {.transport = field.transport,
                           .lookup = scene.options.lookup,
                           .volume = s.looksAtLights ? nullptr : &*field.textures,
                           .emitters = &s.products->emitters,
                           .nearField = sampled ? &view.nearField->irradiance : nullptr};
  if (!sampled && looksApart(s, frame)) {
    keepSize(view.nearField, frame.size);
    co_await shadingPass.findIrradiance(view.nearField->irradiance, targets, gbuffer, lit, pacing(s));
    lit.nearField = &view.nearField->irradiance;
    lit.volume = nullptr;  // all is known
  }
  co_await drawSubpixels(s, scene, frame, view);
  lit.panes = view.panes != nullptr ? &view.panes->share : nullptr;
  lit.gloss = view.gloss != nullptr ? &view.gloss->gloss : nullptr;
  lit.haze = view.haze.get();
  lit.hazeBox = &s.products->occluders;
  lit.subpixels = view.subpixels.get();
  co_await shadingPass.run(targets, gbuffer, lit, frame, pacing(s));
}

GpuTask Pipeline::Stages::drawBands(SessionState& s, const Scene& scene, const FrameRequest& frame, View& view,
                                    FramePtr& out) {
  const int step = std::max(kBandPixels / frame.size.x / kBesideBand, 1) * kBesideBand;
  const std::shared_ptr<Frame> picture = emptyFrame(frame);
  for (int row = 0; row < frame.size.y; row += step) {
    const FrameRows band = bandOf(frame, row, step);
    co_await drawFrame(s, scene, band, view);
    const gpu::Fence drawn = gpu::Fence::insert();
    co_yield waitFor(drawn);
    co_await copyFrame(view, pacing(s));
    const gpu::Fence copied = gpu::Fence::insert();
    co_yield submitted(Stage::kReadback, 0.0);
    co_yield waitFor(copied);
    co_await takeRows(view, row - band.firstRow, std::min(step, frame.size.y - row), *picture);
  }
  out = picture;
}

}  // namespace lpv
