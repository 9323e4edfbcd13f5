#pragma once
// How a receiver sees one light of an EmitterList: as which polygons, and which VPLs. For scene/emitter_list.cpp and
// scene/light_around.cpp.

#include <glm/glm.hpp>

#include "scene/emitter_list.h"
#include "shaders/layout.h"

namespace lpv {

/// One light's texels.
struct EmitterPart {
  const glm::vec4* first = nullptr;
  int count = 0;   ///< triangles or records
  int sides = 1;
  int stride = 4;  ///< texels of a record
};

/// A VPL of a part, and who sees it.
struct SeenVpl {
  const glm::vec4* record = nullptr;
  glm::dvec3 colour{1.0};  ///< beside the light's radiance
  glm::dvec3 from{0.0};    ///< the receiver, in the record's space
  int sides = 1;
};

/// Calls see.triangle(corners, sides), corners relative to x, for each of the part's.
template <typename See>
void seePolygons(const EmitterPart& part, const glm::dvec3& x, See& see) {
  for (int i = 0; i < part.count; ++i) {
    const glm::vec4* corner = part.first + 3 * i;
    const glm::dvec3 corners[3] = {glm::dvec3(corner[0]) - x, glm::dvec3(corner[1]) - x, glm::dvec3(corner[2]) - x};
    see.triangle(corners, part.sides);
  }
}

template <typename See>
void seeVpl(const EmitterPart& part, int at, const glm::dvec3& x, See& see) {
  const glm::vec4* record = part.first + at * part.stride;
  const bool coloured = part.stride == layout::kTexturedEntryTexels;
  see.vpl(SeenVpl{record, coloured ? glm::dvec3(record[4]) : glm::dvec3(1.0), x, part.sides});
}

/// Calls see.vpl() for the VPLs of nodes that are far away, by k. For a node that is near it asks near(leaf, texel),
/// with the node's second texel: true if its VPLs are to be seen all the same. Children of near nodes come after.
template <typename See, typename Near>
void seeTree(const EmitterPart& part, const glm::dvec3& x, double k, See& see, const Near& near) {
  for (int at = 0; at < part.count;) {
    const glm::dvec4 node(part.first[at * part.stride]), next(part.first[at * part.stride + 1]);
    const int vpls = int(next.x), after = int(next.y);
    const glm::dvec3 d = glm::dvec3(node) - x;
    const bool far = glm::dot(d, d) > k * k * node.w * node.w;
    const bool leaf = after == at + 1 + vpls;
    const bool whole = far || near(leaf, next);
    for (int i = at + 1; whole && i <= at + vpls; ++i) seeVpl(part, i, x, see);
    at = far || leaf ? after : at + 1 + vpls;
  }
}

/// Calls see.triangle() and see.vpl() for what stands for the light, seen from `x`, in grid space. Where a light has a
/// space of its own see.turned(turn) comes before: a rotation with one scale from grid space. Radiance is 1 beside the
/// list's own (emitterRadiance()).
template <typename See>
void seeLight(const EmitterList& list, std::size_t light, const glm::dvec3& x, See& see) {
  const glm::vec4 radiance = list.texels[1 + 2 * light], where = list.texels[2 + 2 * light];
  const EmitterPart part = {&list.texels[std::size_t(where.x)], int(where.y), int(where.z), int(where.w)};
  const double k = double(list.texels[0].y);
  if (radiance.w == layout::kAsPolygons) return seePolygons(part, x, see);
  if (radiance.w != layout::kAsEmitterTree)
    return seeTree(part, x, k, see, [](bool leaf, const glm::dvec4&) { return leaf; });
  const auto row = [&part](int i) { return glm::dvec4(part.first[i]); };
  const glm::dmat3 turn = glm::transpose(glm::dmat3(glm::dvec3(row(0)), glm::dvec3(row(1)), glm::dvec3(row(2))));
  const glm::dvec3 at = turn * x + glm::dvec3(row(0).w, row(1).w, row(2).w);
  see.turned(turn);
  const EmitterPart tree = {part.first + layout::kTreeSpaceTexels, part.count, part.sides, layout::kPlainEntryTexels};
  seeTree(tree, at, k, see, [&](bool, const glm::dvec4& next) {
    seePolygons({part.first + int(next.w), int(next.z), part.sides, 0}, at, see);
    return false;
  });
}

/// Of the k-th light that emits.
inline glm::dvec3 emitterRadiance(const EmitterList& list, std::size_t light) {
  return glm::dvec3(list.texels[1 + 2 * light]);
}

}  // namespace lpv
