#pragma once
// Inside of the pipeline: its stages, and what each has made for a session.

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "lpv/frame/buried.h"
#include "lpv/frame/draw.h"
#include "lpv/frame/emitters.h"
#include "lpv/frame/gbuffer.h"
#include "lpv/frame/gloss.h"
#include "lpv/frame/haze.h"
#include "lpv/frame/near_field.h"
#include "lpv/frame/panes.h"
#include "lpv/frame/shading.h"
#include "lpv/frame/subpixels.h"
#include "lpv/pipeline.h"
#include "lpv/readback.h"
#include "lpv/resources/scene_cache.h"
#include "lpv/transport/bounces.h"
#include "lpv/transport/emitter_list.h"
#include "lpv/transport/gather.h"
#include "lpv/transport/inject.h"
#include "lpv/transport/light_sums.h"
#include "lpv/transport/propagate.h"
#include "lpv/transport/volume.h"
#include "lpv/voxelize/voxelize.h"
#include "scene/patches.h"
#include "scene/patches_near_lights.h"
#include "scene/piece_sizes.h"

namespace lpv {

/// A piece is aimed at this share of what it may take: predictions are not exact.
inline constexpr double kAim = 0.6;

/// Of four shadow rays from a pixel to each pool of lights: by settings alone, and fewer in streams.
inline int shadowTurns(const LightingSettings& options) { return options.quality == Quality::kAccurate ? 16 : 8; }
/// Of four rays from a pixel to what surfaces reflect, and of rays all around it, to pieces of folds. From pieces fewer
/// go: their grain goes in the mean over many.
inline int reflectedTurns(const FrameRequest& frame, const LightingSettings& options) {
  return !frame.reduced && options.quality == Quality::kAccurate ? 16 : 4;
}
inline int foldTurns(const LightingSettings& options) { return options.quality == Quality::kAccurate ? 16 : 8; }
inline int reflectedTurnsOfPieces(const LightingSettings& options) {
  return options.quality == Quality::kAccurate ? 4 : 2;
}
inline int foldTurnsOfPieces(const LightingSettings& options) { return options.quality == Quality::kAccurate ? 8 : 4; }
/// Of rays of a pixel's lobe, at most.
inline int glossTurns(const FrameRequest& frame, const LightingSettings& options) {
  return frame.reduced ? 1 : options.quality == Quality::kAccurate ? 128 : 64;
}
/// Of rays of a pixel through haze. A power of two: so many are spread evenly (shaders/frame/haze.comp).
inline int hazeTurns(const FrameRequest& frame, const LightingSettings& options) {
  return frame.reduced ? 1 : options.quality == Quality::kAccurate ? 32 : 8;
}
inline int shadowTurns(const FrameRequest& frame, const LightingSettings& options) {
  return frame.reduced ? shadowTurns(options) / 2 : shadowTurns(options);
}

/// Light that has arrived in cells, as volumes are made from it.
struct Transported {
  const FieldBuffer& field;
  Stamp stamp;
};

/// What the counters count.
struct CountInputs {
  Stamp lights = 0;  ///< begins with zeros
  Stamp textured = 0;  ///< clamped cells; a volume's are read with the volume

  bool operator==(const CountInputs&) const = default;
};

/// What says how fine pieces of folds are.
struct PieceSizeInputs {
  std::vector<SurfacePtr> surfaces;
  std::size_t pieces = 0;
  Stamp lights = 0;

  bool operator==(const PieceSizeInputs&) const = default;
};

/// What the surfaces' patches are made from, before any is halved.
struct PatchedInputs {
  std::vector<SurfacePtr> surfaces;
  LitSpace space;
  std::size_t count = 0;
  std::size_t pieces = 0;  ///< of folds
  PieceSizesPtr sizes;  ///< of them

  bool operator==(const PatchedInputs&) const = default;
};

/// What says which of them are halved.
struct HalvingInputs {
  Stamp patched = 0;
  Stamp lights = 0;

  bool operator==(const HalvingInputs&) const = default;
};

/// What all patches, and what they exchange, are made from.
struct PatchInputs {
  Stamp patched = 0;
  std::vector<std::uint32_t> halvings;
  Grid grid;
  Stamp blockers = 0;

  bool operator==(const PatchInputs&) const = default;
};

/// What patches send.
struct ReflectInputs {
  Stamp patches = 0;
  Stamp lights = 0;
  Stamp list = 0;  ///< of emitters
  Stamp blockers = 0;
  BouncePlan bounces;
  int turns = 0;  ///< of shadow rays
  bool pieces = false;  ///< of folds get light of their own, too

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

/// Large pictures that nobody asks for again are made some rows at a time.
bool drawnInBands(const FrameRequest& frame);

/// Whether samples that are unlike their pixel's middle are lit where they are: in single frames, wherever the lights
/// can be looked at.
bool looksApart(const SessionState& s, const FrameRequest& frame);

/// Where each frame of a tick is made: kept views in the session, others here for the tick.
struct TickViews {
  TickViews(SessionState& session, const TickRequest& request) {
    for (const FrameRequest& frame : request.frames) {
      View* view = frame.view != 0 ? &session.views[frame.view] : nullptr;
      if (view == nullptr || std::find(of.begin(), of.end(), view) != of.end())
        view = unkept.emplace_back(std::make_unique<View>()).get();
      of.push_back(view);
    }
    taken.resize(of.size());
  }
  std::vector<View*> of;  ///< per frame
  std::vector<FramePtr> taken;  ///< per frame, once it was read back
  std::vector<std::unique_ptr<View>> unkept;
};

/// Of one session. What has no product here describes memory: of the field, or of the list of emitters.
struct StageProducts {
  Cached<InjectInputs> injected;  ///< PROPAGATE
  Cached<PropagateInputs> propagated;
  Cached<GatherInputs, ReceiverBlocks> gathered;  ///< the blocks that are
  LightSums lightSums;  ///< of what was gathered, parts
  Cached<SurfaceBlocksInputs, ReceiverBlocks> surfaceBlocks;
  Cached<EmitterListInputs> listed;
  EmitterBufferList emitters;
  Cached<Stamp> pooled;  ///< of the lights
  LightPools pools;
  LightPointCache lightPoints;
  Cached<Stamp> finePooled;  ///< the same for gloss and haze, with more points of each light
  LightPools finePools;
  LightPointCache fineLightPoints;
  GpuOccluders occluders;
  GlossScene glossScene;
  CellVisibilities cellVisibilities;
  Cached<PieceSizeInputs, PieceSizesPtr> pieceSizes;
  Cached<PatchedInputs, PatchedScenePtr> patched;  ///< the surfaces
  Cached<HalvingInputs, std::vector<std::uint32_t>> halvings;
  Cached<PatchInputs, std::unique_ptr<PatchSet>> patches;
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
  BuriedPass buriedPass;
  EmitterRenderer emitterRenderer;
  PaneRenderer paneRenderer;
  SubpixelPass subpixelPass{gbufferRenderer, emitterRenderer, paneRenderer};
  NearFieldPass nearFieldPass;
  GlossPass glossPass{nearFieldPass};
  HazePass hazePass;
  ShadingPass shadingPass;

  Pacing pacing(const SessionState& s) const { return {s.clock.get(), kAim * pieceSeconds}; }
  GpuTask voxelize(SessionState& s, const TickRequest& request, TickReport& report);
  GpuTask inject(SessionState& s, const TickRequest& request, TickReport& report);
  GpuTask propagate(SessionState& s, const Scene& scene);
  GpuTask gather(SessionState& s, const TickRequest& request);
  GpuTask findReceivers(SessionState& s, const TickRequest& request, ReceiverBlocks& out);
  GpuTask listEmitters(SessionState& s, double openingRatio);
  GpuTask findShadowCasters(SessionState& s, const TickRequest& request);
  static void findShownLights(SessionState& s, const Scene& scene);
  void findPieceSizes(SessionState& s, const Scene& scene, const PatchedInputs& patched);
  void patchSurfaces(SessionState& s, const TickRequest& request);
  GpuTask findPatches(SessionState& s, const TickRequest& request);
  GpuTask reflect(SessionState& s, const TickRequest& request);
  GpuTask bounce(SessionState& s, const Scene& scene, PatchSet& patches, bool pieces);
  GpuTask makeTextures(SessionState& s, const TickRequest& request, Transported light);
  GpuTask makeVolumes(SessionState& s, const TickRequest& request, Transported light, VolumeCopies& copies);
  GpuTask finishCopies(SessionState& s, const TickViews& views);
  GpuTask takeVolumes(SessionState& s, const ScenePtr& scene, const VolumeCopies& copies);

  // Of frames (pipeline_frames.cpp).
  ShadowCasters shadowCasters(const SessionState& s, const Scene& scene, const FrameRows& frame) const;
  GpuTask lookAtLights(SessionState& s, const Scene& scene, const FrameRows& frame, View& view);
  GpuTask reflectLikeMirrors(SessionState& s, const Scene& scene, const FrameRows& frame, View& view);
  GpuTask scatter(SessionState& s, const Scene& scene, const FrameRows& frame, View& view);
  GpuTask drawPanes(SessionState& s, const Scene& scene, const FrameRows& frame, View& view);
  GpuTask drawSubpixels(SessionState& s, const Scene& scene, const FrameRows& frame, View& view);
  GpuTask drawFrame(SessionState& s, const Scene& scene, const FrameRows& frame, View& view);
  /// A large picture some rows at a time, in the memory of these, read back as well.
  GpuTask drawBands(SessionState& s, const Scene& scene, const FrameRequest& frame, View& view, FramePtr& out);
};

}  // namespace lpv
