#include "lpv/transport/emitter_list.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <future>
#include <optional>
#include <utility>

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

float sidesOf(const EmittingLight& light) { return light.twoSided ? 2.0F : 1.0F; }

constexpr std::size_t kTexel = sizeof(glm::vec4);

/// Those of the lights that are looked at as trees over their triangles; no mesh: others.
using TreeLights = std::vector<std::pair<MeshPtr, glm::dmat4>>;

/// The others' are empty. Takes as long as new trees do.
std::vector<PlacedEmitterTree> placedTrees(const TreeLights& lights) {
  std::vector<PlacedEmitterTree> out;
  for (const auto& [mesh, gridFromObject] : lights)
    out.push_back(mesh == nullptr ? PlacedEmitterTree() : emitterTreeOf(mesh, gridFromObject));
  return out;
}

/// The same at once; none where a tree has to be made.
std::optional<std::vector<PlacedEmitterTree>> knownTrees(const TreeLights& lights) {
  std::vector<PlacedEmitterTree> out(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (lights[i].first == nullptr) continue;
    out[i] = knownEmitterTreeOf(lights[i].first, lights[i].second);
    if (out[i].tree == nullptr) return std::nullopt;
  }
  return out;
}

}  // namespace

void chooseTriangles(std::vector<EmittingLight>& lights, Transport transport, double k) {
  const bool accurate = transport == Transport::kDirect && k >= kAccurateOpeningRatio;
  const std::size_t most = accurate ? kMostPolygons : kFewPolygons;
  std::vector<EmittingLight*> candidates;
  for (EmittingLight& light : lights) {
    light.polygons = false;
    light.tree = isConstant(light) && light.mesh->evenTriangles().size() <= kMostTreeTriangles;
    if (light.tree && light.mesh->evenTriangles().size() <= most) candidates.push_back(&light);
  }
  std::ranges::stable_sort(candidates, {}, [](const EmittingLight* l) { return l->mesh->evenTriangles().size(); });
  std::size_t all = 0;
  for (EmittingLight* light : candidates) {
    all += light->mesh->evenTriangles().size();
    light->polygons = all <= kMostPolygonsOfAll;
    light->tree = !light->polygons;
  }
}

void EmitterBufferList::keepTrees(const std::vector<PlacedEmitterTree>& placed) {
  std::map<EmitterTreePtr, gpu::Buffer> kept;
  for (const PlacedEmitterTree& p : placed) {
    if (p.tree == nullptr || kept.contains(p.tree)) continue;
    const auto known = trees_.find(p.tree);
    kept[p.tree] = known != trees_.end()
                       ? std::move(known->second)
                       : gpu::Buffer("emitter tree", gpu::bytesOf(std::span<const glm::vec4>(p.tree->texels)));
  }
  trees_ = std::move(kept);
}

GpuTask EmitterBufferList::make(const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels,
                                const EmitterListInputs& inputs) {
  TreeLights shapes;
  for (const EmittingLight& light : lights)
    shapes.emplace_back(light.tree ? light.mesh : MeshPtr(), light.gridFromObject);
  std::optional<std::vector<PlacedEmitterTree>> placed = knownTrees(shapes);
  if (!placed) {
    auto made = std::async(std::launch::async, placedTrees, std::move(shapes));
    while (made.wait_for(std::chrono::microseconds(100)) != std::future_status::ready) co_yield yield();
    placed = made.get();
  }
  keepTrees(*placed);
  everywhere = inputs.everywhere;
  fill(lights, voxels, *placed, inputs.openingRatio);
}

void EmitterBufferList::fill(const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels,
                             const std::vector<PlacedEmitterTree>& placed, double k) {
  std::vector<glm::vec4> head(1 + 2 * lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (lights[i].lookedAt > 0.0) head.emplace_back(float(i), float(lights[i].lookedAt), 0.0F, 0.0F);
  }
  lookedAt = head.size() - 1 - 2 * lights.size();
  head[0] = {float(lights.size()), float(std::min(k, 1e15)), float(lookedAt), 0.0F};
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (!lights[i].polygons) continue;
    head[1 + 2 * i] = glm::vec4(lights[i].radiance, layout::kAsPolygons);
    head[2 + 2 * i] = {float(head.size()), float(lights[i].mesh->evenTriangles().size()), sidesOf(lights[i]), 0.0F};
    addPolygons(lights[i], head);
  }
  std::vector<Part> parts;
  count = head.size();
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (lights[i].polygons) continue;
    const Part part = lights[i].tree ? partOf(placed[i]) : partOf(*voxels[i]);
    const double scale = lights[i].tree ? 1.0 : voxels[i]->radianceScale;
    head[1 + 2 * i] = glm::vec4(lights[i].radiance * scale, lights[i].tree ? layout::kAsEmitterTree : layout::kAsVpls);
    head[2 + 2 * i] = {float(count), float(part.entries), sidesOf(lights[i]), float(part.texelsOfEntry)};
    parts.push_back(part);
    count += part.before.size() + part.texels;
  }
  makeRoom();
  texels.update(0, gpu::bytesOf(std::span<const glm::vec4>(head)));
  put(parts, head.size());
}

void EmitterBufferList::put(const std::vector<Part>& parts, std::size_t at) {
  const std::map<std::size_t, EmitterTreePtr> before = std::exchange(lying_, {});
  for (const Part& part : parts) {
    if (!part.before.empty()) texels.update(at * kTexel, gpu::bytesOf(std::span<const glm::vec4>(part.before)));
    at += part.before.size();
    const auto there = before.find(at);
    const bool lies = part.tree != nullptr && there != before.end() && there->second == part.tree;
    if (part.texels > 0 && !lies) {
      glCopyNamedBufferSubData(part.from->id(), texels.id(), 0, GLintptr(at * kTexel),
                               GLsizeiptr(part.texels * kTexel));
    }
    if (part.tree != nullptr) lying_[at] = part.tree;
    at += part.texels;
  }
}

void EmitterBufferList::makeRoom() {
  if (texels.size() >= count * kTexel) return;
  view = {};
  texels = {};  // first the old memory, then the new
  lying_.clear();
  texels = gpu::Buffer("direct lights", std::bit_ceil(count * kTexel), gpu::BufferUse::kDynamic, gpu::Undefined{});
  view = gpu::BufferTexture("direct lights", texels);
}

EmitterBufferList::Part EmitterBufferList::partOf(const PlacedEmitterTree& placed) const {
  const glm::mat4 rows(glm::transpose(placed.treeFromGrid));
  return {{rows[0], rows[1], rows[2]}, &trees_.at(placed.tree), placed.tree,
          placed.tree->texels.size(),  placed.tree->entries,    layout::kPlainEntryTexels};
}

EmitterBufferList::Part EmitterBufferList::partOf(const LightVoxels& voxels) const {
  const int ofEntry = voxels.momentsPerCell > 1 ? layout::kTexturedEntryTexels : layout::kPlainEntryTexels;
  const std::size_t entries = voxels.tree->entryCount;
  return {{}, &voxels.tree->entries, nullptr, entries * std::size_t(ofEntry), entries, ofEntry};
}

}  // namespace lpv
