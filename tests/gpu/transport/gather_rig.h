#pragma once
// Lights as trees of VPLs, and GATHER over them, stage by stage (MATHS.md 3b).

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "gpu/support/light_rig.h"
#include "lpv/transport/gather.h"
#include "reference/field.h"
#include "reference/gather.h"

namespace lpv::test {

inline constexpr VoxelMethod kVplMethod = {Injection::kFlux, InjectionMethod::kCompute, 0, true};
/// k of the distance rule that takes every VPL by itself.
inline constexpr double kNoMerging = std::numeric_limits<double>::infinity();

/// Voxelizes lights into VPLs and sums them. Programs are kept from one set of lights to the next.
class GatherRig {
 public:
  /// Other lights. `expectedVpls`: what the voxelizer is told that there were last time; 0 for nothing.
  void plant(const Grid& grid, std::vector<EmittingLight> lights, InjectionMethod method = InjectionMethod::kCompute,
             std::uint32_t expectedVpls = 0);
  /// The same number of lights, elsewhere, in the memory of those before where they fit; returns whether all did.
  bool move(std::vector<EmittingLight> moved);
  /// SH of incident radiance in every cell.
  reference::Field gather(double k);
  /// Adds to what the field holds, in these blocks.
  void gatherBlocks(double k, const ReceiverBlocks& blocks);
  /// All zero.
  void clear();

  reference::Field incident(int group = 0) const;
  /// The field as it lies in memory.
  std::vector<std::uint32_t> bits() const;

  std::vector<EmittingLight> lights;
  Sectors sectors = Sectors::kNone;  ///< set before plant()
  Palette palette;
  std::vector<LightVoxelsPtr> voxels;
  std::unique_ptr<LightField> field;
  LightSums sums;  ///< empty: all is summed anew
  StageClock clock;  ///< what GATHER's pieces are measured by: nothing is known of the device

 private:
  void voxelize(const SceneResources& resources, std::size_t light, InjectionMethod method);

  Voxelizer voxelizer_;
  Gatherer gatherer_;
  SceneCache cache_;
};

/// Tests that share one rig: compiling the programs is what takes the time.
class GatherTest : public GlTest {
 public:
  static void TearDownTestSuite();

 protected:
  static GatherRig& rig();
  /// The rig with these lights.
  static GatherRig& planted(const Grid& grid, const std::vector<EmittingLight>& lights);
  /// What they send to every cell.
  static reference::Field gathered(const Grid& grid, const std::vector<EmittingLight>& lights, double k);

 private:
  static std::unique_ptr<GatherRig> rig_;
};

/// A VPL as transport reads it: grid space, cell units.
struct VplEntry {
  glm::dvec3 position{0.0};
  double area = 0.0;
  glm::dvec3 direction{0.0};  ///< area x mean direction of emission
  double spread = 0.0;
  glm::dmat3 positionCovariance{0.0};  ///< cell^2
  glm::dvec3 colour{1.0};
};

/// As the reference has it, white.
reference::Vpl referenceOf(const VplEntry& entry);

/// A header and what is below it.
struct TreeNode {
  glm::dvec3 centre{0.0};
  double edge = 1.0;
  std::vector<VplEntry> vpls;
  std::vector<TreeNode> children;
};

/// The words of a tree's entries.
std::vector<std::uint32_t> entryBits(const LightVoxels& voxels);
/// The entries put together again; the test fails where a header leads to the wrong entry or an entry is left over.
/// An edge of 0 where there is no light.
TreeNode treeOf(const LightVoxels& voxels);
/// Leaves below a node, itself included.
std::vector<TreeNode> leavesOf(const TreeNode& node);

/// VPLs by memory order of their cells (z, y, x) and normal bin.
using VplMap = std::map<std::pair<std::array<int, 3>, int>, VplEntry>;
VplMap vplsOf(const LightVoxels& voxels);
/// The reference's, of a light's front; colours as shares of `radianceScale`.
VplMap expectedVpls(const Grid& grid, const EmittingLight& light, double radianceScale);

/// GATHER in double with the nodes that the GPU's blocks choose, light by light. `group`: of those alone, or all (-1).
reference::Field expectedIncident(const Grid& grid, const std::vector<EmittingLight>& lights, double k, int group = -1);

}  // namespace lpv::test
