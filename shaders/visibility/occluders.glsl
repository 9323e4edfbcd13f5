// Shadow rays against triangles. Surfaces that stop all light have theirs in one space, below a BVH over subtrees of theirs
// (server/scene/placed_trees.h); all else is a BVH over instances, below each the BVH of its mesh, in its own space
// (occluders.h). All are walked depth first without a stack (triangle_bvh.h). Texels:
//   header    (texel of the first instance, first of the nodes over subtrees, one past the last, -), (lower corner of the
//             haze, its extinction per cell), (its upper corner, -), (where grid space begins in the common space, cell),
//             (lower corner of all that is there, -), (its upper corner, -)
//   nodes over instances
//             (lower corner, the node after it and all below) (upper corner, first item x kLeafItems + items)
//   nodes over subtrees
//             as those that are placed (below), but of leaves (lower corner, texel where the subtree ends) (upper corner,
//             texel where it begins x kLeafItems); then for each node (texel of the instance, first texel of its
//             triangles, -, -), which leaves have
//   instance  three rows of the matrix from grid to object space, or to the common space, then (first texel of the mesh's
//             nodes, first of its triangles, which follow them, largest coordinate of its box, what it blocks:
//             Occluder::blocks), then (transmission, alpha), (first texel of a map of alpha or 0, its boxes across and
//             down, first texel of the triangles' texture coordinates) and (the surface's number and one, 0: a light; the
//             light's number and one, 0: a surface; sides of a surface that reflect: Occluder::reflects; that cameras see: Occluder::shows)
//   nodes of a mesh
//             as those over instances; of one that is placed with texels: (lower corner, texel after it and all below)
//             (upper corner, texel of the first triangle x kLeafItems + triangles)
//   triangle  its three corners, each with a component of the unit normal (BvhTriangle)
//   texture coordinates of a triangle: (first, second), (third, -)
//   map       alphas of 255, four to a number
//
// LPV_TRANSPARENT: some of what is there lets light through (server/scene/transparency.h), or haze takes some of it
// (visibility/haze.glsl); else all is opaque, and what instances have for it is not read.
#ifndef LPV_TRANSPARENT
#error "LPV_TRANSPARENT: 0 or 1"
#endif

#include "visibility/haze.glsl"

// A ray looks at a node or triangle of each instance once at most; past kMostRayRounds of them it counts as open. llvmpipe
// ends a thread's loops after 2^16 rounds in all, without reporting it, and counts what any of eight neighbours takes: who
// sends many rays from a thread adds up `rounds` and stops in time.
const int kMostRayRounds = 12000;
const float kTopMargin = 1e-4;  // cells: the same for boxes of instances

/// What boxes are tested against: a segment from an origin to origin + direction.
struct SegmentBox {
  vec3 inverse;        // 1 / direction, none of whose components is taken for 0
  vec3 before, after;  // the origin plus and minus the margin of boxes
};

SegmentBox segmentBox(vec3 origin, vec3 direction, vec3 margin) {
  const vec3 inverse = 1.0 / mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
  return SegmentBox(inverse, origin + margin, origin - margin);
}

SegmentBox segmentBox(vec3 origin, vec3 direction, float margin) { return segmentBox(origin, direction, vec3(margin)); }

/// Up to `end`, 0..1.
bool meetsBox(vec3 lower, vec3 upper, SegmentBox s, float end) {
  const vec3 a = (lower - s.before) * s.inverse, b = (upper - s.after) * s.inverse, near = min(a, b), far = max(a, b);
  return max(max(near.x, near.y), max(near.z, 0.0)) <= min(min(far.x, far.y), min(far.z, end));
}

/// What triangles are tested against.
struct Segment {
  vec3 origin, direction;
  vec3 right, up;  // across it
};

Segment segmentOf(vec3 origin, vec3 direction) {
  const vec3 d = direction * inversesqrt(max(dot(direction, direction), 1e-37));
  const vec3 right = abs(d.x) > abs(d.z) ? vec3(-d.y, d.x, 0.0) : vec3(0.0, -d.z, d.y);
  return Segment(origin, direction, right, cross(d, right));
}

/// The same for every triangle that has the corner, to the last bit: nothing here may be fused.
float along(vec3 p, vec3 axis) {
  precise const float sum = p.x * axis.x + p.y * axis.y + p.z * axis.z;
  return sum;
}

/// On which side the segment passes the edge from a to b, both seen along it: 0 where rounding leaves nothing, but never
/// of the wrong sign.
float passes(vec2 a, vec2 b) {
  precise const float side = a.x * b.y - b.x * a.y;
  return side;
}

/// A triangle as it is seen along a segment, from its start.
struct SeenTriangle {
  vec3 a, normal;
  vec2 a2, b2, c2;  // corners across the segment
  vec3 sides;       // on which the segment passes the edges across from the corners
};

SeenTriangle seenTriangle(int texel, Segment s) {
  const uvec4 first = texelFetch(occluders, texel), second = texelFetch(occluders, texel + 1);
  const uvec4 third = texelFetch(occluders, texel + 2);
  const vec3 a = uintBitsToFloat(first.xyz) - s.origin, b = uintBitsToFloat(second.xyz) - s.origin,
             c = uintBitsToFloat(third.xyz) - s.origin, normal = uintBitsToFloat(uvec3(first.w, second.w, third.w));
  const vec2 a2 = vec2(along(a, s.right), along(a, s.up)), b2 = vec2(along(b, s.right), along(b, s.up)),
             c2 = vec2(along(c, s.right), along(c, s.up));
  return SeenTriangle(a, normal, a2, b2, c2, vec3(passes(b2, c2), passes(c2, a2), passes(a2, b2)));
}

/// Where on the segment the plane is, where it lies between the ends and the segment within the box of all corners: else
/// sides of 0 say nothing, and it is nowhere.
const float kNowhere = 2.0;
float planeAt(SeenTriangle t, Segment s) {
  const float at = dot(t.normal, t.a) / dot(t.normal, s.direction);  // along the plane no number in between
  const vec2 low = min(t.a2, min(t.b2, t.c2)), high = max(t.a2, max(t.b2, t.c2));
  const bool near = max(low.x, low.y) <= 0.0 && min(high.x, high.y) >= 0.0;
  return near && at > 0.0 && at < 1.0 ? at : kNowhere;
}

/// Strictly between the ends, from either side. After Woop, Benthin and Wald 2013, "Watertight ray/triangle intersection":
/// triangles that share an edge agree about the side on which the segment passes it.
float whereMet(int texel, Segment s) {
  const SeenTriangle t = seenTriangle(texel, s);
  const float least = min(t.sides.x, min(t.sides.y, t.sides.z)), most = max(t.sides.x, max(t.sides.y, t.sides.z));
  const bool inside = (least >= 0.0 && most > 0.0) || (least < 0.0 && most <= 0.0);
  return inside ? planeAt(t, s) : kNowhere;
}

bool meetsTriangle(int texel, Segment s) { return whereMet(texel, s) < 1.0; }

/// The box of all that is there.
vec3 lowestOccluder() { return uintBitsToFloat(texelFetch(occluders, 4).xyz); }
vec3 highestOccluder() { return uintBitsToFloat(texelFetch(occluders, 5).xyz); }

/// Where a walk through the placed trees is, in texels.
struct PlacedWalk {
  int at;
  int end;   // of the subtree that it is in, or `stop`
  int root;  // the node over subtrees that it went into last
  int stop;  // one past the nodes over subtrees
};

PlacedWalk placedWalk() {
  const uvec4 header = texelFetch(occluders, 0);
  return PlacedWalk(int(header.y), int(header.z), 0, int(header.z));
}

vec3 placedFromGrid(vec3 grid) {
  const vec4 map = uintBitsToFloat(texelFetch(occluders, 3));
  return map.w * grid + map.xyz;
}

SegmentBox placedBox(vec3 origin, vec3 direction) { return segmentBox(origin, direction, kBoxMargin * abs(origin)); }

/// Goes on to the next leaf that the segment may meet before `limit`: its first triangle's texel x kLeafItems + triangles,
/// or 0 at the end. Into subtrees and out of them without a branch, so that eight threads go through as many nodes as the
/// longest way has, not as the longest way through each tree.
uint nextPlacedLeaf(inout PlacedWalk walk, SegmentBox box, float limit, inout int rounds) {
  uint leaf = 0u;
  while (walk.at != walk.stop && leaf == 0u && rounds < kMostRayRounds) {
    const uvec4 lower = texelFetch(occluders, walk.at), upper = texelFetch(occluders, walk.at + 1);
    const bool met = meetsBox(uintBitsToFloat(lower.xyz), uintBitsToFloat(upper.xyz), box, limit);
    const bool inner = upper.w == 0u, above = !inner && upper.w % uint(kLeafItems) == 0u, enters = met && above;
    leaf = met && !above ? upper.w : 0u;
    const int after = above || (met && inner) ? walk.at + 2 : int(lower.w);
    const int next = enters ? int(upper.w / uint(kLeafItems)) : after;
    walk.root = enters ? walk.at : walk.root;
    walk.end = enters ? int(lower.w) : walk.end;
    const bool leaves = next == walk.end && walk.end != walk.stop;
    walk.at = leaves ? walk.root + 2 : next;
    walk.end = leaves ? walk.stop : walk.end;
    ++rounds;
  }
  return leaf;
}

/// Whether one of the placed triangles lies strictly between two grid positions.
bool meetsPlaced(vec3 from, vec3 to, inout int rounds) {
  const vec3 origin = placedFromGrid(from), direction = uintBitsToFloat(texelFetch(occluders, 3).w) * (to - from);
  const SegmentBox box = placedBox(origin, direction);
  const Segment segment = segmentOf(origin, direction);
  bool met = false;
  for (PlacedWalk walk = placedWalk(); walk.at != walk.stop && !met && rounds < kMostRayRounds; ++rounds) {
    const uint leaf = nextPlacedLeaf(walk, box, 1.0, rounds);
    const int items = int(leaf % uint(kLeafItems)), first = int(leaf / uint(kLeafItems));
    for (int i = 0; i < items && !met; ++i, ++rounds) met = meetsTriangle(first + kTriangleTexels * i, segment);
  }
  return met;
}

int firstInstance() { return int(texelFetch(occluders, 0).x); }
/// One past the last.
int endOfInstanceNodes() { return int(texelFetch(occluders, 0).y); }

/// Goes on from node `at` of a tree to the next leaf that the segment may meet before `limit`: its items as BvhNode::leaf
/// has them, or 0 at the end. Texels of the tree's first node and of one past the last. A loop with nothing else in it:
/// llvmpipe goes through what a branch leaves out.
uint nextLeaf(inout int at, int begin, int end, SegmentBox box, float limit, inout int rounds) {
  uint leaf = 0u;
  while (at < end && leaf == 0u && rounds < kMostRayRounds) {
    const uvec4 lower = texelFetch(occluders, at), upper = texelFetch(occluders, at + 1);
    const bool met = meetsBox(uintBitsToFloat(lower.xyz), uintBitsToFloat(upper.xyz), box, limit);
    leaf = met ? upper.w : 0u;
    at = met ? at + 2 : begin + 2 * int(lower.w);
    ++rounds;
  }
  return leaf;
}

/// Whether a triangle of an instance's mesh is met; `mesh`: the instance's last texel.
bool meetsMesh(uvec4 mesh, vec3 origin, vec3 direction, inout int rounds) {
  const int begin = int(mesh.x), end = int(mesh.y);
  const float reach = max(max(abs(origin.x), abs(origin.y)), abs(origin.z)) + uintBitsToFloat(mesh.z);
  const SegmentBox box = segmentBox(origin, direction, kBoxMargin * reach);
  const Segment segment = segmentOf(origin, direction);
  bool met = false;
  for (int at = begin; at < end && !met && rounds < kMostRayRounds; ++rounds) {
    const uint leaf = nextLeaf(at, begin, end, box, 1.0, rounds);
    const int items = int(leaf % uint(kLeafItems)), first = end + kTriangleTexels * int(leaf / uint(kLeafItems));
    for (int i = 0; i < items && !met; ++i, ++rounds) met = meetsTriangle(first + kTriangleTexels * i, segment);
  }
  return met;
}

#if LPV_TRANSPARENT
/// A segment through an edge itself belongs to the triangle that has it in this direction, which its neighbour has turned
/// over: so a pane of two triangles is one pane.
bool isWithin(float side, vec2 edge) {
  return side > 0.0 || (side == 0.0 && (edge.y > 0.0 || (edge.y == 0.0 && edge.x > 0.0)));
}

/// As meetsTriangle, by one of the triangles that share an edge alone; the corners' weights where it is met.
bool crossesTriangle(int texel, Segment s, out vec3 weights) {
  const SeenTriangle t = seenTriangle(texel, s);
  const float all = t.sides.x + t.sides.y + t.sides.z, turn = all > 0.0 ? 1.0 : -1.0;
  weights = t.sides / all;
  return all != 0.0 && isWithin(turn * t.sides.x, turn * (t.c2 - t.b2)) &&
         isWithin(turn * t.sides.y, turn * (t.a2 - t.c2)) && isWithin(turn * t.sides.z, turn * (t.b2 - t.a2)) &&
         planeAt(t, s) < 1.0;
}

/// What a map says at a place of a triangle, by the last texel of its instance; 1 without map.
float alphaAt(uvec4 map, int triangle, vec3 weights) {
  if (map.x == 0u) return 1.0;
  const vec4 corners = uintBitsToFloat(texelFetch(occluders, int(map.w) + kUvTexels * triangle));
  const vec2 third = uintBitsToFloat(texelFetch(occluders, int(map.w) + kUvTexels * triangle + 1).xy);
  const vec2 uv = fract(weights.x * corners.xy + weights.y * corners.zw + weights.z * third);
  const ivec2 size = ivec2(map.yz), box = min(ivec2(uv * vec2(size)), size - 1);
  const int i = box.y * size.x + box.x, in16 = i % kAlphasOfTexel;
  const uint four = texelFetch(occluders, int(map.x) + i / kAlphasOfTexel)[in16 / 4];
  return float((four >> (8 * (in16 % 4))) & 0xffu) / 255.0;
}

/// What an instance lets through of a segment in its space; `instance`: its first texel.
vec3 throughMesh(int instance, uvec4 mesh, vec3 origin, vec3 direction, inout int rounds) {
  const vec4 coverage = uintBitsToFloat(texelFetch(occluders, instance + 4));
  const uvec4 map = texelFetch(occluders, instance + 5);
  if (coverage.w == 1.0 && map.x == 0u) return vec3(meetsMesh(mesh, origin, direction, rounds) ? 0.0 : 1.0);
  const int begin = int(mesh.x), end = int(mesh.y);
  const float reach = max(max(abs(origin.x), abs(origin.y)), abs(origin.z)) + uintBitsToFloat(mesh.z);
  const SegmentBox box = segmentBox(origin, direction, kBoxMargin * reach);
  const Segment segment = segmentOf(origin, direction);
  vec3 share = vec3(1.0);
  for (int at = begin; at < end && share != vec3(0.0) && rounds < kMostRayRounds; ++rounds) {
    const uint leaf = nextLeaf(at, begin, end, box, 1.0, rounds);
    const int items = int(leaf % uint(kLeafItems)), first = int(leaf / uint(kLeafItems));
    for (int i = first; i < first + items; ++i, ++rounds) {
      vec3 weights;
      if (!crossesTriangle(end + kTriangleTexels * i, segment, weights)) continue;
      share *= (1.0 - coverage.w * alphaAt(map, i, weights)) * coverage.rgb;
    }
  }
  return share;
}
#endif

/// By the first texel of an instance.
mat4x3 objectFromGrid(int instance) {
  return transpose(mat3x4(uintBitsToFloat(texelFetch(occluders, instance)),
                          uintBitsToFloat(texelFetch(occluders, instance + 1)),
                          uintBitsToFloat(texelFetch(occluders, instance + 2))));
}

/// Per colour, what gets from one grid position to another of light of `light`, by what lies strictly between. `rounds`:
/// of loops, added to.
vec3 transmitted(vec3 from, vec3 to, int light, inout int rounds) {
  const int instances = firstInstance(), end = endOfInstanceNodes();
  const SegmentBox box = segmentBox(from, to - from, kTopMargin);
  vec3 share = vec3(meetsPlaced(from, to, rounds) ? 0.0 : 1.0);
  for (int at = kOccluderHeader; at < end && share != vec3(0.0) && rounds < kMostRayRounds; ++rounds) {
    const uint leaf = nextLeaf(at, kOccluderHeader, end, box, 1.0, rounds);
    const int instance = instances + kInstanceTexels * int(leaf / uint(kLeafItems));
    const uvec4 mesh = texelFetch(occluders, instance + 3);
    if (leaf == 0u || (int(mesh.w) != kAllLights && light != kFromSurfaces && int(mesh.w) != light)) continue;
    const mat4x3 object = objectFromGrid(instance);
    const vec3 origin = object * vec4(from, 1.0), direction = object * vec4(to - from, 0.0);
#if LPV_TRANSPARENT
    share *= throughMesh(instance, mesh, origin, direction, rounds);
#else
    if (meetsMesh(mesh, origin, direction, rounds)) share = vec3(0.0);
#endif
  }
  return share;
}

vec3 transmitted(vec3 from, vec3 to, int light) {
  int rounds = 0;
  return transmitted(from, to, light, rounds);
}

/// Whether a light lies between, which blocks what surfaces reflect.
bool meetsLight(vec3 from, vec3 to) {
  const int instances = firstInstance(), end = endOfInstanceNodes();
  const SegmentBox box = segmentBox(from, to - from, kTopMargin);
  bool met = false;
  int rounds = 0;
  for (int at = kOccluderHeader; at < end && !met && rounds < kMostRayRounds; ++rounds) {
    const uint leaf = nextLeaf(at, kOccluderHeader, end, box, 1.0, rounds);
    const int instance = instances + kInstanceTexels * int(leaf / uint(kLeafItems));
    const uvec4 mesh = texelFetch(occluders, instance + 3);
    if (leaf == 0u || int(mesh.w) == kAllLights) continue;
    const mat4x3 object = objectFromGrid(instance);
    met = meetsMesh(mesh, object * vec4(from, 1.0), object * vec4(to - from, 0.0), rounds);
  }
  return met;
}
