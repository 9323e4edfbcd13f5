#include "lpv/resources/patch_set.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <utility>

#include "scene/triangle_bvh.h"

namespace lpv {

namespace {

/// Of shaders/visibility/patches.glsl.
struct StoredPatch {
  glm::vec4 place{0.0F}, normal{0.0F}, albedo{0.0F}, direct{0.0F}, arriving[2] = {glm::vec4(0.0F), glm::vec4(0.0F)};
  glm::vec4 corners[3] = {glm::vec4(0.0F), glm::vec4(0.0F), glm::vec4(0.0F)};
  float wanted = 0.0F, scale[2] = {1.0F, 1.0F}, of = 0.0F;
  glm::vec4 slope{0.0F, 0.0F, 0.0F, 1.0F};
};

StoredPatch stored(const Patch& p, const Grid& grid) {
  StoredPatch to;
  to.place = glm::vec4(glm::vec3(grid.gridFromWorld(glm::dvec3(p.position))), p.area / float(grid.cell * grid.cell));
  to.normal = glm::vec4(p.normal, p.triangle ? float(p.places) : 0.0F);
  to.albedo = glm::vec4(p.albedo, 0.0F);
  for (std::size_t i = 0; p.triangle && i < 3; ++i)
    to.corners[i] = glm::vec4(glm::vec3(grid.gridFromWorld(glm::dvec3((*p.triangle)[i]))), 1.0F);
  to.corners[2].w = p.reach > 0.0F ? p.reach * p.reach / float(grid.cell * grid.cell) : to.corners[2].w;
  to.corners[1].w = p.reach > 0.0F ? -1.0F : to.corners[1].w;
  return to;
}

std::vector<StoredPatch> stored(const PatchedScene& source, const Grid& grid) {
  std::vector<StoredPatch> out;
  out.reserve(source.patches.size() + source.folds.pieces.size());
  for (const Patch& p : source.patches) out.push_back(stored(p, grid));
  for (std::size_t i = 0; i < source.folds.pieces.size(); ++i) {
    out.push_back(stored(source.folds.pieces[i], grid));
    StoredPatch& patch = out[source.folds.patchOf[i]];
    out.back().of = float(source.folds.patchOf[i]);
    if (patch.albedo.w == 0.0F) patch.normal.w = float(i);
    patch.albedo.w += 1.0F;
  }
  return out;
}

/// As shaders/visibility/folds.glsl reads them: for each surface where its triangles begin, 0 for none of them, and how
/// far it is from a piece of the front to that of the back; then a word a triangle, in the order of the mesh's BVH.
std::vector<std::uint32_t> foldWords(const Folds& folds, const Scene& scene) {
  std::vector<std::uint32_t> out(2 * folds.surfaces.size());
  std::size_t number = 0;
  for (const auto& [name, surface] : scene.surfaces) {
    const Folds::OfSurface& of = folds.surfaces[number];
    if (!of.triangles.empty()) {
      out[2 * number] = std::uint32_t(out.size());
      out[2 * number + 1] = of.toBack;
      for (const std::uint32_t i : bvhOf(surface->mesh)->indices)
        out.push_back(of.triangles[i].first << layout::kPieceBits | of.triangles[i].count);
    }
    ++number;
  }
  return out;
}

constexpr int kMostOfList = 4096;

/// The last four may be incomplete: the last patch is in it more than once.
PatchList listOf(int first, int count) {
  const int fours = (count + 3) / 4;
  const auto groups = std::uint32_t((fours + layout::kNearFieldGroup - 1) / layout::kNearFieldGroup);
  std::vector<std::uint32_t> words = {groups, 1, 1, std::uint32_t(fours)};
  for (int i = 0; i < 4 * fours; ++i) words.push_back(std::uint32_t(first + std::min(i, count - 1)));
  return {gpu::Buffer("patch list", gpu::bytesOf(std::span<const std::uint32_t>(words))), count};
}

std::vector<PatchList> listsOf(int first, int count) {
  std::vector<PatchList> out;
  for (int i = 0; i < count; i += kMostOfList) out.push_back(listOf(first + i, std::min(kMostOfList, count - i)));
  return out;
}

/// From what one patch sends to what the next one does: whole texels.
int strideOf(std::size_t patches) {
  return (int(patches) + layout::kPatchRows - 1) / layout::kPatchRows * layout::kPatchRows;
}

std::size_t pairs(std::size_t patches) { return patches * std::size_t(strideOf(patches)); }

std::size_t bytesOfVec4(std::size_t count) { return count * sizeof(glm::vec4); }

}  // namespace

PatchSet::PatchSet(PatchedScenePtr patched, const Scene& scene, const Grid& grid, bool throughPanes)
    : source(std::move(patched)),
      cell(grid.cell),
      count(int(source->patches.size())),
      pieces(int(source->folds.pieces.size())),
      patches("patches", gpu::bytesOf(std::span<const StoredPatch>(stored(*source, grid)))),
      exchange("patch exchange", pairs(source->patches.size()) * sizeof(float)),
      exchangeTexels("patch exchange", exchange),
      sent("patch sent", bytesOfVec4(2 * source->patches.size()), gpu::BufferUse::kDevice, gpu::Undefined{}),
      sentTexels("patch sent", sent),
      shares(throughPanes ? gpu::Buffer("patch shares", pairs(source->patches.size()) * sizeof(std::uint32_t))
                          : gpu::Buffer()),
      points(listsOf(0, count)),
      piecePoints(listsOf(count, pieces)),
      shadows("patch shadows", std::size_t(kMostOfList)),
      lights("patch lights", bytesOfVec4(source->patches.size() * layout::kLightPointTexels)),
      lightTexels("patch lights", lights) {
  if (pieces == 0) return;
  pieceLights = gpu::Buffer("piece lights", bytesOfVec4(source->folds.pieces.size()));
  foldTriangles =
      gpu::Buffer("fold triangles", gpu::bytesOf(std::span<const std::uint32_t>(foldWords(source->folds, scene))));
}

void PatchSet::bind() const {
  patches.bindStorage(layout::kPatches);
  if (!folded()) return;
  pieceLights.bindStorage(layout::kPieceLights);
  foldTriangles.bindStorage(layout::kFoldTriangles);
  if (foldHits) foldHits.bindStorage(layout::kFoldHits);
}

std::size_t PatchSet::bytesOfPatches() const { return std::size_t(count) * sizeof(StoredPatch); }

std::vector<glm::dvec3> PatchSet::slopesIn(std::span<const std::byte> copied) const {
  std::vector<StoredPatch> stored(static_cast<std::size_t>(count));
  std::memcpy(stored.data(), copied.data(), bytesOfPatches());
  std::vector<glm::dvec3> out;
  out.reserve(stored.size());
  for (const StoredPatch& patch : stored) out.push_back(glm::dvec3(glm::vec3(patch.slope)) / cell);
  return out;
}

void PatchSet::forgetFoldHits(int foldTurns) {
  const std::size_t bytes = std::size_t(pieces) * std::size_t(foldTurns * layout::kFoldRays) * sizeof(std::int32_t);
  if (foldHits.size() != bytes) foldHits = gpu::Buffer("fold hits", bytes, gpu::BufferUse::kDevice, gpu::Undefined{});
  foldHits.fill(std::uint32_t(layout::kNoRay));
}

layout::PatchParams PatchSet::params() const {
  layout::PatchParams params = {};
  params.count = count;
  params.stride = strideOf(source->patches.size());
  params.pieces = pieces;
  return params;
}

}  // namespace lpv
