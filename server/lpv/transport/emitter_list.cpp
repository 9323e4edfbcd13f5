#include "lpv/transport/emitter_list.h"

#include <algorithm>
#include <bit>

#include "gpu/gl.h"

#include "scene/emitter_list.h"
#include "shaders/layout.h"

namespace lpv {

static_assert(float(kNearFieldBegin) == layout::kNearFieldBegin && float(kNearFieldEnd) == layout::kNearFieldEnd);

namespace {

/// Corners in grid space, counter-clockwise seen from the front: a mirrored transform keeps the object-space outer
/// side.
void addPolygons(const EmittingLight& light, std::vector<glm::vec4>& texels) {
  for (glm::uvec3 t : light.mesh->evenTriangles()) {
    if (light.mirrored) std::swap(t.y, t.z);
    for (int i = 0; i < 3; ++i) {
      const glm::dvec4 object(glm::dvec3(light.mesh->positions[t[i]]), 1.0);
      texels.emplace_back(glm::vec3(light.gridFromObject * object), 0.0F);
    }
  }
}

int texelsPerEntry(const LightVoxels& voxels) {
  return voxels.momentsPerCell > 1 ? layout::kTexturedEntryTexels : layout::kPlainEntryTexels;
}

/// Texels of a tree's entries.
std::size_t entryTexels(const LightVoxels& voxels) {
  return voxels.tree->entryCount * std::size_t(texelsPerEntry(voxels));
}

}  // namespace

void choosePolygons(std::vector<EmittingLight>& lights, Transport transport, double k) {
  const bool accurate = transport == Transport::kDirect && k >= kAccurateOpeningRatio;
  const std::size_t most = accurate ? kMostPolygons : kFewPolygons;
  std::vector<EmittingLight*> candidates;
  for (EmittingLight& light : lights) {
    light.polygons = false;
    if (isConstant(light) && light.mesh->evenTriangles().size() <= most) candidates.push_back(&light);
  }
  std::ranges::stable_sort(candidates, {}, [](const EmittingLight* l) { return l->mesh->evenTriangles().size(); });
  std::size_t all = 0;
  for (EmittingLight* light : candidates) {
    all += light->mesh->evenTriangles().size();
    light->polygons = all <= kMostPolygonsOfAll;
  }
}

void EmitterBufferList::make(const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels,
                             double k) {
  everywhere = lookedAtEverywhere(lights);
  std::vector<glm::vec4> head(1 + 2 * lights.size());
  head[0] = {float(lights.size()), float(std::min(k, 1e15)), 0.0F, 0.0F};
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (!lights[i].polygons) continue;
    const std::size_t first = head.size();
    addPolygons(lights[i], head);
    head[1 + 2 * i] = glm::vec4(lights[i].radiance, 0.0);
    head[2 + 2 * i] = {float(first), float(lights[i].mesh->evenTriangles().size()), lights[i].twoSided ? 2.0F : 1.0F,
                       0.0F};
  }
  count = head.size();
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (lights[i].polygons) continue;
    head[1 + 2 * i] = glm::vec4(lights[i].radiance * voxels[i]->radianceScale, 1.0);
    head[2 + 2 * i] = {float(count), float(voxels[i]->tree->entryCount), lights[i].twoSided ? 2.0F : 1.0F,
                       float(texelsPerEntry(*voxels[i]))};
    count += entryTexels(*voxels[i]);
  }
  if (texels.size() < count * sizeof(glm::vec4)) {
    view = {};
    texels = {};  // first the old memory, then the new
    texels = gpu::Buffer("direct lights", std::bit_ceil(count * sizeof(glm::vec4)), gpu::BufferUse::kDynamic);
    view = gpu::BufferTexture("direct lights", texels);
  }
  texels.update(0, gpu::bytesOf(std::span<const glm::vec4>(head)));
  for (std::size_t i = 0, at = head.size(); i < lights.size(); ++i) {
    if (lights[i].polygons || voxels[i]->tree->entryCount == 0) continue;
    const std::size_t texelCount = entryTexels(*voxels[i]);
    glCopyNamedBufferSubData(voxels[i]->tree->entries.id(), texels.id(), 0, GLintptr(at * sizeof(glm::vec4)),
                             GLsizeiptr(texelCount * sizeof(glm::vec4)));
    at += texelCount;
  }
}

}  // namespace lpv
