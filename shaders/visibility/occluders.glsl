// Shadow rays against triangles: a BVH over instances, below each the BVH of its mesh, walked depth first without a stack
// (server/scene/triangle_bvh.h, occluders.h). Texels:
//   0: (texel of the first instance, -, -, -), then the nodes over instances
//   node      (lower corner, the node after it and all below) (upper corner, first item x kLeafItems + items)
//   instance  three rows of the matrix from grid to object space, then (first texel of the mesh's nodes, one past the
//             last, first texel of its triangles, the light that it blocks or -1 for all)
//   triangle  (corner, -) (edge to the second corner, -) (edge to the third, -)
// One loop over both levels: llvmpipe counts a loop's rounds for all of a thread's neighbours together.

layout(binding = kOccluders) uniform usamplerBuffer occluders;

const int kMostRayRounds = 12000;  // nodes and triangles that a ray looks at; llvmpipe ends a thread's loops after 2^16
                                   // in all. What is beyond counts as open.
const float kTriangleEdges = 1e-6;  // by which a triangle is wider than it is: no ray slips between two

bool meetsTriangle(int texel, vec3 from, vec3 direction) {
  const vec3 corner = uintBitsToFloat(texelFetch(occluders, texel).xyz);
  const vec3 first = uintBitsToFloat(texelFetch(occluders, texel + 1).xyz);
  const vec3 second = uintBitsToFloat(texelFetch(occluders, texel + 2).xyz);
  const vec3 p = cross(direction, second);
  const float inverse = 1.0 / dot(first, p);  // in the plane: infinite, which no comparison lets pass
  const vec3 offset = from - corner, q = cross(offset, first);
  const float u = dot(offset, p) * inverse, v = dot(direction, q) * inverse, at = dot(second, q) * inverse;
  return u >= -kTriangleEdges && v >= -kTriangleEdges && u + v <= 1.0 + kTriangleEdges && at > 0.0 && at < 1.0;
}

/// 1 / a direction's components, none of which is taken for 0.
vec3 inverseOf(vec3 direction) {
  return 1.0 / mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
}

bool meetsBox(vec3 lower, vec3 upper, vec3 from, vec3 inverse) {
  const vec3 a = (lower - from) * inverse, b = (upper - from) * inverse, near = min(a, b), far = max(a, b);
  return max(max(near.x, near.y), max(near.z, 0.0)) <= min(min(far.x, far.y), min(far.z, 1.0)) * 1.000001;
}

/// Where a walk stands.
struct Walk {
  int at, begin, end;  // texels of the next node, of the first of its tree, and one past the last
  int after;           // where to go on among the instances, -1 while there
  int triangles;       // texel of the mesh's first triangle
  vec3 origin, direction, inverse;
};

/// Goes on to the next leaf that the ray may meet: its items as BvhNode::leaf has them, or 0 at the end. A loop with
/// nothing else in it: llvmpipe goes through what a branch leaves out.
uint nextLeaf(inout Walk walk, inout int rounds) {
  uint leaf = 0u;
  while (walk.at < walk.end && leaf == 0u && rounds < kMostRayRounds) {
    const uvec4 lower = texelFetch(occluders, walk.at), upper = texelFetch(occluders, walk.at + 1);
    const bool met = meetsBox(uintBitsToFloat(lower.xyz), uintBitsToFloat(upper.xyz), walk.origin, walk.inverse);
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
  walk.origin = vec3(dot(x, vec4(from, 1.0)), dot(y, vec4(from, 1.0)), dot(z, vec4(from, 1.0)));
  walk.direction = vec3(dot(x.xyz, to - from), dot(y.xyz, to - from), dot(z.xyz, to - from));
  walk.inverse = inverseOf(walk.direction);
  walk.after = walk.at;
  walk.at = walk.begin = int(mesh.x);
  walk.end = int(mesh.y);
  walk.triangles = int(mesh.z);
}

/// 1 where nothing lies strictly between two grid positions for light of `light`, else 0.
float open(vec3 from, vec3 to, int light) {
  const int instances = int(texelFetch(occluders, 0).x);
  Walk above = Walk(1, 1, instances, -1, 0, from, to - from, inverseOf(to - from)), walk = above;
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
        met = met || meetsTriangle(walk.triangles + kTriangleTexels * i, walk.origin, walk.direction);
      if (met) return 0.0;
      rounds += items;
    }
  }
  return 1.0;
}
