#pragma once
// Stages run one by one on the test's own context.

#include <glm/glm.hpp>
#include <vector>

#include "gpu/support/gl_test.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/lights.h"
#include "lpv/resources/palette.h"
#include "lpv/resources/scene_cache.h"
#include "lpv/transport/inject.h"
#include "lpv/voxelize/voxelize.h"
#include "reference/field.h"
#include "scene/scene.h"

namespace lpv::test {

/// Runs a coroutine to its end.
void finish(GpuTask task);

/// A mesh of separate triangles; throws when it is not one.
MeshPtr meshOf(const std::vector<std::array<glm::vec3, 3>>& triangles);

/// `mesh` as a light of constant radiance, grid cells 1 m at the origin.
EmittingLight lightOf(const MeshPtr& mesh, const glm::dvec3& radiance, bool twoSided = false);

/// One cube of 1 m cells at the origin.
Grid unitGrid(const glm::ivec3& dims);

/// Meshes and textures of the lights on the GPU.
SceneResources upload(SceneCache& cache, const std::vector<EmittingLight>& lights);

/// One group of a field as doubles, its channels times the palette's colours.
reference::Field fieldOf(const FieldBuffer& buffer, const LightField& field, const Palette& palette, int group = 0);
/// The other way: channel k of the halo layout is colour k. `channels` 3.
std::vector<glm::vec4> haloOf(const reference::Field& field);

/// A field of random coefficients within `margin` cells of the border zero.
reference::Field randomField(const glm::ivec3& dims, std::uint32_t seed, int margin = 0);

/// Voxelizes and injects; the result is in `field.injected`.
struct InjectRig {
  InjectRig(const Grid& grid, std::vector<EmittingLight> lights, const VoxelMethod& method = {});
  /// Runs both stages once more, for instance after `lights` were changed.
  void run();
  /// Other lights, of no more channels than the first had, through the same programs.
  void runWith(std::vector<EmittingLight> others, const VoxelMethod& method);
  /// The largest rounding error that a light's voxels promise.
  double roundingError() const;
  /// Cells that hold light.
  std::uint32_t touched() const;

  std::vector<EmittingLight> lights;
  VoxelMethod method;
  Palette palette;
  std::vector<LightVoxelsPtr> voxels;
  LightField field;

 private:
  Voxelizer voxelizer_;
  Injector injector_;
  SceneCache cache_;
};

}  // namespace lpv::test
