#pragma once
// What the GPU thread keeps of a session between ticks, and what of it is still true of a new scene.

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "engine/engine.h"
#include "gpu/readback.h"
#include "lpv/frame/shading.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/light_voxels.h"
#include "lpv/resources/lights.h"
#include "lpv/resources/palette.h"
#include "lpv/resources/scene_cache.h"
#include "lpv/transport/emitter_list.h"
#include "lpv/transport/gather.h"
#include "lpv/transport/light_grouping.h"
#include "lpv/transport/volume.h"

namespace lpv {

/// What is kept for one subscriber's frames (FrameRequest::view), or made for one frame only.
struct View {
  std::unique_ptr<Gbuffer> gbuffer;
  std::unique_ptr<FrameTargets> targets;
  gpu::Readback readback;
};

struct SessionState {
  std::shared_ptr<StageClock> clock = std::make_shared<StageClock>();
  SceneResources resources;

  // What the field on the GPU was made from.
  std::vector<EmittingLight> lights;
  VoxelMethod method;
  std::vector<LightVoxelsPtr> voxels;        ///< per light
  std::vector<LightVoxelsPtr> injectedVoxels;///< what the injected field holds
  Palette palette;
  CellBox box;                      ///< holds every cell that emits
  int iterations = 0;               ///< PROPAGATE
  bool clampFaces = false;          ///< PROPAGATE
  double k = 0.0;                   ///< GATHER
  std::vector<std::string> groups;  ///< of lights, by name, in the order of the field's
  bool ownGroups = false;           ///< chosen, where the scene names none
  std::unique_ptr<LightField> field;

  // What of it is up to date.
  bool injected = false;
  bool transported = false;
  bool textured = false;
  bool directMade = false;
  EmitterBufferList emitters;
  ReceiverBlocks gathered;          ///< GATHER: the blocks that are
  ReceiverBlocks surfaceBlocks;     ///< those that frames read,
  std::map<std::string, SurfacePtr> blockSurfaces;  ///< with these surfaces
  std::optional<IncidentTextures> textures;
  VolumePtr transportedVolume;      ///< null: not read back since the field changed
  VolumePtr injectedVolume;

  std::map<std::uint64_t, View> views;

  // Scratch and counts.
  gpu::Buffer incidentVolume;              ///< 12 floats per cell, between the volume stage and its copy
  gpu::Readback volumeReadback, injectedReadback, countersReadback, emitterListReadback, emitterDistanceReadback;
  std::uint64_t trianglesSkipped = 0;
  std::uint64_t touchedCells = 0;
  std::uint64_t clampedCells = 0;

  /// Takes the scene's lights, grid and options over and marks what has to be made anew. Throws gpu::Failure when the
  /// field's memory cannot be had.
  void adopt(const Scene& scene);
  /// After a failed tick: nothing on the GPU is trusted any more.
  void invalidate();

 private:
  void adoptLights(const Scene& scene, std::vector<EmittingLight> now);
  void keepVoxels(const glm::ivec3& dims);
  void forgetTransported();
};

}  // namespace lpv
