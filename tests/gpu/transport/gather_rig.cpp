#include "gpu/transport/gather_rig.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lpv/pacing/stage_clock.h"
#include "reference/sh.h"

namespace lpv::test {

namespace {

const glm::ivec3 kBlock(layout::kBlockX, layout::kBlockY, layout::kBlockZ);

std::array<int, 3> keyOf(const glm::ivec3& cell) { return {cell.z, cell.y, cell.x}; }

int texelsPerEntry(const LightVoxels& voxels) {
  return voxels.momentsPerCell > 1 ? layout::kTexturedEntryTexels : layout::kPlainEntryTexels;
}

/// Reads entries one after the other.
class EntryReader {
 public:
  explicit EntryReader(const LightVoxels& voxels)
      : texels_(read<glm::vec4>(voxels.tree->entries)), texelsPerEntry_(texelsPerEntry(voxels)) {}

  std::uint32_t at() const { return at_; }

  /// The node that starts here, and all below it.
  TreeNode node() {
    TreeNode node;
    const glm::vec4 where = texel(0), what = texel(1);
    const auto vpls = std::uint32_t(what.x), after = std::uint32_t(what.y);
    node.centre = glm::dvec3(where);
    const bool coloured = texelsPerEntry_ == layout::kTexturedEntryTexels;
    node.edge = double(where.w) / (coloured ? double(layout::kColouredSize) : 1.0);
    ++at_;
    for (std::uint32_t i = 0; i < vpls; ++i) node.vpls.push_back(vpl());
    while (at_ < after) node.children.push_back(this->node());
    EXPECT_EQ(at_, after) << "the node at " << where.x << " " << where.y << " " << where.z << ", edge " << where.w;
    return node;
  }

 private:
  glm::vec4 texel(int i) const { return texels_.at(std::size_t(at_) * std::size_t(texelsPerEntry_) + std::size_t(i)); }

  VplEntry vpl() {
    VplEntry v;
    v.position = glm::dvec3(texel(0));
    v.area = double(texel(0).w);
    v.direction = glm::dvec3(texel(1));
    v.spread = double(texel(1).w);
    const glm::dvec3 on(texel(2)), off(texel(3));
    v.positionCovariance = glm::dmat3(on.x, off.x, off.y, off.x, on.y, off.z, off.y, off.z, on.z);
    EXPECT_NEAR(texel(2).w, on.x + on.y + on.z, 1e-5 * (on.x + on.y + on.z));
    if (texelsPerEntry_ == layout::kTexturedEntryTexels) v.colour = glm::dvec3(texel(4));
    ++at_;
    return v;
  }

  std::vector<glm::vec4> texels_;
  int texelsPerEntry_;
  std::uint32_t at_ = 0;
};

/// Bins that hold light, in ascending order, of every leaf of the light's box.
std::map<std::array<int, 3>, std::vector<int>> binsOf(const VplTree& tree) {
  const std::vector<glm::uvec4> nodes = read<glm::uvec4>(tree.nodes);
  std::map<std::array<int, 3>, std::vector<int>> bins;
  std::size_t leaf = 0;
  reference::forEachCell(tree.box.upper - tree.box.lower, [&](const glm::ivec3& cell) {
    const glm::uvec4& node = nodes[leaf++];
    const std::uint64_t mask = std::uint64_t(node.y) << 32 | node.x;
    for (int bin = 0; bin < 64; ++bin) {
      if (mask >> bin & 1) bins[keyOf(tree.box.lower + cell)].push_back(bin);
    }
  });
  return bins;
}

/// The light as it is voxelized: its flat patches merged (tests/unit/scene/flat_patches_test.cpp), where snapping would
/// see how they were cut up.
std::vector<reference::Emitter> voxelizedEmittersOf(const Grid& grid, EmittingLight light) {
  if (light.texture == nullptr && light.mesh->directions.empty() && !light.mesh->merged.empty()) {
    auto mesh = std::make_shared<Mesh>(*light.mesh);
    mesh->triangles = mesh->merged;
    light.mesh = mesh;
  }
  return emittersOf(grid, {light});
}

void addIncident(reference::Field& field, const Grid& grid, const EmittingLight& light, double k) {
  const reference::VplTree tree(reference::cellVpls(grid, voxelizedEmittersOf(grid, light)));
  reference::forEachCell((grid.dims + kBlock - 1) / kBlock, [&](const glm::ivec3& block) {
    const glm::ivec3 low = block * kBlock, high = glm::min(low + kBlock, grid.dims) - 1;
    const double rule = light.texture == nullptr ? k : k * double(layout::kColouredSize);
    const std::vector<reference::Vpl> vpls = tree.seenFrom(low, high, rule);
    reference::forEachCell(high - low + 1, [&](const glm::ivec3& cell) {
      const auto incident = reference::incidentFrom(vpls, grid.cellCentre(low + cell), grid.cell);
      for (std::size_t c = 0; c < 3; ++c) field.at(low + cell)[c] += incident[c];
    });
  });
}

}  // namespace

void GatherRig::plant(const Grid& grid, std::vector<EmittingLight> l, InjectionMethod method,
                      std::uint32_t expectedVpls) {
  lights = std::move(l);
  palette = choosePalette(lights);
  int groups = 1;
  for (const EmittingLight& light : lights) groups = std::max(groups, light.group + 1);
  if (sectors != Sectors::kNone) groups = layout::kSectors;
  const bool same = field && field->grid == grid && field->channels == palette.channels && field->groups == groups;
  if (!same) field = std::make_unique<LightField>(grid, palette.channels, groups, Transport::kGather);
  const SceneResources resources = upload(cache_, lights);
  voxels.clear();
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const CellBox box = cellsAround({lights[i]}, grid.dims);
    voxels.push_back(std::make_shared<LightVoxels>(box, lights[i].texture == nullptr ? 1 : 3, true));
    voxels[i]->tree->vplCount = expectedVpls;
    voxelize(resources, i, method);
  }
  clear();
}

void GatherRig::voxelize(const SceneResources& resources, std::size_t i, InjectionMethod method) {
  const EmittingLight& light = lights[i];
  const GpuLightTexture* texture = light.texture ? resources.lightTextures.at(light.texture).get() : nullptr;
  voxels[i]->source = {light.mesh, light.texture, light.gridFromObject, field->grid.dims, kVplMethod};
  voxels[i]->source.method.method = method;
  const StageClock unmeasured;
  finish(voxelizer_.run(*field, *resources.meshes.at(light.mesh), texture, *voxels[i], {&unmeasured}));
}

bool GatherRig::move(std::vector<EmittingLight> moved) {
  lights = std::move(moved);
  const SceneResources resources = upload(cache_, lights);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (!voxels[i]->takes(cellsAround({lights[i]}, field->grid.dims), lights[i].texture == nullptr ? 1 : 3, true))
      return false;
    voxelize(resources, i, InjectionMethod::kCompute);
  }
  return true;
}

void GatherRig::clear() {
  field->pingPong[0].buffer.clear();
  field->emitterDistance.clear();
}

void GatherRig::gatherBlocks(double k, const ReceiverBlocks& blocks) {
  const GatheredLights all = {lights, voxels, palette, k, sectors};
  finish(gatherer_.run(*field, all, blocks, sums, {&clock}));
}

reference::Field GatherRig::gather(double k) {
  clear();
  gatherBlocks(k, allBlocks(field->grid.dims));
  return incident();
}

reference::Field GatherRig::incident(int group) const { return fieldOf(field->transported(), *field, palette, group); }

std::vector<std::uint32_t> GatherRig::bits() const { return read<std::uint32_t>(field->transported().buffer); }

std::unique_ptr<GatherRig> GatherTest::rig_;

void GatherTest::TearDownTestSuite() { rig_.reset(); }

GatherRig& GatherTest::rig() {
  if (!rig_) rig_ = std::make_unique<GatherRig>();
  return *rig_;
}

GatherRig& GatherTest::planted(const Grid& grid, const std::vector<EmittingLight>& lights) {
  rig().plant(grid, lights);
  return rig();
}

reference::Field GatherTest::gathered(const Grid& grid, const std::vector<EmittingLight>& lights, double k) {
  return planted(grid, lights).gather(k);
}

std::vector<std::uint32_t> entryBits(const LightVoxels& voxels) {
  if (voxels.tree->entryCount == 0) return {};
  std::vector<std::uint32_t> words = read<std::uint32_t>(voxels.tree->entries);
  words.resize(std::size_t(voxels.tree->entryCount) * 4 * std::size_t(texelsPerEntry(voxels)));
  return words;
}

reference::Vpl referenceOf(const VplEntry& entry) {
  reference::Vpl vpl;
  vpl.area = vpl.weight = entry.area;
  vpl.areaNormal = entry.direction;
  vpl.areaRadiance = glm::dvec3(entry.area);
  vpl.weightedPosition = entry.area * entry.position;
  vpl.weightedSquare = entry.area * (entry.positionCovariance + glm::outerProduct(entry.position, entry.position));
  return vpl;
}

TreeNode treeOf(const LightVoxels& voxels) {
  TreeNode root;
  root.edge = 0.0;
  if (voxels.tree->entryCount == 0) return root;
  EntryReader reader(voxels);
  root = reader.node();
  EXPECT_EQ(reader.at(), voxels.tree->entryCount) << "entries that no walk reaches";
  return root;
}

std::vector<TreeNode> leavesOf(const TreeNode& node) {
  if (node.children.empty()) return {node};
  std::vector<TreeNode> leaves;
  for (const TreeNode& child : node.children) {
    const std::vector<TreeNode> below = leavesOf(child);
    leaves.insert(leaves.end(), below.begin(), below.end());
  }
  return leaves;
}

VplMap vplsOf(const LightVoxels& voxels) {
  VplMap vpls;
  if (voxels.tree->entryCount == 0) return vpls;
  const auto bins = binsOf(*voxels.tree);
  for (const TreeNode& leaf : leavesOf(treeOf(voxels))) {
    EXPECT_EQ(leaf.edge, 1.0);
    const std::array<int, 3> cell = keyOf(glm::ivec3(glm::floor(leaf.centre)));
    const std::vector<int>& here = bins.at(cell);
    EXPECT_EQ(leaf.vpls.size(), here.size());
    for (std::size_t i = 0; i < std::min(here.size(), leaf.vpls.size()); ++i) vpls[{cell, here[i]}] = leaf.vpls[i];
  }
  return vpls;
}

VplMap expectedVpls(const Grid& grid, const EmittingLight& light, double radianceScale) {
  EmittingLight front = light;
  front.twoSided = false;
  VplMap vpls;
  for (const reference::CellVpls& cell : reference::cellVpls(grid, voxelizedEmittersOf(grid, front))) {
    for (const auto& [bin, vpl] : cell.bins) {
      const double face = grid.cell * grid.cell;
      vpls[{keyOf(cell.cell), bin}] = {(vpl.position() - grid.origin) / grid.cell,
                                       vpl.area / face,
                                       vpl.areaNormal / face,
                                       reference::spreadOf(vpl) / face,
                                       vpl.extent() / face,
                                       vpl.radiance() / (light.radiance * radianceScale)};
    }
  }
  return vpls;
}

reference::Field expectedIncident(const Grid& grid, const std::vector<EmittingLight>& lights, double k, int group) {
  reference::Field field(grid.dims);
  for (const EmittingLight& light : lights) {
    if (group < 0 || light.group == group) addIncident(field, grid, light, k);
  }
  return field;
}

}  // namespace lpv::test
