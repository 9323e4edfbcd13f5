// Dense sampling (paper 4.1), for comparison: random points on every triangle, each a VPL of its nearest cell. A thread
// takes up to kSamplesPerThread points of one triangle. COUNT: one lobe each; FLUX: an equal part of the area each.
#include "voxelize/voxelize.glsl"

layout(local_size_x = kVoxelizeGroup) in;

/// The finaliser of MurmurHash3: every bit of the result depends on every bit of h.
uint mixed(uint h) {
  h = (h ^ (h >> 16)) * 0x85EBCA6Bu;
  h = (h ^ (h >> 13)) * 0xC2B2AE35u;
  return h ^ (h >> 16);
}

double unitInterval(uint h) { return double(h >> 8) / 16777216.0lf + 1.0lf / 33554432.0lf; }

/// Barycentric coordinates of a point, uniform over the triangle (Turk 1990).
dvec2 samplePoint(uint triangle, uint number) {
  const uint h = triangle * 0x9E3779B9u ^ number * 0x85EBCA6Bu;
  const double r1 = sqrt(unitInterval(mixed(h))), r2 = unitInterval(mixed(h + 0x68BC21EBu));
  return dvec2(r1 * (1.0lf - r2), r1 * r2);
}

void deposit(EmittingTriangle e, ivec3 cell, dvec2 lambda, uint samples) {
  const vec3 direction = directionAt(e.varying_, lambda);
#if LPV_TEXTURED
  const vec3 colour = textureAt(uvAt(e.varying_, lambda));
#else
  const vec3 colour = vec3(1.0);
#endif
#if LPV_FLUX
  addMoments(cell, e.area / double(samples), sameForAll(dvec3(direction)), dvec3(colour));
#else
  addLobes(cell, 1u, direction, colour);
#endif
}

void main() {
  const uint thread = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * uint(kVoxelizeGroup) + gl_LocalInvocationID.x;
  const uint local = thread / params.threadsPerTriangle;
  if (local >= params.triangleCount) return;
  const uint first = thread % params.threadsPerTriangle * uint(kSamplesPerThread);
  EmittingTriangle e;
  if (!loadTriangle(params.firstTriangle + local, e)) {
    if (first == 0u) atomicAdd(voxelHeader.degenerate, 1u);
    return;
  }
  const dvec3 a = gridPoint(objectVertex(e.corners.x));
  const dvec3 ab = gridPoint(objectVertex(e.corners.y)) - a, ac = gridPoint(objectVertex(e.corners.z)) - a;
  const uint last = min(first + uint(kSamplesPerThread), params.samplesPerTriangle);
  for (uint i = first; i < last; ++i) {
    const dvec2 lambda = samplePoint(e.index, i);
    const dvec3 at = a + lambda.x * ab + lambda.y * ac, upper = dvec3(params.dims);
    // The grid's outer upper face belongs to its last cell.
    const dvec3 p = mix(floor(at), upper - 1.0lf, equal(at, upper));
    if (any(lessThan(p, dvec3(0.0lf))) || any(greaterThanEqual(p, dvec3(params.dims)))) continue;
    deposit(e, ivec3(p), lambda, params.samplesPerTriangle);
  }
}
