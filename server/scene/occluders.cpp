#include "scene/occluders.h"

#include <utility>

#include "scene/gloss.h"
#include "scene/patches.h"
#include "scene/shadowing.h"

namespace lpv {

namespace {

glm::dvec2 uvAt(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& weights) {
  const glm::uvec3& t = mesh.triangles[triangle];
  return weights.x * glm::dvec2(mesh.uvs[t.x]) + weights.y * glm::dvec2(mesh.uvs[t.y]) +
         weights.z * glm::dvec2(mesh.uvs[t.z]);
}

}  // namespace

std::vector<Occluder> occludersOf(const Scene& scene) {
  const bool gloss = showsGloss(scene);
  std::vector<Occluder> out;
  out.reserve(scene.surfaces.size() + scene.lights.size());
  int number = -1;
  for (const auto& [name, surface] : scene.surfaces) {
    ++number;
    if (!canStop(*surface)) continue;
    Coverage coverage = coverageOf(*surface);
    if (coverage.letsAllThrough()) continue;
    if (coverage.isOpaque()) coverage = Coverage();
    const bool textured = gloss && surface->albedoTexture != nullptr && !surface->mesh->uvs.empty();
    const int sides = surface->twoSided ? 3 : 1;
    out.push_back({surface->mesh, surface->transform.worldFromObject(), kAllLights, std::move(coverage), number, -1,
                   textured, surface->albedo == glm::dvec3(0.0) ? 0 : sides, surface->visibleToCamera ? sides : 0});
  }
  const bool hazy = scene.options.haze > 0.0;  // rays through it look for lights
  const bool reflects = gloss || hazy || bouncesFor(scene) > 0;
  int index = 0;
  for (const auto& [name, light] : scene.lights) {
    if (!light->enabled || emittedRadiance(*light) == glm::dvec3(0.0)) continue;
    const bool mirrored = gloss && light->distant;  // in nobody's way, and seen in mirrors
    if (blocksItself(*light) || (reflects && light->castsShadow) || mirrored) {
      const int blocks = blocksItself(*light) ? index : kFromSurfaces;
      const bool textured = (gloss || hazy) && light->texture != nullptr && !light->mesh->uvs.empty();
      out.push_back({light->mesh, light->transform.worldFromObject(), blocks, {}, -1, index, textured});
    }
    ++index;
  }
  return out;
}

Bvh bvhOf(const std::vector<Occluder>& occluders, const glm::dmat4& spaceFromWorld) {
  std::vector<BvhBox> boxes;
  for (const Occluder& o : occluders) {
    const Bounds box = o.mesh->bounds.transformed(spaceFromWorld * o.worldFromObject);
    const glm::dvec3 margin = 1e-6 * (glm::abs(box.min) + glm::abs(box.max));
    boxes.push_back({glm::vec3(box.min - margin), glm::vec3(box.max + margin)});
  }
  return makeBvh(boxes, 1);
}

Occluders::Occluders(const Scene& scene) {
  const std::vector<Occluder> occluders = occludersOf(scene);
  Bvh bvh = bvhOf(occluders, glm::dmat4(1.0));
  nodes_ = std::move(bvh.nodes);
  for (const std::uint32_t i : bvh.order) {
    const Occluder& o = occluders[i];
    instances_.push_back({bvhOf(o.mesh), glm::inverse(o.worldFromObject), o.blocks, o.mesh, o.coverage,
                          o.coverage == Coverage(), o.surface});
  }
}

/// In the mesh's space.
glm::dvec3 Occluders::Instance::transmitted(const glm::dvec3& from, const glm::dvec3& to) const {
  if (opaque) return glm::dvec3(meets(*bvh, from, to) ? 0.0 : 1.0);
  const BvhSegment segment(from, to);
  glm::dvec3 share(1.0);
  for (std::size_t at = 0; at < bvh->nodes.size() && share != glm::dvec3(0.0);) {
    const BvhNode& node = bvh->nodes[at];
    if (!segment.meets(node)) {
      at = node.skip;
      continue;
    }
    ++at;
    for (std::uint32_t i = node.firstItem(); i < node.firstItem() + node.items(); ++i) {
      const auto weights = segment.crossing(bvh->triangles[i]);
      if (weights) share *= coverage.through(coverage.map ? uvAt(*mesh, bvh->indices[i], *weights) : glm::dvec2(0.0));
    }
  }
  return share;
}

bool Occluders::blocked(const glm::dvec3& from, const glm::dvec3& to, int light) const {
  return transmitted(from, to, light) == glm::dvec3(0.0);
}

template <typename Visit>
void Occluders::walk(const glm::dvec3& from, const glm::dvec3& to, const Visit& visit) const {
  const BvhSegment segment(from, to);
  for (std::size_t at = 0; at < nodes_.size();) {
    const BvhNode& node = nodes_[at];
    const bool met = segment.meets(node);
    at = met ? at + 1 : node.skip;
    if (!met || node.items() == 0) continue;
    const Instance& instance = instances_[node.firstItem()];
    const glm::dmat4& m = instance.objectFromWorld;
    if (!visit(instance, glm::dvec3(m * glm::dvec4(from, 1.0)), glm::dvec3(m * glm::dvec4(to, 1.0)))) return;
  }
}

glm::dvec3 Occluders::transmitted(const glm::dvec3& from, const glm::dvec3& to, int light) const {
  glm::dvec3 share(1.0);
  walk(from, to, [&](const Instance& instance, const glm::dvec3& begin, const glm::dvec3& end) {
    if (instance.blocks == kAllLights || light == kFromSurfaces || instance.blocks == light)
      share *= instance.transmitted(begin, end);
    return share != glm::dvec3(0.0);
  });
  return share;
}

std::optional<OccluderHit> Occluders::firstHit(const glm::dvec3& from, const glm::dvec3& to) const {
  std::optional<OccluderHit> found;
  double nearest = 1.0;
  walk(from, to, [&](const Instance& instance, const glm::dvec3& begin, const glm::dvec3& end) {
    const auto hit = instance.opaque ? lpv::firstHit(*instance.bvh, begin, end) : std::nullopt;
    if (!hit || hit->at >= nearest) return true;
    nearest = hit->at;
    found = {instance.surface, instance.bvh->indices[hit->triangle], hit->front, glm::mix(from, to, nearest)};
    return true;
  });
  return found;
}

}  // namespace lpv
