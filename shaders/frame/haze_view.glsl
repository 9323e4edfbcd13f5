// What of a pixel's view lies in haze, and what that makes of light (MATHS.md 3g). LPV_PANES: the picture has panes, which
// take from what is scattered behind them; the walk is slow even where it meets none.
#ifndef LPV_PANES
#error "LPV_PANES: 0 or 1"
#endif
layout(binding = kSurfaceDepth) uniform sampler2D surfaceDepth;
layout(binding = kEmitterDepth) uniform sampler2D emitterDepth;

/// Of the way from the eye, what lies in the haze before anything solid, in cells.
struct View {
  vec3 direction;
  float begin, end;
};

View viewOf(ivec2 pixel) {
  const vec2 uv = (vec2(pixel) + 0.5) * frame.pixelSize;
  View v;
  v.direction = normalize(frame.rayOrigin + uv.x * frame.rayRight + uv.y * frame.rayDown);
  const float depth = max(texelFetch(surfaceDepth, pixel, 0).x, texelFetch(emitterDepth, pixel, 0).x);
  const vec3 lower = uintBitsToFloat(texelFetch(occluders, 1).xyz), upper = uintBitsToFloat(texelFetch(occluders, 2).xyz);
  const float beyond = length(max(abs(frame.eye - lower), abs(frame.eye - upper)));
  const float reach = depth > 0.0 ? min(distance(gridPosition(frame, vec2(pixel) + 0.5, depth), frame.eye), beyond) : beyond;
  const vec2 part = reach * partInHaze(frame.eye, reach * v.direction);
  v.begin = part.x;
  v.end = part.y;
  return v;
}

/// Per solid angle, of what is scattered, by the cosine of the angle by which it turns (Henyey and Greenstein 1941).
float phase(float cosine) {
  const float g = params.anisotropy, d = 1.0 + g * g - 2.0 * g * cosine;
  return (1.0 - g * g) / (4.0 * kPi * d * sqrt(d));
}

#if LPV_PANES
/// What panes leave of light between two places on a view. Where a mask stops it the view ends, or it is beside that.
vec3 throughPanes(vec3 from, vec3 to) {
  const int instances = firstInstance(), end = endOfInstanceNodes();
  const SegmentBox box = segmentBox(from, to - from, kTopMargin);
  vec3 share = vec3(1.0);
  int rounds = 0;
  for (int at = kOccluderHeader; at < end && rounds < kMostRayRounds; ++rounds) {
    const uint leaf = nextLeaf(at, kOccluderHeader, end, box, 1.0, rounds);
    const int instance = instances + kInstanceTexels * int(leaf / uint(kLeafItems));
    if (leaf == 0u || stopsAll(instance)) continue;
    const mat4x3 object = objectFromGrid(instance);
    const vec3 origin = object * vec4(from, 1.0), direction = object * vec4(to - from, 0.0);
    const vec3 here = throughMesh(instance, texelFetch(occluders, instance + 3), origin, direction, rounds);
    if (here != vec3(0.0)) share *= here;
  }
  return share;
}
#endif

/// Towards the camera, of light that comes to x, at t along the view, from a place.
vec3 scattersFrom(View v, float t, vec3 x, vec3 place) {
  const float scatters = phase(dot(normalize(place - x), v.direction)) * exp(-hazeExtinction() * (t - v.begin));
#if LPV_PANES
  return params.scattering * scatters * throughPanes(frame.eye, x);
#else
  return vec3(params.scattering * scatters);
#endif
}

/// How often placeOnView() comes to t, per cell.
float densityOnView(View v, float along, float apart, float t) {
  const float all = atan((v.end - along) / apart) - atan((v.begin - along) / apart), past = t - along;
  return apart / (all * (apart * apart + past * past));
}

/// A place on the view, by equal angles about where it passes something at a distance.
float placeOnView(View v, float along, float apart, float u, out float density) {
  const float first = atan((v.begin - along) / apart), last = atan((v.end - along) / apart);
  const float t = clamp(along + apart * tan(mix(first, last, u)), v.begin, v.end);
  density = densityOnView(v, along, apart, t);
  return t;
}
