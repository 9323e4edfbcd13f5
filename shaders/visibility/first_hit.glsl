// What a ray first meets of what stops all light, or of surfaces that do: the walk of visibility/occluders.glsl, which
// the caller has included, up to the nearest place so far.

struct Sight {
  float at;      // on the segment, 0..1; 1: nothing is met
  int instance;  // its first texel
  int triangle;  // of its mesh, in the order of the mesh's BVH
  bool front;    // its corners are seen counter-clockwise
};

bool stopsAll(int instance) {
#if LPV_TRANSPARENT
  return uintBitsToFloat(texelFetch(occluders, instance + 4).w) == 1.0 && texelFetch(occluders, instance + 5).x == 0u;
#else
  return true;
#endif
}

vec3 normalAt(int triangle) {
  return uintBitsToFloat(uvec3(texelFetch(occluders, triangle).w, texelFetch(occluders, triangle + 1).w,
                               texelFetch(occluders, triangle + 2).w));
}

/// The nearest place on the segment where a placed triangle is met.
void lookAtPlaced(vec3 from, vec3 to, inout Sight sight, inout int rounds) {
  const vec3 origin = placedFromGrid(from), direction = uintBitsToFloat(texelFetch(occluders, 3).w) * (to - from);
  const SegmentBox box = placedBox(origin, direction);
  const Segment segment = segmentOf(origin, direction);
  PlacedWalk walk = placedWalk();
  const int begin = walk.at;
  int owner = 0, nearest = 0;  // texels
  while (walk.at != walk.stop && rounds < kMostRayRounds) {
    const uint leaf = nextPlacedLeaf(walk, box, sight.at, rounds);
    const int items = int(leaf % uint(kLeafItems)), first = int(leaf / uint(kLeafItems));
    for (int i = 0; i < items; ++i, ++rounds) {
      const int texel = first + kTriangleTexels * i;
      const float where = whereMet(texel, segment);
      if (where >= sight.at) continue;
      sight.at = where;
      nearest = texel;
      owner = walk.stop + (walk.root - begin) / 2;
    }
    ++rounds;
  }
  if (nearest == 0) return;
  const vec3 normal = normalAt(nearest);
  const uvec4 of = texelFetch(occluders, owner);
  sight = Sight(sight.at, int(of.x), (nearest - int(of.y)) / kTriangleTexels, dot(normal, direction) < 0.0);
}

void lookInMesh(int instance, vec3 origin, vec3 direction, inout Sight sight, inout int rounds) {
  const uvec4 mesh = texelFetch(occluders, instance + 3);
  const int begin = int(mesh.x), end = int(mesh.y);
  const float reach = max(max(abs(origin.x), abs(origin.y)), abs(origin.z)) + uintBitsToFloat(mesh.z);
  const SegmentBox box = segmentBox(origin, direction, kBoxMargin * reach);
  const Segment segment = segmentOf(origin, direction);
  for (int at = begin; at < end && rounds < kMostRayRounds; ++rounds) {
    const uint leaf = nextLeaf(at, begin, end, box, sight.at, rounds);
    const int items = int(leaf % uint(kLeafItems)), first = int(leaf / uint(kLeafItems));
    for (int i = first; i < first + items; ++i, ++rounds) {
      const int texel = end + kTriangleTexels * i;
      const float where = whereMet(texel, segment);
      if (where >= sight.at) continue;
      sight = Sight(where, instance, i, dot(normalAt(texel), direction) < 0.0);
    }
  }
}

Sight firstHit(vec3 from, vec3 to, bool lights, inout int rounds) {
  const int instances = firstInstance(), end = endOfInstanceNodes();
  const SegmentBox box = segmentBox(from, to - from, kTopMargin);
  Sight sight = Sight(1.0, 0, 0, true);
  lookAtPlaced(from, to, sight, rounds);
  for (int at = kOccluderHeader; at < end && rounds < kMostRayRounds; ++rounds) {
    const uint leaf = nextLeaf(at, kOccluderHeader, end, box, sight.at, rounds);
    const int instance = instances + kInstanceTexels * int(leaf / uint(kLeafItems));
    if (leaf == 0u || !stopsAll(instance) || !(lights || texelFetch(occluders, instance + 6).x > 0u)) continue;
    const mat4x3 object = objectFromGrid(instance);
    lookInMesh(instance, object * vec4(from, 1.0), object * vec4(to - from, 0.0), sight, rounds);
  }
  return sight;
}

Sight firstHit(vec3 from, vec3 to, inout int rounds) { return firstHit(from, to, true, rounds); }

/// Whether what is met reflects light to where the ray comes from.
bool reflects(Sight sight) {
  return sight.at < 1.0 && (texelFetch(occluders, sight.instance + 6).z & (sight.front ? 1u : 2u)) != 0u;
}
