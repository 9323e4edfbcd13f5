#pragma once
// What the GPU thread keeps of a session between ticks.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/engine.h"
#include "gpu/account.h"
#include "gpu/readback.h"
#include "lpv/cached.h"
#include "lpv/frame/gloss.h"
#include "lpv/frame/haze.h"
#include "lpv/frame/near_field.h"
#include "lpv/frame/panes.h"
#include "lpv/frame/shading.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/light_voxels.h"
#include "lpv/resources/lights.h"
#include "lpv/resources/palette.h"
#include "lpv/resources/scene_cache.h"
#include "lpv/transport/sectors.h"

namespace lpv {

/// What is kept for one subscriber's frames (FrameRequest::view), or made for one frame only.
struct View {
  std::unique_ptr<Gbuffer> gbuffer;
  std::unique_ptr<FrameTargets> targets;
  std::unique_ptr<NearFieldBuffer> nearField;  ///< of a reduced frame (FrameRequest::reduced), or one with shadows
  std::unique_ptr<PaneBuffer> panes;  ///< where panes are in the picture, and one sample per pixel
  std::unique_ptr<GlossBuffer> gloss;  ///< where surfaces have lobes
  std::unique_ptr<HazeBuffer> haze;  ///< where there is haze
  std::unique_ptr<SubpixelBuffer> subpixels;  ///< of a frame with several samples per pixel
  gpu::Readback readback;
};

/// What the lights' arrangement is made from.
struct LightsInputs {
  std::vector<Emission> lights;  ///< in the order of names
  Grid grid;  ///< of the field
  Transport transport = Transport::kPropagate;
  VoxelMethod method;
  bool apart = false;  ///< some of the light is looked at, the rest looked up
  std::optional<double> groupingGoal;  ///< nothing: groups are the scene's

  bool operator==(const LightsInputs&) const = default;
};

/// The lights together.
struct LightArrangement {
  Palette palette;
  CellBox box;                      ///< holds every cell that emits
  std::vector<std::string> groups;  ///< of lights, or of directions, by name, in the order of the field's
};

/// What each stage has made (pipeline.cpp).
struct StageProducts;

struct SessionState {
  std::shared_ptr<StageClock> clock = std::make_shared<StageClock>();
  SceneResources resources;
  std::vector<EmittingLight> lights;   ///< their groups, and the sectors, stand while they are good enough
  Sectors sectors = Sectors::kNone;    ///< of layers by direction
  std::vector<LightVoxelsPtr> voxels;  ///< per light
  bool guarded = false;                ///< guard cells were asked for
  bool looksAtLights = false;          ///< frames look at the lights everywhere and read no volume
  bool shadowed = false;               ///< something may stand in the lights' way
  bool reflectionsBlocked = false;     ///< something may stand in the way of what surfaces reflect
  BouncePlan bounces;                  ///< of light, that frames show
  bool glossy = false;                 ///< frames show what surfaces reflect like mirrors
  Cached<LightsInputs, LightArrangement> arranged;
  Cached<FieldInputs, std::unique_ptr<LightField>> memory;
  std::shared_ptr<StageProducts> products;  ///< null: nothing
  std::map<std::uint64_t, View> views;
  gpu::AccountPtr lightMemory = std::make_shared<gpu::Account>();  ///< of everything but `resources` and frames
  gpu::AccountPtr frameMemory = std::make_shared<gpu::Account>();
  gpu::AccountPtr charged;  ///< for what its tick makes now; null: for nobody

  /// Until it says something else. The engine does the same whenever a tick goes on.
  void charge(const gpu::AccountPtr& account) { gpu::chargeTo(charged = account); }
  LightField& field() { return *memory.product(); }
  const Palette& palette() const { return arranged.product().palette; }

  /// Takes the scene's lights and grid over, with the memory that they need; from the first time that guard cells are
  /// asked for, with them. Throws gpu::Failure when the field's memory cannot be had.
  void adopt(const Scene& scene, bool guarded);
  /// After a failed tick: nothing on the GPU is trusted any more.
  void invalidate();

 private:
  void keepVoxels(const LightsInputs& inputs);
  void keepMemory(const FieldGrid& grid, Transport transport);
};

}  // namespace lpv
