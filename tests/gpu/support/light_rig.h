#pragma once
// Lights for injection tests: meshes with texture coordinates and directions, poses, and what the reference makes of
// the same lights.

#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <vector>

#include "gpu/support/stage_rig.h"
#include "reference/emitter.h"
#include "reference/field.h"

namespace lpv::test {

inline constexpr VoxelMethod kFluxMethod = {Injection::kFlux, InjectionMethod::kCompute, 0};
inline constexpr VoxelMethod kCountMethod = {Injection::kCount, InjectionMethod::kCompute, 0};

/// Tests that share one rig per grid: compiling the programs is what takes the time.
class LightTest : public GlTest {
 public:
  static void TearDownTestSuite();

 protected:
  static const InjectRig& injected(const Grid& grid, const std::vector<EmittingLight>& lights,
                                   const VoxelMethod& method);

 private:
  static std::unique_ptr<InjectRig> rig_;
};

/// Grid space: translation, rotation by `angle` about `axis`, scale.
glm::dmat4 poseOf(const glm::dvec3& at, const glm::dvec3& scale, double angle = 0.7,
                  const glm::dvec3& axis = {1.0, 2.0, 3.0});
EmittingLight placed(const MeshPtr& mesh, const glm::dmat4& gridFromObject, const glm::dvec3& radiance,
                     bool twoSided = false, const TexturePtr& texture = nullptr);

/// The same mesh with new attributes per vertex; a null function keeps what there is.
using UvOf = std::function<glm::vec2(const glm::vec3& position, const glm::vec2& uv)>;
using DirectionOf = std::function<glm::vec3(const glm::vec3& position)>;
MeshPtr withAttributes(const MeshPtr& mesh, const UvOf& uvOf, const DirectionOf& directionOf);

/// Random triangles with uvs and directions within +-.9 of the origin: nothing about them is on a tie.
MeshPtr tangle(bool varying);
/// The 48 symmetries of the cube.
std::vector<glm::dmat3> cubeSymmetries();
/// A field turned about its middle.
reference::Field turned(const reference::Field& field, const glm::dmat3& symmetry);

/// The lights as the reference sees them.
std::vector<reference::Emitter> emittersOf(const Grid& grid, const std::vector<EmittingLight>& lights);

/// The injected field in W/sr.
reference::Field injectedOf(const InjectRig& rig);
/// The largest zeroth coefficient of any cell and colour.
double brightestCell(const reference::Field& field);
/// Largest difference as a share of the radianceScale cell of `want`; infinite where something is not finite or `want`
/// dark.
double relativeError(const reference::Field& got, const reference::Field& want);

/// One light's voxels: cell, then its lobes (pairs) and moments.
using VoxelMap = std::map<std::uint32_t, std::pair<std::uint32_t, std::vector<glm::vec4>>>;
/// Fails the test when a cell is there twice.
VoxelMap voxelsOf(const LightVoxels& voxels);

}  // namespace lpv::test
