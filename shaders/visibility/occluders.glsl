// Shadow rays against triangles: a BVH over instances, below each the BVH of its mesh, walked depth first without a stack
// (server/scene/triangle_bvh.h, occluders.h). Texels:
//   0: (texel of the first instance, -, -, -), then the nodes over instances
//   node      (lower corner, the node after it and all below) (upper corner, first item x kLeafItems + items)
//   instance  three rows of the matrix from grid to object space, then (first texel of the mesh's nodes, first of its
//             triangles, which follow them, largest coordinate of its box, the light that it blocks or -1 for all)
//   triangle  its three corners, each with a component of the unit normal (BvhTriangle)

layout(binding = kOccluders) uniform usamplerBuffer occluders;

// A ray looks at a node or triangle of each instance once at most; past kMostRayRounds of them it counts as open. llvmpipe
// ends a thread's loops after 2^16 rounds in all, without reporting it, and counts what any of eight neighbours takes: who
// sends many rays from a thread adds up `rounds` and stops in time. (180,000 triangles: 42 on average, 679 at most.)
const int kMostRayRounds = 12000;
const float kBoxMargin = 1e-6;  // of the coordinates of a mesh and of a segment's start: more than rounding can do
const float kTopMargin = 1e-4;  // cells: the same for boxes of instances

/// What boxes are tested against: a segment from an origin to origin + direction.
struct SegmentBox {
  vec3 inverse;        // 1 / direction, none of whose components is taken for 0
  vec3 before, after;  // the origin plus and minus the margin of boxes
};

SegmentBox segmentBox(vec3 origin, vec3 direction, float margin) {
  const vec3 inverse = 1.0 / mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
  return SegmentBox(inverse, origin + margin, origin - margin);
}

bool meetsBox(vec3 lower, vec3 upper, SegmentBox s) {
  const vec3 a = (lower - s.before) * s.inverse, b = (upper - s.after) * s.inverse, near = min(a, b), far = max(a, b);
  return max(max(near.x, near.y), max(near.z, 0.0)) <= min(min(far.x, far.y), min(far.z, 1.0));
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

/// Strictly between the ends, from either side. After Woop, Benthin and Wald 2013, "Watertight ray/triangle intersection":
/// triangles that share an edge agree about the side on which the segment passes it.
bool meetsTriangle(int texel, Segment s) {
  const uvec4 first = texelFetch(occluders, texel), second = texelFetch(occluders, texel + 1);
  const uvec4 third = texelFetch(occluders, texel + 2);
  const vec3 a = uintBitsToFloat(first.xyz) - s.origin, b = uintBitsToFloat(second.xyz) - s.origin,
             c = uintBitsToFloat(third.xyz) - s.origin, normal = uintBitsToFloat(uvec3(first.w, second.w, third.w));
  const vec2 a2 = vec2(along(a, s.right), along(a, s.up)), b2 = vec2(along(b, s.right), along(b, s.up)),
             c2 = vec2(along(c, s.right), along(c, s.up));
  const float u = passes(b2, c2), v = passes(c2, a2), w = passes(a2, b2);
  const float least = min(u, min(v, w)), most = max(u, max(v, w));
  const float at = dot(normal, a) / dot(normal, s.direction);  // along the plane no number in between
  const vec2 low = min(a2, min(b2, c2)), high = max(a2, max(b2, c2));
  const bool near = max(low.x, low.y) <= 0.0 && min(high.x, high.y) >= 0.0;  // else sides of 0 say nothing
  const bool inside = (least >= 0.0 && most > 0.0) || (least < 0.0 && most <= 0.0);
  return near && inside && at > 0.0 && at < 1.0;
}

/// Goes on from node `at` of a tree to the next leaf that the segment may meet: its items as BvhNode::leaf has them, or 0
/// at the end. Texels of the tree's first node and of one past the last. A loop with nothing else in it: llvmpipe goes
/// through what a branch leaves out.
uint nextLeaf(inout int at, int begin, int end, SegmentBox box, inout int rounds) {
  uint leaf = 0u;
  while (at < end && leaf == 0u && rounds < kMostRayRounds) {
    const uvec4 lower = texelFetch(occluders, at), upper = texelFetch(occluders, at + 1);
    const bool met = meetsBox(uintBitsToFloat(lower.xyz), uintBitsToFloat(upper.xyz), box);
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
    const uint leaf = nextLeaf(at, begin, end, box, rounds);
    const int items = int(leaf % uint(kLeafItems)), first = end + kTriangleTexels * int(leaf / uint(kLeafItems));
    for (int i = 0; i < items && !met; ++i, ++rounds) met = meetsTriangle(first + kTriangleTexels * i, segment);
  }
  return met;
}

/// 1 where nothing lies strictly between two grid positions for light of `light`, else 0. `rounds`: of loops, added to.
float open(vec3 from, vec3 to, int light, inout int rounds) {
  const int instances = int(texelFetch(occluders, 0).x);
  const SegmentBox box = segmentBox(from, to - from, kTopMargin);
  bool met = false;
  for (int at = 1; at < instances && !met && rounds < kMostRayRounds; ++rounds) {
    const uint leaf = nextLeaf(at, 1, instances, box, rounds);
    const int instance = instances + kInstanceTexels * int(leaf / uint(kLeafItems));
    const uvec4 mesh = texelFetch(occluders, instance + 3);
    if (leaf == 0u || (int(mesh.w) >= 0 && int(mesh.w) != light)) continue;
    const mat4x3 object = transpose(mat3x4(uintBitsToFloat(texelFetch(occluders, instance)),
                                           uintBitsToFloat(texelFetch(occluders, instance + 1)),
                                           uintBitsToFloat(texelFetch(occluders, instance + 2))));
    met = meetsMesh(mesh, object * vec4(from, 1.0), object * vec4(to - from, 0.0), rounds);
  }
  return met ? 0.0 : 1.0;
}

float open(vec3 from, vec3 to, int light) {
  int rounds = 0;
  return open(from, to, light, rounds);
}
