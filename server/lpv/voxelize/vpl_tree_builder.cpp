#include "lpv/voxelize/vpl_tree_builder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "gpu/failure.h"
#include "lpv/pacing/chunked.h"

namespace lpv {

namespace {

/// Entries are numbered in floats.
constexpr std::uint32_t kMostTreeEntries = 1U << 24;
/// Nodes or VPLs of one piece: a few milliseconds without a GPU. A multiple of a work-group.
constexpr std::uint32_t kThreadsAtOnce = 1U << 17;
static_assert(kThreadsAtOnce % layout::kNodeGroup == 0);

std::size_t entryBytes(const gpu::Defines& variant) {
  const bool textured =
      std::find(variant.begin(), variant.end(), gpu::Defines::value_type("LPV_TEXTURED", "1")) != variant.end();
  return std::size_t(textured ? layout::kTexturedEntryTexels : layout::kPlainEntryTexels) * sizeof(glm::vec4);
}

/// Grows in powers of two: a light that moves has a few VPLs more or less every tick.
void makeRoom(VplTree& tree, std::size_t bytes) {
  if (tree.entries.size() >= bytes) return;
  tree.texels = {};
  tree.entries = {};  // first the old memory, then the new
  tree.entries = gpu::Buffer("tree entries", std::bit_ceil(bytes));
  tree.texels = gpu::BufferTexture("tree entries", tree.entries);
}

std::uint32_t nodesOf(const VplTree& tree, int level) {
  return tree.offsets[std::size_t(level) + 1] - tree.offsets[std::size_t(level)];
}

}  // namespace

VplTreeBuilder::VplTreeBuilder() : params_("tree params", sizeof(layout::TreeParams), gpu::BufferUse::kDynamic) {}

GpuTask VplTreeBuilder::pass(const VplTree& tree, const gpu::Defines& variant, TreePass pass, const TreeScales& scales,
                             const std::function<void()>& bindLight) {
  layout::TreeParams shape{};
  shape.lower = tree.box.lower;
  shape.upper = tree.box.upper;
  shape.levels = tree.levels;
  shape.level = pass.level;
  for (int i = 0; i < tree.levels; ++i) shape.nodesBefore[i / 4][i % 4] = tree.offsets[std::size_t(i)];
  shape.areaScale = float(scales.areaScale);
  shape.origin = glm::vec3(scales.origin);
  shape.cell = float(scales.cell);
  shape.shareOfUnit = 1.0 / scales.moment;
  for (std::uint32_t first = 0; first < pass.threads; first += kThreadsAtOnce) {
    const std::uint32_t threads = std::min(kThreadsAtOnce, pass.threads - first);
    shape.firstThread = first;
    params_.update(0, gpu::bytesOfValue(shape));
    bindLight();
    params_.bindUniform(layout::kParams);
    tree.nodes.bindStorage(layout::kTreeNodes);
    if (tree.entries) tree.entries.bindStorage(layout::kTreeEntries);
    pass.program.get(variant).dispatch((threads + layout::kNodeGroup - 1) / layout::kNodeGroup);
    gpu::memoryBarrier();
    if (threads == kThreadsAtOnce) co_yield submitted(Stage::kVoxelize, 0.0);
  }
}

GpuTask VplTreeBuilder::prepare(VplTree& tree) { co_await fillChunked(tree.nodes); }

GpuTask VplTreeBuilder::count(VplTree& tree, const gpu::Defines& variant, const std::function<void()>& bindLight) {
  const TreeScales none;
  for (int level = 0; level < tree.levels; ++level)
    co_await pass(tree, variant, {count_, level, nodesOf(tree, level)}, none, bindLight);
}

VplCounts VplTreeBuilder::read(const gpu::Readback& header) {
  layout::VoxelHeader read{};
  std::memcpy(&read, header.bytes().data(), sizeof read);
  return {.vpls = read.count,
          .degenerate = read.degenerate,
          .lost = read.lost,
          .entries = read.treeEntries,
          .cells = read.litCells};
}

GpuTask VplTreeBuilder::build(VplTree& tree, const VplCounts& counts, const gpu::Defines& variant,
                              const TreeScales& scales, const std::function<void()>& bindLight) {
  if (counts.entries > kMostTreeEntries) {
    throw gpu::Failure(exhausted("lights", "a light makes " + std::to_string(counts.entries) +
                                               " VPLs and nodes, more than the " + std::to_string(kMostTreeEntries) +
                                               " of its tree; use a coarser grid, or transport PROPAGATE"));
  }
  tree.entryCount = counts.entries;
  tree.vplCount = counts.vpls;
  tree.cellCount = counts.cells;
  tree.degenerate = counts.degenerate;
  if (counts.entries == 0) co_return;
  makeRoom(tree, counts.entries * entryBytes(variant));
  for (int level = tree.levels - 1; level >= 0; --level)
    co_await pass(tree, variant, {number_, level, nodesOf(tree, level)}, scales, bindLight);
  co_await pass(tree, variant, {leaves_, 0, counts.vpls}, scales, bindLight);
  for (int level = 1; level < tree.levels; ++level)
    co_await pass(tree, variant, {merge_, level, nodesOf(tree, level)}, scales, bindLight);
}

}  // namespace lpv
