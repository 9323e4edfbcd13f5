#include "lpv/pipeline.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <set>

#include "gpu/failure.h"
#include "lpv/pacing/chunked.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

/// A piece is aimed at this share of what it may take: predictions are not exact.
constexpr double kAim = 0.6;

const char* nameOf(InjectionMethod method) {
  switch (method) {
    case InjectionMethod::kRaster:
      return "raster";
    case InjectionMethod::kDense:
      return "dense";
    case InjectionMethod::kCompute:
      break;
  }
  return "compute";
}

const char* transportName(Transport transport) {
  switch (transport) {
    case Transport::kGather:
      return "gather";
    case Transport::kDirect:
      return "direct";
    case Transport::kPropagate:
      break;
  }
  return "propagate";
}

/// DIRECT looks at polygons as they are: they are put into the grid for those who look at volumes only.
bool needsVoxels(const EmittingLight& light, const SessionState& session, const TickRequest& request) {
  const bool direct = session.field->transport == Transport::kDirect;
  return !direct || !light.polygons || request.transported || request.injected;
}

/// Compiled variants that the lights needed.
std::set<std::string> lightFeatures(const SessionState& session) {
  std::set<std::string> features;
  for (std::size_t i = 0; i < session.lights.size(); ++i) {
    if (session.lights[i].twoSided) features.insert("two-sided");
    if (session.voxels[i]->source.textured()) features.insert("textures");
    if (session.voxels[i]->source.directed()) features.insert("directions");
  }
  return features;
}

void fillReport(const SessionState& session, TickReport& report) {
  report.features = {session.method.injection == Injection::kFlux ? "flux" : "count", nameOf(session.method.method),
                     transportName(session.field->transport), session.palette.channels == 1 ? "monochrome" : "colour"};
  if (session.groups.size() > 1) report.features.push_back(std::to_string(session.groups.size()) + " groups");
  if (session.clampFaces) report.features.emplace_back("clamp-faces");
  for (const std::string& feature : lightFeatures(session)) report.features.push_back(feature);
  report.trianglesSkipped = session.trianglesSkipped;
  report.touchedCells = session.touchedCells;
  for (const LightVoxelsPtr& voxels : session.voxels) {
    if (voxels->tree == nullptr || !voxels->made) continue;
    report.trianglesSkipped += voxels->tree->degenerate;
    report.touchedCells += voxels->tree->cellCount;
    report.vpls += voxels->tree->vplCount;
  }
  report.clampedCells = session.clampedCells;
  for (const LightVoxelsPtr& voxels : session.voxels)
    report.fixedPointError = std::max(report.fixedPointError, voxels->roundingError);
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

}  // namespace

Pacing Pipeline::pacing(const SessionState& session) const { return {session.clock.get(), kAim * pieceSeconds_}; }

GpuTask Pipeline::tick(SessionState& s, const TickRequest& request, TickResult& result) {
  const Scene& scene = *request.scene;
  gpu::throwOnReset();
  s.adopt(scene);
  co_yield yield();
  co_await cache_.upload(scene, s.resources);

  VolumeCopies copies;
  if (!s.injected || s.method.vpls) {
    co_await voxelize(s, request, result.report);
    copies.counters = copies.counters || !s.injected;
    s.injected = true;
  }
  if (scene.options.transport == Transport::kPropagate && !s.transported) {
    co_await propagator_.run(*s.field, s.box, s.iterations, s.clampFaces, pacing(s));
    s.transported = true;
  }
  if (scene.options.transport != Transport::kPropagate) {
    co_await gather(s, request);
    if (!s.directMade) s.emitters.make(s.lights, s.voxels, s.k);
    s.directMade = true;
  }
  co_await makeVolumes(s, request, copies);
  FrameViews views(s, request);
  for (std::size_t i = 0; i < request.frames.size(); ++i)
    co_await drawFrame(s, request, request.frames[i], *views.of[i]);

  if (copies.counters) queueCounterCopy(s);
  if (!views.of.empty()) {
    const gpu::Fence drawn = gpu::Fence::insert();
    co_yield waitFor(drawn);
    for (View* view : views.of) co_await copyFrame(*view, pacing(s));
  }
  if (copies.counters || !views.of.empty()) {
    const gpu::Fence copied = gpu::Fence::insert();
    co_yield submitted(Stage::kReadback, 0.0);
    co_yield waitFor(copied);
  }
  co_await takeCopies(s, copies);
  for (std::size_t i = 0; i < request.frames.size(); ++i)
    co_await takeFrame(*views.of[i], request.frames[i], result.frames.emplace_back());
  gpu::throwOnError("tick");

  result.revision = scene.revision;
  if (request.transported) result.transported = s.transportedVolume;
  if (request.injected) result.injected = s.injectedVolume;
  fillReport(s, result.report);
}

/// Lights that did not change are added again, not voxelized again.
GpuTask Pipeline::voxelize(SessionState& s, const TickRequest& request, TickReport& report) {
  if (!s.method.vpls) co_await s.field->clear();
  if (!s.method.vpls) co_await injector_.retire(*s.field, s.injectedVoxels, pacing(s));
  s.injectedVoxels.clear();
  for (std::size_t i = 0; i < s.lights.size(); ++i) {
    LightVoxels& voxels = *s.voxels[i];
    const EmittingLight& light = s.lights[i];
    if (voxels.made || !needsVoxels(light, s, request)) continue;
    const GpuLightTexture* texture =
        light.texture == nullptr ? nullptr : s.resources.lightTextures.at(light.texture).get();
    co_await voxelizer_.run(*s.field, *s.resources.meshes.at(light.mesh), texture, voxels, pacing(s));
    voxels.made = true;
    report.lightsVoxelized++;
  }
  if (s.method.vpls) {
    if (!s.injected) s.field->counters.update(0, gpu::bytesOfValue(layout::Counters{}));
    co_return;
  }
  co_await injector_.add(*s.field, s.lights, s.voxels, s.palette, pacing(s));
  s.injectedVoxels = s.voxels;
}

/// Where the result is read, and not yet there: everywhere for volumes, around surfaces for frames, which DIRECT makes
/// without.
GpuTask Pipeline::gather(SessionState& s, const TickRequest& request) {
  if (!s.transported) {
    co_await fillChunked(s.field->pingPong[0].buffer);
    co_await fillChunked(s.field->emitterDistance, std::bit_cast<std::uint32_t>(layout::kFarFromVpls));
  }
  s.transported = true;
  ReceiverBlocks wanted;
  if (request.transported) {
    wanted = allBlocks(s.field->grid.dims);
  } else if (!request.frames.empty() && s.field->transport == Transport::kGather) {
    if (s.surfaceBlocks.empty()) co_await blocksOfSurfaces(*request.scene, s.surfaceBlocks);
    wanted = s.surfaceBlocks;
  }
  ReceiverBlocks missing;
  std::set_difference(wanted.begin(), wanted.end(), s.gathered.begin(), s.gathered.end(), std::back_inserter(missing));
  if (missing.empty()) co_return;
  co_await gatherer_.run(*s.field, s.lights, s.voxels, s.palette, s.k, missing, pacing(s));
  ReceiverBlocks all;
  std::set_union(s.gathered.begin(), s.gathered.end(), missing.begin(), missing.end(), std::back_inserter(all));
  s.gathered = std::move(all);
  s.textured = false;
  s.transportedVolume.reset();
}

/// Only what somebody asked for and nothing has since made out of date.
GpuTask Pipeline::makeVolumes(SessionState& s, const TickRequest& request, VolumeCopies& copies) {
  const std::size_t volumeBytes = s.field->grid.cells() * s.groups.size() * layout::kVolumeFloats * sizeof(float);
  if (!request.frames.empty() && !s.textured && s.field->transport != Transport::kDirect) {
    if (!s.textures)
      s.textures.emplace(s.field->grid.dims, s.field->channels, s.field->groups,
                         s.field->transport == Transport::kGather);
    co_await volumeMaker_.run(*s.field, s.palette, VolumeTarget::kTextures, &*s.textures, nullptr, pacing(s));
    s.textured = copies.counters = true;
  }
  const bool transported = request.transported && s.transportedVolume == nullptr;
  const bool injected = request.injected && s.injectedVolume == nullptr;
  if ((transported || injected) && s.incidentVolume.size() != volumeBytes)
    s.incidentVolume = gpu::Buffer("incident volume", volumeBytes, gpu::BufferUse::kDevice, gpu::Undefined{});
  if (transported) {
    co_await volumeMaker_.run(*s.field, s.palette, VolumeTarget::kTransported, nullptr, &s.incidentVolume, pacing(s));
    co_await copyVolume(s, VolumeStage::kTransported);
    if (s.field->transport != Transport::kPropagate) queueEmitterListCopy(s);
    copies.transported = copies.counters = true;
  }
  if (injected) {
    if (s.method.vpls) co_await injector_.show(*s.field, s.lights, s.voxels, s.palette, pacing(s));
    co_await volumeMaker_.run(*s.field, s.palette, VolumeTarget::kInjected, nullptr, &s.incidentVolume, pacing(s));
    co_await copyVolume(s, VolumeStage::kInjected);
    copies.injected = copies.counters = true;
  }
}

GpuTask Pipeline::drawFrame(SessionState& s, const TickRequest& request, const FrameRequest& frame, View& view) {
  const Scene& scene = *request.scene;
  if (view.targets == nullptr || !view.targets->fits(frame)) {
    view.targets = nullptr;
    view.targets = std::make_unique<FrameTargets>(frame.size, frame.format, frame.exposure.automatic);
  }
  if (view.gbuffer == nullptr || view.gbuffer->target.size() != frame.size) {
    view.gbuffer = nullptr;
    view.gbuffer = std::make_unique<Gbuffer>(frame.size);
  }
  layout::FrameParams params = FrameView(frame.camera, frame.size).params(scene.grid);
  params.palette = glm::vec3(s.palette.radiance[0]);
  params.exposure = exposureParams(frame.exposure);
  FrameTargets& targets = *view.targets;
  targets.frameParams.update(0, gpu::bytesOfValue(params));

  if (!view.gbuffer->shows(frame, scene))
    co_await gbufferRenderer_.run(*view.gbuffer, frame, scene, s.resources, drawer_, targets.frameParams, pacing(s));
  co_await emitterRenderer_.run(targets.emitters, frame, scene, s.resources, drawer_, targets.frameParams, pacing(s));
  const bool nearField = scene.options.quality == Quality::kAccurate;
  const IrradianceSources lit = {s.field->transport, scene.options.lookup, nearField,
                                 s.textures ? &*s.textures : nullptr, &s.emitters};
  co_await shadingPass_.run(targets, *view.gbuffer, lit, frame, pacing(s));
}

}  // namespace lpv
