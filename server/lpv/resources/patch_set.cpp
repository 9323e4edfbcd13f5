#include "lpv/resources/patch_set.h"

#include <algorithm>
#include <span>
#include <utility>

namespace lpv {

namespace {

/// Of shaders/visibility/patches.glsl.
struct StoredPatch {
  glm::vec4 place{0.0F}, normal{0.0F}, albedo{0.0F}, direct{0.0F}, arriving[2] = {glm::vec4(0.0F), glm::vec4(0.0F)};
  glm::vec4 corners[3] = {glm::vec4(0.0F), glm::vec4(0.0F), glm::vec4(0.0F)};
  float wanted = 0.0F, scale[2] = {1.0F, 1.0F}, pad = 0.0F;
};

std::vector<StoredPatch> stored(const std::vector<Patch>& patches, const Grid& grid) {
  std::vector<StoredPatch> out;
  for (const Patch& p : patches) {
    StoredPatch& to = out.emplace_back();
    to.place = glm::vec4(glm::vec3(grid.gridFromWorld(glm::dvec3(p.position))), p.area / float(grid.cell * grid.cell));
    to.normal = glm::vec4(p.normal, 0.0F);
    to.albedo = glm::vec4(p.albedo, 0.0F);
    for (std::size_t i = 0; p.triangle && i < 3; ++i)
      to.corners[i] = glm::vec4(glm::vec3(grid.gridFromWorld(glm::dvec3((*p.triangle)[i]))), 1.0F);
  }
  return out;
}

/// The last four may be incomplete: the last patch is in it more than once.
gpu::Buffer listOf(int count) {
  const int fours = (count + 3) / 4;
  const auto groups = std::uint32_t((fours + layout::kNearFieldGroup - 1) / layout::kNearFieldGroup);
  std::vector<std::uint32_t> words = {groups, 1, 1, std::uint32_t(fours)};
  for (int i = 0; i < 4 * fours; ++i) words.push_back(std::uint32_t(std::min(i, count - 1)));
  return gpu::Buffer("patch list", gpu::bytesOf(std::span<const std::uint32_t>(words)));
}

std::size_t bytesOfVec4(std::size_t count) { return count * sizeof(glm::vec4); }

}  // namespace

PatchSet::PatchSet(std::vector<Patch> all, const Grid& grid, bool throughPanes)
    : source(std::move(all)),
      count(int(source.size())),
      patches("patches", gpu::bytesOf(std::span<const StoredPatch>(stored(source, grid)))),
      exchange("patch exchange", source.size() * source.size() * sizeof(float)),
      shares(throughPanes ? gpu::Buffer("patch shares", source.size() * source.size() * sizeof(std::uint32_t))
                          : gpu::Buffer()),
      points(listOf(count)),
      shadows("patch shadows", bytesOfVec4((source.size() + 3) / 4 * 4 * kShadowPointTexels)),
      lights("patch lights", bytesOfVec4(source.size() * layout::kLightPointTexels)),
      lightTexels("patch lights", lights) {}

layout::PatchParams PatchSet::params() const {
  layout::PatchParams params = {};
  params.count = count;
  return params;
}

}  // namespace lpv
