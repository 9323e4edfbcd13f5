// Shadow rays against triangles: a BVH over instances, below each the BVH of its mesh, walked depth first without a stack
// (server/scene/triangle_bvh.h, occluders.h). Texels:
//   0: (texel of the first instance, -, -, -), then the nodes over instances
//   node      (lower corner, the node after it and all below) (upper corner, first item x kLeafItems + items)
//   instance  three rows of the matrix from grid to object space, then (first texel of the mesh's nodes, one past the
//             last, first texel of its triangles, the light that it blocks or -1 for all)
//   triangle  its three corners, each with a component of the unit normal (BvhTriangle)
// One loop over both levels: llvmpipe counts a loop's rounds for all of a thread's neighbours together.

layout(binding = kOccluders) uniform usamplerBuffer occluders;

const int kMostRayRounds = 12000;  // nodes and triangles that a ray looks at; llvmpipe ends a thread's loops after 2^16
                                   // in all. What is beyond counts as open.
const float kBoxMargin = 2e-6;  // of a box's coordinates, seen from a segment's start: what rounding can do to a triangle
const float kTopMargin = 1e-4;  // cells: the same for boxes of instances

/// A segment in the space of a tree: it begins at the origin and ends at origin + direction.
struct Segment {
  vec3 origin, direction, inverse;
  vec3 right, up;         // across the direction
  vec3 before, after;     // origin plus and minus the margin of boxes
};

Segment segmentOf(vec3 origin, vec3 direction, float margin) {
  const vec3 d = direction * inversesqrt(max(dot(direction, direction), 1e-37));
  const vec3 right = abs(d.x) > abs(d.z) ? vec3(-d.y, d.x, 0.0) : vec3(0.0, -d.z, d.y);
  const vec3 inverse = 1.0 / mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
  return Segment(origin, direction, inverse, right, cross(d, right), origin + margin, origin - margin);
}

/// The same for every triangle that has the corner, to the last bit: nothing here may be fused.
float along(vec3 p, vec3 axis) {
  precise const float sum = p.x * axis.x + p.y * axis.y + p.z * axis.z;
  return sum;
}

/// On which side the segment passes the edge from a to b, both seen along it; never of the wrong sign.
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
  // Where the plane is, which its own corners bound: almost along the plane the quotient may be anything.
  const vec3 depths = vec3(dot(a, s.direction), dot(b, s.direction), dot(c, s.direction)) / dot(s.direction, s.direction);
  const float slope = dot(normal, s.direction), plane = slope == 0.0 ? depths.x : dot(normal, a) / slope;
  const float at = clamp(plane, min(depths.x, min(depths.y, depths.z)), max(depths.x, max(depths.y, depths.z)));
  const bool inside = (least >= 0.0 && most > 0.0) || (least < 0.0 && most <= 0.0);
  return inside && at > 0.0 && at < 1.0;
}

bool meetsBox(vec3 lower, vec3 upper, Segment s) {
  const vec3 a = (lower - s.before) * s.inverse, b = (upper - s.after) * s.inverse, near = min(a, b), far = max(a, b);
  return max(max(near.x, near.y), max(near.z, 0.0)) <= min(min(far.x, far.y), min(far.z, 1.0));
}

/// Where a walk stands.
struct Walk {
  int at, begin, end;  // texels of the next node, of the first of its tree, and one past the last
  int after;           // where to go on among the instances, -1 while there
  int triangles;       // texel of the mesh's first triangle
  Segment segment;
};

/// Goes on to the next leaf that the ray may meet: its items as BvhNode::leaf has them, or 0 at the end. A loop with
/// nothing else in it: llvmpipe goes through what a branch leaves out.
uint nextLeaf(inout Walk walk, inout int rounds) {
  uint leaf = 0u;
  while (walk.at < walk.end && leaf == 0u && rounds < kMostRayRounds) {
    const uvec4 lower = texelFetch(occluders, walk.at), upper = texelFetch(occluders, walk.at + 1);
    const bool met = meetsBox(uintBitsToFloat(lower.xyz), uintBitsToFloat(upper.xyz), walk.segment);
    leaf = met ? upper.w : 0u;
    walk.at = met ? walk.at + 2 : walk.begin + 2 * int(lower.w);
    ++rounds;
  }
  return leaf;
}

/// Goes down into the mesh of an instance.
void enter(inout Walk walk, int instance, uvec4 mesh, vec3 from, vec3 to) {
  const vec4 x = uintBitsToFloat(texelFetch(occluders, instance));
  const vec4 y = uintBitsToFloat(texelFetch(occluders, instance + 1));
  const vec4 z = uintBitsToFloat(texelFetch(occluders, instance + 2));
  const vec3 origin = vec3(dot(x, vec4(from, 1.0)), dot(y, vec4(from, 1.0)), dot(z, vec4(from, 1.0)));
  const vec3 direction = vec3(dot(x.xyz, to - from), dot(y.xyz, to - from), dot(z.xyz, to - from));
  const vec3 lower = uintBitsToFloat(texelFetch(occluders, int(mesh.x)).xyz);
  const vec3 upper = uintBitsToFloat(texelFetch(occluders, int(mesh.x) + 1).xyz);
  const vec3 reach = max(abs(lower - origin), abs(upper - origin));
  walk.segment = segmentOf(origin, direction, kBoxMargin * max(reach.x, max(reach.y, reach.z)));
  walk.after = walk.at;
  walk.at = walk.begin = int(mesh.x);
  walk.end = int(mesh.y);
  walk.triangles = int(mesh.z);
}

/// 1 where nothing lies strictly between two grid positions for light of `light`, else 0.
float open(vec3 from, vec3 to, int light) {
  const int instances = int(texelFetch(occluders, 0).x);
  Walk above = Walk(1, 1, instances, -1, 0, segmentOf(from, to - from, kTopMargin)), walk = above;
  for (int rounds = 0; rounds < kMostRayRounds; ++rounds) {
    const uint leaf = nextLeaf(walk, rounds);
    const int item = int(leaf / uint(kLeafItems)), items = int(leaf % uint(kLeafItems));
    if (leaf == 0u) {
      if (walk.after < 0) return 1.0;
      above.at = walk.after;
      walk = above;
    } else if (walk.after < 0) {
      const int instance = instances + kInstanceTexels * item;
      const uvec4 mesh = texelFetch(occluders, instance + 3);
      if (int(mesh.w) < 0 || int(mesh.w) == light) enter(walk, instance, mesh, from, to);
    } else {
      bool met = false;
      for (int i = item; i < item + items; ++i)
        met = met || meetsTriangle(walk.triangles + kTriangleTexels * i, walk.segment);
      if (met) return 0.0;
      rounds += items;
    }
  }
  return 1.0;
}
