#include "lpv/pipeline.h"

#include <algorithm>
#include <iterator>

#include "gpu/failure.h"
#include "lpv/pipeline_stages.h"
#include "lpv/tick_report.h"
#include "scene/parted_patches.h"

namespace lpv {

namespace {

/// Frames that look at triangles take them as they are: they are put into the grid for those who look at volumes only.
bool needsVoxels(const SessionState& s, const EmittingLight& light, const TickRequest& request) {
  return !s.looksAtLights || !(light.polygons || light.tree) || request.transported || request.injected;
}

std::size_t patchesWanted(const LightingSettings& options) {
  return options.quality == Quality::kAccurate ? kAccuratePatches : kFastPatches;
}

std::size_t piecesWanted(const LightingSettings& options) {
  return options.quality == Quality::kAccurate ? kAccuratePieces : kFastPieces;
}

/// Frames of streams do not look for pieces of folds.
bool looksForPieces(const TickRequest& request) {
  const auto full = [](const FrameRequest& frame) { return !frame.reduced; };
  return std::ranges::any_of(request.frames, full) || (request.transported && request.probed);
}

constexpr std::size_t kPointsOfNearLight = 256;

/// Every n-th of many is a sample of the whole, and stands for n.
LightPoints thinned(const LightPoints& points) {
  const std::size_t step = (points.size() + kPointsOfNearLight - 1) / kPointsOfNearLight;
  LightPoints out;
  out.reserve(kPointsOfNearLight);
  for (std::size_t i = 0; i < points.size(); i += step) {
    out.push_back(points[i]);
    out.back().area *= float(step);
  }
  return out;
}

/// The lights that may be near to a surface: all but the sky.
std::vector<LightInPoints> lightsInPoints(const std::vector<EmittingLight>& lights, const Grid& grid,
                                          LightPointCache& cache) {
  const glm::dmat4 worldFromGrid = glm::inverse(grid.gridFromWorldMatrix());
  std::vector<LightInPoints> out;
  out.reserve(lights.size());
  for (const EmittingLight& light : lights) {
    if (light.source != nullptr && light.source->distant) continue;
    const LightPointsPtr all = cache.get(light);
    const glm::dmat4 worldFromObject = worldFromGrid * light.gridFromObject;
    const double brightness = (light.radiance.r + light.radiance.g + light.radiance.b) / 3.0;
    const bool few = all->size() <= kPointsOfNearLight;
    LightPoints points = few ? transformed(*all, worldFromObject) : transformed(thinned(*all), worldFromObject);
    out.push_back({std::move(points), brightness, light.twoSided});
  }
  return out;
}

/// Volumes alone hold direct light.
bool readsReflections(const TickRequest& request) {
  return !request.frames.empty() || (request.transported && request.probed);
}

}  // namespace

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
  s.charge(s.lightMemory);
  s.adopt(scene, request.guarded);
  if (s.products == nullptr) s.products = std::make_shared<StageProducts>();
  StageProducts& made = *s.products;
  co_yield yield();
  s.charge(nullptr);  // sessions share them
  co_await stages.cache.upload(scene, s.resources);
  s.charge(s.lightMemory);

  const bool propagates = scene.options.transport == Transport::kPropagate;
  if (propagates) {
    co_await stages.inject(s, request, result.report);
    co_await stages.propagate(s, scene);
  } else {
    co_await stages.voxelize(s, request, result.report);
    co_await stages.findShadowCasters(s, request);
    co_await stages.gather(s, request);
    co_await stages.listEmitters(s, scene.options.openingRatio());
    co_await stages.reflect(s, request);
  }
  const Transported light{s.field().transported(), propagates ? made.propagated.stamp() : made.gathered.stamp()};
  co_await stages.makeTextures(s, request, light);
  VolumeCopies copies;
  co_await stages.makeVolumes(s, request, light, copies);
  TickViews views(s, request);
  s.charge(s.frameMemory);
  for (std::size_t i = 0; i < request.frames.size(); ++i) {
    if (drawnInBands(request.frames[i])) {
      View bands;
      co_await stages.drawBands(s, scene, request.frames[i], bands, views.taken[i]);
    } else {
      const FrameRows whole(request.frames[i]);
      co_await stages.drawFrame(s, scene, whole, *views.of[i]);
    }
  }

  s.charge(s.lightMemory);
  const CountInputs counted = {propagates ? made.injected.stamp() : made.counting.stamp(), made.textured.stamp()};
  const bool counters = copies.any() || !made.counts.holds(counted);
  if (counters) copyCounters(s.field(), made.readbacks);
  if (counters || !views.of.empty()) co_await stages.finishCopies(s, views);
  if (counters) made.counts.set(counted, takeCounters(made.readbacks));
  co_await stages.takeVolumes(s, request.scene, copies);
  for (std::size_t i = 0; i < request.frames.size(); ++i) {
    if (!views.taken[i]) co_await takeFrame(*views.of[i], request.frames[i], views.taken[i]);
  }
  result.frames = std::move(views.taken);
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
  const GatheredLights lights = {
      s.lights, s.voxels, s.palette(), inputs.openingRatio, s.sectors, s.shadowed ? &shadows : nullptr};
  if (had.empty() && s.lights.size() > 1) {
    made.lightSums.begin({inputs.memory, inputs.openingRatio, s.sectors, inputs.turns, inputs.blockers, missing},
                         sentInputs(s.lights, s.voxels, s.palette()));
    co_await gatherer.run(s.field(), lights, missing, made.lightSums, pacing(s));
    made.lightSums.end();
  } else {
    LightSums none;
    co_await gatherer.run(s.field(), lights, missing, none, pacing(s));
  }
  made.gathered.set(inputs, std::move(all));
}

GpuTask Pipeline::Stages::listEmitters(SessionState& s, double openingRatio) {
  StageProducts& made = *s.products;
  const EmitterListInputs inputs = {s.arranged.stamp(), openingRatio, s.looksAtLights};
  if (made.listed.holds(inputs)) co_return;
  co_await made.emitters.make(s.lights, s.voxels, inputs);
  made.listed.set(inputs);
}

/// What single rays of lobes, and through haze, meet.
void Pipeline::Stages::findShownLights(SessionState& s, const Scene& scene) {
  StageProducts& made = *s.products;
  if (!s.glossy && scene.options.haze == 0.0) {
    made.finePools = {};
    made.finePooled.forget();
    made.glossScene = {};
    return;
  }
  if (!made.finePooled.holds(s.arranged.stamp())) {
    made.fineLightPoints.setTimes(
        std::max(kFineTimes * kMostFineLights / std::max(s.lights.size(), kMostFineLights), std::size_t(1)));
    made.finePools.make(s.lights, made.fineLightPoints);
    made.finePooled.set(s.arranged.stamp());
  }
  made.glossScene.update(scene, s.glossy, s.lights, made.finePools, made.finePooled.stamp());
}

/// Where shadow rays go, and what they can meet.
GpuTask Pipeline::Stages::findShadowCasters(SessionState& s, const TickRequest& request) {
  const Scene& scene = *request.scene;
  StageProducts& made = *s.products;
  findShownLights(s, scene);
  const bool apart = std::any_of(request.frames.begin(), request.frames.end(),
                                 [&s](const FrameRequest& frame) { return looksApart(s, frame); });
  if (!s.shadowed && s.bounces.turns == 0 && !s.glossy && !apart) co_return;
  if (!made.pooled.holds(s.arranged.stamp())) {
    made.pools.make(s.lights, made.lightPoints);
    made.pooled.set(s.arranged.stamp());
  }
  std::vector<Occluder> occluders;  // not a temporary: GCC 12 destroys those of a conditional in co_await twice
  if (s.reflectionsBlocked || s.glossy || scene.options.haze > 0.0) occluders = occludersOf(scene);
  co_await made.occluders.update(std::move(occluders), s.field().grid, hazeOf(scene));
}

/// The same ones as before where lights that have moved ask for no others.
void Pipeline::Stages::findPieceSizes(SessionState& s, const Scene& scene, const PatchedInputs& patched) {
  StageProducts& made = *s.products;
  PieceSizeInputs inputs = {patched.surfaces, patched.pieces, made.pooled.stamp()};
  if (made.pieceSizes.madeFrom(inputs)) return;
  const std::vector<LightInPoints> lights = lightsInPoints(s.lights, s.field().grid, made.lightPoints);
  auto sizes = std::make_shared<const PieceSizes>(pieceSizesNear(lights, scene, largestPiece(scene, inputs.pieces)));
  PieceSizesPtr before = made.pieceSizes.product();
  made.pieceSizes.set(std::move(inputs), before != nullptr && *before == *sizes ? std::move(before) : std::move(sizes));
}

/// Those with pieces serve ticks that do not look for them, too.
void Pipeline::Stages::patchSurfaces(SessionState& s, const TickRequest& request) {
  StageProducts& made = *s.products;
  const Scene& scene = *request.scene;
  PatchedInputs inputs = {{},
                          litSpace(scene),
                          patchesWanted(scene.options),
                          s.reflectionsBlocked ? piecesWanted(scene.options) : 0,
                          nullptr};
  inputs.surfaces.reserve(scene.surfaces.size());
  for (const auto& [name, surface] : scene.surfaces) inputs.surfaces.push_back(surface);
  const bool looks = inputs.pieces > 0 && looksForPieces(request);
  if (looks) findPieceSizes(s, scene, inputs);
  inputs.sizes = made.pieceSizes.product();
  if (made.patched.madeFrom(inputs)) return;
  if (!looks) {
    inputs.pieces = 0;
    inputs.sizes = nullptr;
  }
  if (made.patched.holds(inputs)) return;
  const PieceSizes sizes = inputs.sizes != nullptr ? *inputs.sizes : PieceSizes();
  auto patched = std::make_shared<const PatchedScene>(patchedScene(scene, inputs.count, inputs.pieces, sizes));
  made.patched.set(std::move(inputs), std::move(patched));
}

/// Finer where lights are near: these, and with them what patches exchange, may change with the lights.
GpuTask Pipeline::Stages::findPatches(SessionState& s, const TickRequest& request) {
  StageProducts& made = *s.products;
  const Scene& scene = *request.scene;
  patchSurfaces(s, request);
  const PatchedScene& patched = *made.patched.product();
  const HalvingInputs near = {made.patched.stamp(), made.pooled.stamp()};
  if (!made.halvings.holds(near)) {
    const std::vector<LightInPoints> lights = lightsInPoints(s.lights, s.field().grid, made.lightPoints);
    made.halvings.set(near, halvingsNearLights(patched.patches, lights, patchesWanted(scene.options) / 4));
  }
  PatchInputs inputs = {made.patched.stamp(), made.halvings.product(), s.field().grid, made.occluders.surfaces()};
  if (made.patches.holds(inputs)) co_return;
  PatchedScenePtr fine = inputs.halvings.empty()
                             ? made.patched.product()
                             : std::make_shared<const PatchedScene>(halved(patched, inputs.halvings));
  if (s.reflectionsBlocked) fine = std::make_shared<const PatchedScene>(parted(*fine, scene));
  auto set = fine->patches.empty()
                 ? nullptr
                 : std::make_unique<PatchSet>(fine, scene, s.field().grid, made.occluders.transparent());
  if (set != nullptr) co_await bouncePass.findExchange(*set, made.occluders, pacing(s));
  made.patches.set(std::move(inputs), std::move(set));
}

/// What surfaces reflect, for frames and probes.
GpuTask Pipeline::Stages::reflect(SessionState& s, const TickRequest& request) {
  if (s.bounces.turns == 0 || s.lights.empty()) s.products->reflected.forget();
  if (s.bounces.turns == 0 || s.lights.empty() || !readsReflections(request)) co_return;
  StageProducts& made = *s.products;
  co_await findPatches(s, request);
  PatchSet* patches = made.patches.product().get();
  const int turns = s.shadowed ? shadowTurns(request.scene->options) : 0;
  const bool pieces = patches != nullptr && patches->folded() && looksForPieces(request);
  const ReflectInputs inputs = {
      made.patches.stamp(), made.pooled.stamp(), made.listed.stamp(), made.occluders.all(), s.bounces, turns, pieces};
  if (patches == nullptr || made.reflected.holds(inputs)) co_return;
  const ShadowCasters shadows = {&made.pools, &made.occluders, turns};
  co_await nearFieldPass.run(*patches, made.emitters, shadows, pacing(s));
  if (pieces) {
    co_await nearFieldPass.lookFromPieces(*patches, made.emitters, shadows, pacing(s));
    co_await bouncePass.takeMeans(*patches, pacing(s));
  }
  if (s.reflectionsBlocked) co_await bouncePass.findLights(*patches, made.occluders, pacing(s));
  co_await bounce(s, *request.scene, *patches, pieces);
  co_await bouncePass.findSlopes(*patches, made.occluders, pacing(s));
  made.reflected.set(inputs);
}

/// From so many bounces on pieces of folds get from each other what they sent the time before, and so often, as where
/// all light is wanted. They begin with what comes from elsewhere.
constexpr int kBouncesOfPieces = 16, kTurnsOfPieces = 48;

/// The pieces of folds get the last bounce but one as pixels do the last, from patches and from each other, and send it
/// on.
GpuTask Pipeline::Stages::bounce(SessionState& s, const Scene& scene, PatchSet& patches, bool pieces) {
  const StageProducts& made = *s.products;
  const int turns = s.bounces.turns;
  const bool look = pieces && turns > 1;
  co_await bouncePass.run(patches, s.bounces, 0, look ? turns - 1 : turns, pacing(s));
  if (!look) co_return;
  const ShadowCasters shadows = {&made.pools,
                                 &made.occluders,
                                 0,
                                 &patches,
                                 reflectedTurnsOfPieces(scene.options),
                                 foldTurnsOfPieces(scene.options)};
  const bool allLight = (s.bounces.albedo > 0.0 || turns >= kBouncesOfPieces) && !made.occluders.transparent();
  patches.forgetFoldHits(shadows.foldTurns);
  co_await nearFieldPass.lookFromPieces(patches, made.emitters, shadows, pacing(s));
  co_await bouncePass.run(patches, s.bounces, turns - 1, turns, pacing(s));
  co_await bouncePass.finishPieces(patches, shadows.foldTurns, allLight ? kTurnsOfPieces : 0, pacing(s));
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
    copies.probed = readsReflections(request) || s.bounces.turns == 0 || s.lights.empty();
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
GpuTask Pipeline::Stages::finishCopies(SessionState& s, const TickViews& views) {
  if (!views.of.empty()) {
    const gpu::Fence drawn = gpu::Fence::insert();
    co_yield waitFor(drawn);
    for (std::size_t i = 0; i < views.of.size(); ++i) {
      if (!views.taken[i]) co_await copyFrame(*views.of[i], pacing(s));
    }
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

}  // namespace lpv
