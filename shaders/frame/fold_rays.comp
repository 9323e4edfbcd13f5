// What pieces of folds send to points that are near to them: rays all around, spread by the cosine, see the nearest of what
// they meet, and it counts where the patch that stands for it is left out (patch_light.comp). kFoldRays a dispatch.
// Threads per point.
#include "layout.h"
#include "common/sh.glsl"
#include "visibility/occluders.glsl"
#include "visibility/first_hit.glsl"
#include "visibility/patches.glsl"
#include "visibility/receivers.glsl"
#include "visibility/folds.glsl"
#include "visibility/shadow_points.glsl"

layout(local_size_x = 4 * kNearFieldGroup) in;

#if LPV_PATCHES
layout(std430, binding = kFoldHits) writeonly buffer FoldHits { int foldHits[]; };  // filled with kNoRay
#endif

// Steps of sequences whose points are spread evenly (Roberts 2018), from pixel to pixel.
const mat2 kPixelSteps = mat2(0.8191725134, 0.5497004779, 0.6710436067, 0.3819660113);

/// A ray's direction about n: of a turn's the one in its part of all directions, another one in it for another pixel. So
/// the rays that threads send together go about the same way, and through the same nodes.
vec3 directionAbout(vec3 n, ivec2 pixel, int turn, int ray) {
  const vec2 shift = fract(kPixelSteps * vec2(pixel & 1023) + 0.6180339887 * vec2(ray, turn));
  const vec2 at = (vec2(turn, ray) + shift) / vec2(shadow.foldTurns, kFoldRays);
  const vec3 right = normalize(cross(n, abs(n.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
  const float around = 2.0 * kPi * at.y;
  return sqrt(at.x) * (cos(around) * right + sin(around) * cross(n, right)) + sqrt(1.0 - at.x) * n;
}

/// What is seen from x in a direction, as far as that is long, if it counts; `share`: how much.
int pieceSeen(vec3 x, vec3 direction, inout int rounds, out vec3 place, out float share) {
  const Sight sight = firstHit(x, x + direction, rounds);
  place = x + sight.at * direction;
  share = 0.0;
  const int piece = pieceAt(sight, place, shadow.pointCount);
  if (piece == kNoPiece) return kNoPiece;
  const int of = int(patches[shadow.pointCount + piece].of);
  const vec3 d = patches[of].place.xyz - x;
  share = foldedShare(dot(d, d), kFromFolds - patches[of].corners[2].w);
  return share > 0.0 ? piece : kNoPiece;
}

vec3 arrivesOf(int piece, vec3 x, vec3 place, inout int rounds) {
  if (piece == kNoPiece) return vec3(0.0);
#if LPV_TRANSPARENT
  return pieceLights[piece].rgb * throughHaze(x, place) * transmitted(x, mix(x, place, kShadowEnd), kFromSurfaces, rounds);
#else
  return pieceLights[piece].rgb;
#endif
}

void main() {
  const uint point = gl_GlobalInvocationID.x, four = point / 4u;
  if (four >= list.count || shadowPoints[point].asked.a == 0.0) return;
  const ivec2 pixel = receiverOf(points[four][point % 4u]);
  const vec3 n = receiverNormal(pixel), x = rayStart(pixel, n);
  const vec3 lower = lowestOccluder(), upper = highestOccluder();
  const float beyond = length(max(abs(x - lower), abs(x - upper)));  // all that there is is nearer
  const float reach = min(beyond, 1.001 * shadowPoints[point].asked.a);  // and all that counts
  vec3 sum = vec3(0.0);
  int rays = 0, rounds = 0;
  for (; rays < kFoldRays && rounds < kMostRayRounds; ++rays) {
    vec3 place;
    float share;
    const int piece = pieceSeen(x, reach * directionAbout(n, inPicture(pixel), shadow.turn, rays), rounds, place, share);
    sum += share * arrivesOf(piece, x, place, rounds);
#if LPV_PATCHES
    foldHits[(pixel.x - shadow.pointCount) * shadow.foldTurns * kFoldRays + shadow.turn * kFoldRays + rays] = piece;
#endif
  }
  shadowPoints[point].known.rgb += kPi / float(rays * shadow.foldTurns) * sum;
}
