#include "lpv/pipeline.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include "gpu/failure.h"
#include "lpv/frame/draw.h"
#include "lpv/frame/emitters.h"
#include "lpv/frame/gbuffer.h"
#include "lpv/frame/near_field.h"
#include "lpv/frame/panes.h"
#include "lpv/frame/shading.h"
#include "lpv/readback.h"
#include "lpv/resources/scene_cache.h"
#include "lpv/tick_report.h"
#include "lpv/transport/bounces.h"
#include "lpv/transport/emitter_list.h"
#include "lpv/transport/gather.h"
#include "lpv/transport/inject.h"
#include "lpv/transport/propagate.h"
#include "lpv/transport/volume.h"
#include "lpv/voxelize/voxelize.h"

namespace lpv {

namespace {

/// A piece is aimed at this share of what it may take: predictions are not exact.
constexpr double kAim = 0.6;

/// What the counters count.
struct CountInputs {
  Stamp lights = 0;    ///< begins with zeros
  Stamp textured = 0;  ///< clamped cells; a volume's are read with the volume

  bool operator==(const CountInputs&) const = default;
};

/// Frames that look at triangles take them as they are: they are put into the grid for those who look at volumes only.
bool needsVoxels(const SessionState& s, const EmittingLight& light, const TickRequest& request) {
  return !s.looksAtLights || !(light.polygons || light.tree) || request.transported || request.injected;
}

/// Where each frame of a tick is made: kept views in the session, others here for the tick.
struct FrameViews {
  FrameViews(SessionState& session, const TickRequest& request) {
    for (const FrameRequest& frame : request.frames) {
      View* view = frame.view != 0 ? &session.views[frame.view] : nullptr;
      if (view == nullptr || std::find(of.begin(), of.end(), view) != of.end())
        view = unkept.emplace_back(std::make_unique<View>()).get();
      of.push_back(view);
    }
  }
  std::vector<View*> of;  ///< per frame
  std::vector<std::unique_ptr<View>> unkept;
};

/// Of four shadow rays from a pixel to each pool of lights: by settings alone, and fewer in streams.
int shadowTurns(const LightingSettings& options) { return options.quality == Quality::kAccurate ? 16 : 8; }
int shadowTurns(const FrameRequest& frame, const LightingSettings& options) {
  return frame.reduced ? shadowTurns(options) / 2 : shadowTurns(options);
}

std::size_t patchesWanted(const LightingSettings& options) {
  return options.quality == Quality::kAccurate ? kAccuratePatches : kFastPatches;
}

/// Volumes alone hold direct light.
bool readsReflections(const TickRequest& request) {
  return !request.frames.empty() || (request.transported && request.probed);
}

/// Light that has arrived in cells, as volumes are made from it.
struct Transported {
  const FieldBuffer& field;
  Stamp stamp;
};

/// What the patches, and what they exchange, are made from.
struct PatchInputs {
  std::vector<SurfacePtr> surfaces;
  Grid grid;
  std::size_t count = 0;
  Stamp blockers = 0;

  bool operator==(const PatchInputs&) const = default;
};

/// What patches send.
struct ReflectInputs {
  Stamp patches = 0;
  Stamp lights = 0;
  Stamp list = 0;  ///< of emitters
  Stamp blockers = 0;
  int bounces = 0;
  int turns = 0;   ///< of shadow rays

  bool operator==(const ReflectInputs&) const = default;
};

/// What an injected volume that leaves the engine is made from.
struct InjectedVolumeInputs {
  InjectInputs injected;
  bool guarded = false;  ///< guard cells go along

  bool operator==(const InjectedVolumeInputs&) const = default;
};

/// Volumes whose copies are under way, by what they are made from.
struct VolumeCopies {
  std::optional<VolumeInputs> transported;
  bool probed = false;  ///< Volume::probed
  std::optional<InjectedVolumeInputs> injected;

  bool any() const { return transported || injected; }
};

}  // namespace

/// Of one session. What has no product here describes memory: of the field, or of the list of emitters.
struct StageProducts {
  Cached<InjectInputs> injected;  ///< PROPAGATE
  Cached<PropagateInputs> propagated;
  Cached<GatherInputs, ReceiverBlocks> gathered;  ///< the blocks that are
  Cached<SurfaceBlocksInputs, ReceiverBlocks> surfaceBlocks;
  Cached<EmitterListInputs> listed;
  EmitterBufferList emitters;
  Cached<Stamp> pooled;  ///< of the lights
  LightPools pools;
  LightPointCache lightPoints;
  GpuOccluders occluders;
  CellVisibilities cellVisibilities;
  Cached<PatchInputs, std::unique_ptr<PatchSet>> patches;  ///< with what they exchange
  Cached<ReflectInputs> reflected;
  /// Patches that send light, or null.
  const PatchSet* reflecting() const { return reflected.stamp() != 0 ? patches.product().get() : nullptr; }
  Cached<VolumeInputs> textured;
  Cached<VolumeInputs, VolumePtr> transportedVolume;
  Cached<InjectedVolumeInputs, VolumePtr> injectedVolume;
  Cached<InjectInputs> counting;  ///< GATHER, DIRECT
  Cached<CountInputs, layout::Counters> counts;
  Readbacks readbacks;
};

struct Pipeline::Stages {
  explicit Stages(double seconds) : pieceSeconds(seconds) {}

  double pieceSeconds;
  SceneCache cache;
  Voxelizer voxelizer;
  Injector injector;
  Propagator propagator;
  Gatherer gatherer;
  BouncePass bouncePass;
  VolumeMaker volumeMaker;
  MeshDrawer drawer;
  GbufferRenderer gbufferRenderer;
  EmitterRenderer emitterRenderer;
  PaneRenderer paneRenderer;
  NearFieldPass nearFieldPass;
  ShadingPass shadingPass;

  Pacing pacing(const SessionState& s) const { return {s.clock.get(), kAim * pieceSeconds}; }
  GpuTask voxelize(SessionState& s, const TickRequest& request, TickReport& report);
  GpuTask inject(SessionState& s, const TickRequest& request, TickReport& report);
  GpuTask propagate(SessionState& s, const Scene& scene);
  GpuTask gather(SessionState& s, const TickRequest& request);
  GpuTask findReceivers(SessionState& s, const TickRequest& request, ReceiverBlocks& out);
  GpuTask listEmitters(SessionState& s, double openingRatio);
  GpuTask findShadowCasters(SessionState& s, const Scene& scene);
  GpuTask findPatches(SessionState& s, const Scene& scene);
  GpuTask reflect(SessionState& s, const TickRequest& request);
  GpuTask makeTextures(SessionState& s, const TickRequest& request, Transported light);
  GpuTask makeVolumes(SessionState& s, const TickRequest& request, Transported light, VolumeCopies& copies);
  GpuTask finishCopies(SessionState& s, const FrameViews& views);
  GpuTask takeVolumes(SessionState& s, const ScenePtr& scene, const VolumeCopies& copies);
  GpuTask lookAtLights(SessionState& s, const Scene& scene, const FrameRequest& frame, View& view);
  GpuTask drawPanes(SessionState& s, const Scene& scene, const FrameRequest& frame, View& view);
  GpuTask drawFrame(SessionState& s, const Scene& scene, const FrameRequest& frame, View& view);
};

std::array<double, kStages> unitsOf(const Workload& w) {
  const double blocks = w.cells / double(layout::kBlockX * layout::kBlockY * layout::kBlockZ);
  const double channels = w.groups() * w.channels();
  std::array<double, kStages> units{};
  const auto of = [&units](Stage stage) -> double& { return units[std::size_t(stage)]; };
  of(Stage::kUpload) = w.bytes;
  of(Stage::kVoxelize) = VoxelizeWork{w.lightTriangles, w.columns}.units();
  if (w.transport == Transport::kPropagate) {
    of(Stage::kInject) = InjectWork{w.lights, w.litCells}.units();
    of(Stage::kPropagate) = PropagateWork{w.iterations * w.cells, channels}.units();
  } else {
    of(Stage::kGather) = GatherWork{blocks, w.lights, w.rootsOfEntries, w.byDirection()}.units();
  }
  of(Stage::kVolume) = VolumeWork{w.cells, double(w.groups())}.units();
  return units;
}

Pipeline::Pipeline(double pieceSeconds) : stages_(std::make_unique<Stages>(pieceSeconds)) {}

Pipeline::~Pipeline() = default;

GpuTask Pipeline::tick(SessionState& s, const TickRequest& request, TickResult& result) {
  const Scene& scene = *request.scene;
  Stages& stages = *stages_;
  gpu::throwOnReset();
  s.adopt(scene, request.guarded);
  if (s.products == nullptr) s.products = std::make_shared<StageProducts>();
  StageProducts& made = *s.products;
  co_yield yield();
  co_await stages.cache.upload(scene, s.resources);

  const bool propagates = scene.options.transport == Transport::kPropagate;
  if (propagates) {
    co_await stages.inject(s, request, result.report);
    co_await stages.propagate(s, scene);
  } else {
    co_await stages.voxelize(s, request, result.report);
    co_await stages.findShadowCasters(s, scene);
    co_await stages.gather(s, request);
    co_await stages.listEmitters(s, scene.options.openingRatio());
    co_await stages.reflect(s, request);
  }
  const Transported light{s.field().transported(), propagates ? made.propagated.stamp() : made.gathered.stamp()};
  co_await stages.makeTextures(s, request, light);
  VolumeCopies copies;
  co_await stages.makeVolumes(s, request, light, copies);
  FrameViews views(s, request);
  for (std::size_t i = 0; i < request.frames.size(); ++i)
    co_await stages.drawFrame(s, scene, request.frames[i], *views.of[i]);

  const CountInputs counted = {propagates ? made.injected.stamp() : made.counting.stamp(), made.textured.stamp()};
  const bool counters = copies.any() || !made.counts.holds(counted);
  if (counters) copyCounters(s.field(), made.readbacks);
  if (counters || !views.of.empty()) co_await stages.finishCopies(s, views);
  if (counters) made.counts.set(counted, takeCounters(made.readbacks));
  co_await stages.takeVolumes(s, request.scene, copies);
  for (std::size_t i = 0; i < request.frames.size(); ++i)
    co_await takeFrame(*views.of[i], request.frames[i], result.frames.emplace_back());
  gpu::throwOnError("tick");

  result.revision = scene.revision;
  if (request.transported) result.transported = made.transportedVolume.product();
  if (request.injected) result.injected = made.injectedVolume.product();
  fillReport(s, scene.options, made.counts.product(), result.report);
}

/// Light by light; voxels follow from a light's geometry and texture alone.
GpuTask Pipeline::Stages::voxelize(SessionState& s, const TickRequest& request, TickReport& report) {
  for (std::size_t i = 0; i < s.lights.size(); ++i) {
    LightVoxels& voxels = *s.voxels[i];
    const EmittingLight& light = s.lights[i];
    if (!needsVoxels(s, light, request) || voxels.made.holds(voxels.source)) continue;
    const GpuLightTexture* texture =
        light.texture == nullptr ? nullptr : s.resources.lightTextures.at(light.texture).get();
    co_await voxelizer.run(s.field(), *s.resources.meshes.at(light.mesh), texture, voxels, pacing(s));
    voxels.made.set(voxels.source);
    report.lightsVoxelized++;
  }
}

/// Voxels are made anew in place, so what they gave to the field is taken out of it first.
GpuTask Pipeline::Stages::inject(SessionState& s, const TickRequest& request, TickReport& report) {
  const InjectInputs inputs = {s.memory.stamp(), s.arranged.stamp()};
  if (s.products->injected.holds(inputs)) co_return;
  co_await injector.retire(s.field(), pacing(s));
  co_await voxelize(s, request, report);
  co_await injector.add(s.field(), s.lights, s.voxels, s.palette(), pacing(s));
  s.products->injected.set(inputs);
}

GpuTask Pipeline::Stages::propagate(SessionState& s, const Scene& scene) {
  StageProducts& made = *s.products;
  const int iterations = scene.options.iterationsFor(scene.grid);
  const PropagateInputs inputs = {made.injected.stamp(), iterations, scene.options.clampFaces};
  if (made.propagated.holds(inputs)) co_return;
  co_await propagator.run(s.field(), s.arranged.product().box, iterations, inputs.clampFaces, pacing(s));
  made.propagated.set(inputs);
}

/// Everywhere for volumes, around surfaces for frames that read them.
GpuTask Pipeline::Stages::findReceivers(SessionState& s, const TickRequest& request, ReceiverBlocks& out) {
  const Scene& scene = *request.scene;
  if (request.transported) {
    out = allBlocks(s.field().grid.dims);
  } else if (!request.frames.empty() && !s.looksAtLights) {
    auto& blocks = s.products->surfaceBlocks;
    const SurfaceBlocksInputs inputs = surfaceBlocksInputs(scene, s.field().grid);
    if (!blocks.holds(inputs)) {
      ReceiverBlocks found;
      co_await blocksOfSurfaces(inputs, found);
      blocks.set(inputs, std::move(found));
    }
    out = blocks.product();
  }
}

/// Where the result is read, and not yet there.
GpuTask Pipeline::Stages::gather(SessionState& s, const TickRequest& request) {
  StageProducts& made = *s.products;
  const InjectInputs counted = {s.memory.stamp(), s.arranged.stamp()};
  if (!made.counting.holds(counted)) {
    s.field().resetCounters();
    made.counting.set(counted);
  }
  const LightingSettings& options = request.scene->options;
  const CellShadows shadows = {&made.pools, &made.occluders, cellTurns(options.quality, s.lights.size()),
                               &made.cellVisibilities};
  const GatherInputs inputs = {s.memory.stamp(), s.arranged.stamp(), options.openingRatio(),
                               s.shadowed ? shadows.turns : 0, s.shadowed ? made.occluders.surfaces() : 0};
  if (!made.gathered.holds(inputs)) {
    co_await gatherer.clear(s.field());
    made.gathered.set(inputs);
  }
  ReceiverBlocks wanted;
  co_await findReceivers(s, request, wanted);
  const ReceiverBlocks had = made.gathered.product();
  ReceiverBlocks missing, all;
  std::set_difference(wanted.begin(), wanted.end(), had.begin(), had.end(), std::back_inserter(missing));
  if (missing.empty()) co_return;
  std::set_union(had.begin(), had.end(), missing.begin(), missing.end(), std::back_inserter(all));
  made.gathered.forget();  // while light is added to some blocks
  co_await gatherer.run(s.field(), s.lights, s.voxels, s.palette(), inputs.openingRatio, s.sectors, missing,
                        s.shadowed ? &shadows : nullptr, pacing(s));
  made.gathered.set(inputs, std::move(all));
}

GpuTask Pipeline::Stages::listEmitters(SessionState& s, double openingRatio) {
  StageProducts& made = *s.products;
  const EmitterListInputs inputs = {s.arranged.stamp(), openingRatio, s.looksAtLights};
  if (made.listed.holds(inputs)) co_return;
  co_await made.emitters.make(s.lights, s.voxels, inputs);
  made.listed.set(inputs);
}

/// Where shadow rays go, and what they can meet.
GpuTask Pipeline::Stages::findShadowCasters(SessionState& s, const Scene& scene) {
  if (!s.shadowed && s.bounces == 0) co_return;
  StageProducts& made = *s.products;
  if (!made.pooled.holds(s.arranged.stamp())) {
    made.pools.make(s.lights, made.lightPoints);
    made.pooled.set(s.arranged.stamp());
  }
  std::vector<Occluder> occluders;  // not a temporary: GCC 12 destroys those of a conditional in co_await twice
  if (s.reflectionsBlocked) occluders = occludersOf(scene);
  co_await made.occluders.update(std::move(occluders), s.field().grid);
}

GpuTask Pipeline::Stages::findPatches(SessionState& s, const Scene& scene) {
  StageProducts& made = *s.products;
  PatchInputs inputs = {{}, s.field().grid, patchesWanted(scene.options), made.occluders.surfaces()};
  for (const auto& [name, surface] : scene.surfaces) inputs.surfaces.push_back(surface);
  if (made.patches.holds(inputs)) co_return;
  std::vector<Patch> patches = patchesOf(scene, inputs.count);
  auto set = patches.empty()
                 ? nullptr
                 : std::make_unique<PatchSet>(std::move(patches), s.field().grid, made.occluders.transparent());
  if (set != nullptr) co_await bouncePass.findExchange(*set, made.occluders, pacing(s));
  made.patches.set(std::move(inputs), std::move(set));
}

/// What surfaces reflect, for frames and probes.
GpuTask Pipeline::Stages::reflect(SessionState& s, const TickRequest& request) {
  if (s.bounces == 0 || s.lights.empty()) s.products->reflected.forget();
  if (s.bounces == 0 || s.lights.empty() || !readsReflections(request)) co_return;
  StageProducts& made = *s.products;
  co_await findPatches(s, *request.scene);
  PatchSet* patches = made.patches.product().get();
  const int turns = s.shadowed ? shadowTurns(request.scene->options) : 0;
  const ReflectInputs inputs = {made.patches.stamp(), made.pooled.stamp(), made.listed.stamp(),
                                made.occluders.all(), s.bounces,           turns};
  if (patches == nullptr || made.reflected.holds(inputs)) co_return;
  co_await nearFieldPass.run(*patches, made.emitters, {&made.pools, &made.occluders, turns}, pacing(s));
  if (s.reflectionsBlocked) co_await bouncePass.findLights(*patches, made.occluders, pacing(s));
  co_await bouncePass.run(*patches, s.bounces, pacing(s));
  made.reflected.set(inputs);
}

/// For frames that do not look at the lights alone.
GpuTask Pipeline::Stages::makeTextures(SessionState& s, const TickRequest& request, Transported light) {
  if (request.frames.empty() || s.looksAtLights) co_return;
  const VolumeInputs inputs = {light.stamp, 0, false, 0};
  if (s.products->textured.holds(inputs)) co_return;
  co_await volumeMaker.run(s.field(), light.field, s.palette(), VolumeTarget::kTextures, pacing(s));
  s.products->textured.set(inputs);
}

/// Those that somebody asks for; volumes that nobody asks for any more are let go of when they are out of date.
GpuTask Pipeline::Stages::makeVolumes(SessionState& s, const TickRequest& request, Transported light,
                                      VolumeCopies& copies) {
  StageProducts& made = *s.products;
  LightField& field = s.field();
  const bool propagates = field.transport == Transport::kPropagate;
  const VolumeInputs transported = {light.stamp, propagates ? 0 : made.listed.stamp(), s.guarded,
                                    readsReflections(request) ? made.reflected.stamp() : 0};
  if (!made.transportedVolume.holds(transported) && request.transported) {
    co_await volumeMaker.run(field, light.field, s.palette(), VolumeTarget::kTransported, pacing(s));
    co_await copyVolume(field, made.readbacks.transported);
    if (!propagates) copyEmitterList(field, made.emitters, made.readbacks);
    if (transported.reflected != 0) copyReflected(*made.reflecting(), made.readbacks);
    copies.transported = transported;
    copies.probed = readsReflections(request) || s.bounces == 0 || s.lights.empty();
  }
  const InjectedVolumeInputs injected = {{s.memory.stamp(), s.arranged.stamp()}, s.guarded};
  if (!made.injectedVolume.holds(injected) && request.injected) {
    if (!propagates) co_await injector.show(field, s.lights, s.voxels, s.palette(), pacing(s));
    co_await volumeMaker.run(field, field.injected, s.palette(), VolumeTarget::kInjected, pacing(s));
    co_await copyVolume(field, made.readbacks.injected);
    copies.injected = injected;
  }
}

/// Frames are copied once they are drawn; then all copies of the tick are waited for.
GpuTask Pipeline::Stages::finishCopies(SessionState& s, const FrameViews& views) {
  if (!views.of.empty()) {
    const gpu::Fence drawn = gpu::Fence::insert();
    co_yield waitFor(drawn);
    for (View* view : views.of) co_await copyFrame(*view, pacing(s));
  }
  const gpu::Fence copied = gpu::Fence::insert();
  co_yield submitted(Stage::kReadback, 0.0);
  co_yield waitFor(copied);
}

GpuTask Pipeline::Stages::takeVolumes(SessionState& s, const ScenePtr& scene, const VolumeCopies& copies) {
  StageProducts& made = *s.products;
  const std::vector<std::string>& groups = s.arranged.product().groups;
  const bool reflected = copies.transported && copies.transported->reflected != 0;
  if (copies.transported) {
    auto volume = std::make_shared<Volume>();
    volume->stage = VolumeStage::kTransported;
    co_await takeVolume(made.readbacks.transported, s.field(), groups, s.guarded, *volume);
    volume->direct =
        takeEmitterList(s.field(), made.emitters, made.readbacks,
                        s.reflectionsBlocked ? std::make_shared<const LightVisibility>(scene, s.shadowed) : nullptr,
                        reflected ? takeReflected(*made.reflecting(), made.readbacks) : nullptr);
    volume->probed = copies.probed;
    made.transportedVolume.set(*copies.transported, std::move(volume));
  }
  if (copies.injected) {
    auto volume = std::make_shared<Volume>();
    volume->stage = VolumeStage::kInjected;
    co_await takeVolume(made.readbacks.injected, s.field(), groups, s.guarded, *volume);
    made.injectedVolume.set(*copies.injected, std::move(volume));
  }
}

namespace {

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
  reflected.turns = s.reflectionsBlocked ? shadowTurns(frame, scene.options) : 0;
  return out;
}

}  // namespace

GpuTask Pipeline::Stages::lookAtLights(SessionState& s, const Scene& scene, const FrameRequest& frame, View& view) {
  if (view.nearField == nullptr || view.nearField->size != frame.size) {
    view.nearField = nullptr;
    view.nearField = std::make_unique<NearFieldBuffer>(frame.size);
  }
  const StageProducts& made = *s.products;
  const int turns = shadowTurns(frame, scene.options);
  const ShadowCasters shadows = {&made.pools, &made.occluders, s.shadowed ? turns : 0, made.reflecting(),
                                 s.reflectionsBlocked ? turns : 0};
  const bool inTheWay = s.shadowed || s.bounces > 0;
  const NearFieldSources sources = {{&made.emitters, s.looksAtLights ? nullptr : &s.field().textures->emitterDistance},
                                    inTheWay ? &shadows : nullptr,
                                    frame.reduced,
                                    inTheWay ? poolPictures(s, scene, frame, view) : std::vector<PoolPictureInputs>()};
  co_await nearFieldPass.run(*view.nearField, *view.gbuffer, view.targets->emitters, sources, view.targets->frameParams,
                             pacing(s));
}

GpuTask Pipeline::Stages::drawPanes(SessionState& s, const Scene& scene, const FrameRequest& frame, View& view) {
  if (!PaneRenderer::needed(frame, scene)) {
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

GpuTask Pipeline::Stages::drawFrame(SessionState& s, const Scene& scene, const FrameRequest& frame, View& view) {
  if (view.targets == nullptr || !view.targets->fits(frame)) {
    view.targets = nullptr;
    view.targets = std::make_unique<FrameTargets>(frame.size, frame.format, frame.exposure.automatic);
  }
  if (view.gbuffer == nullptr || view.gbuffer->target.size() != frame.size) {
    view.gbuffer = nullptr;
    view.gbuffer = std::make_unique<Gbuffer>(frame.size);
  }
  layout::FrameParams params = FrameView(frame.camera, frame.size).params(s.field().grid);
  params.palette = glm::vec3(s.palette().radiance[0]);
  params.exposure = exposureParams(frame.exposure);
  FrameTargets& targets = *view.targets;
  targets.frameParams.update(0, gpu::bytesOfValue(params));

  Gbuffer& gbuffer = *view.gbuffer;
  const GbufferInputs shown = gbufferInputs(frame, scene);
  if (!gbuffer.shown.holds(shown)) {
    co_await gbufferRenderer.run(gbuffer, frame, scene, s.resources, drawer, targets.frameParams, pacing(s));
    gbuffer.shown.set(shown);
  }
  co_await emitterRenderer.run(targets.emitters, frame, scene, s.resources, drawer, targets.frameParams, pacing(s));
  co_await drawPanes(s, scene, frame, view);
  const LightField& field = s.field();
  const bool sampled =
      s.shadowed || s.bounces > 0 || (frame.reduced && field.transport == Transport::kGather && !s.looksAtLights);
  if (sampled) co_await lookAtLights(s, scene, frame, view);
  const IrradianceSources lit = {field.transport,
                                 scene.options.lookup,
                                 s.looksAtLights ? nullptr : &*field.textures,
                                 &s.products->emitters,
                                 sampled ? &view.nearField->irradiance : nullptr,
                                 view.panes != nullptr ? &view.panes->share : nullptr};
  co_await shadingPass.run(targets, gbuffer, lit, frame, pacing(s));
}

}  // namespace lpv
