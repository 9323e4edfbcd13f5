// What the lobes of a picture's surfaces reflect: a turn of rays in their directions, and as many to points of the lights,
// weighed against each other (multiple importance sampling, the balance heuristic: Veach and Guibas 1995). Of places on
// surfaces that rays meet kGlossPlaces are kept, in proportion to what it would reflect (Talbot, Cline and Egbert 2005), whose E is
// found after the last turn: those are listed then (near_field_evaluate.comp). A work-group has a block of pixels.
#include "layout.h"
#include "common/sh.glsl"
#include "common/colour.glsl"
#include "common/random.glsl"
#include "common/octahedral.glsl"
#include "frame/position.glsl"
#include "frame/point_list.glsl"
#include "visibility/occluders.glsl"
#include "visibility/first_hit.glsl"
#include "frame/gloss.glsl"
#include "frame/gloss_points.glsl"
#include "frame/gloss_scene.glsl"

layout(local_size_x = kNearFieldBlockX, local_size_y = kNearFieldBlockY) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kGlossParams) uniform GlossBlock { GlossParams params; };
layout(binding = kEmitterDepth) uniform sampler2D emitterDepth;
layout(binding = kLightPoints) uniform samplerBuffer lightPoints;

shared uint metInBlock[kGlossPlaces];
shared uint openInBlock;  // pixels that go on

// As in fold_rays.comp; and numbers for choices.
const vec2 kRayStep = vec2(0.7548776662, 0.5698402910);
const mat2 kPixelSteps = mat2(0.8191725134, 0.5497004779, 0.6710436067, 0.3819660113);
const float kGoldenStep = 0.6180339887;
const int kCandidates = 8;  // points of lights that are weighed for a ray
const int kEvenPoints = 256;  // of a light in a list, at most, that has few polygons: they are spread evenly over it
const float kFewEven = 16.0;  // of a light's points in a lobe: half of their share is left to rays of the lobe;
const float kFewOthers = 32768.0;  // the same of any other light's
const float kLeastTurns = 4.0;
const float kEvenEnough = 0.05;  // standard error of what is seen of lights, as a share of it, that ends a pixel's turns
const float kLeastUp = 0.2;  // cosine: rays along the surface begin no further ahead, where something may stand on it
const float kNearest = 4.0 * kShadowOffset;  // cells: a ray below the triangle of its own start meets it at once

/// Where reflections begin.
struct Receiver {
  vec3 x, n, v;
  Lobe lobe;
  float off;     // of x from the surface
  float beyond;  // all that there is is nearer
  vec2 shift;    // of the pixel's sequences
  uint seed;     // of its choices, which are not like those beside it: sequences would make patterns of them
};

/// In the picture, of a pixel of the band.
ivec2 ofPicture(ivec2 at) { return at + ivec2(0, params.bandRow); }

bool isGlossy(ivec2 pixel) {
  if (pixel.y < 0 || pixel.y >= textureSize(surfaceDepth, 0).y) return false;
  const float depth = texelFetch(surfaceDepth, pixel, 0).x, emitter = texelFetch(emitterDepth, pixel, 0).x;
  const vec2 m = texelFetch(material, pixel, 0).xy;
  return depth > 0.0 && !(emitter > 0.0 && emitter >= depth) && (m.y > 0.0 || m.x < 1.0);
}

Receiver receiverAt(ivec2 pixel) {
  Receiver r;
  const vec3 place = surfacePosition(frame, pixel);
  r.n = surfaceNormal(pixel);
  r.x = rayStart(frame, place, r.n, texelFetch(surfaceDepth, pixel, 0).x);
  r.off = dot(r.x - place, r.n);
  r.v = normalize(frame.eye - place);
  r.lobe = lobeAt(frame, pixel);
  const vec3 lower = lowestOccluder(), upper = highestOccluder();
  r.beyond = length(max(abs(r.x - lower), abs(r.x - upper)));
  r.seed = hashed(packedPixel(pixel + ivec2(0, params.firstRow)));
  r.shift = kPixelSteps * vec2((pixel + ivec2(0, params.firstRow)) & 1023);
  return r;
}

/// By which density kCandidates points of a light, of which one alone has `ofOne`, share with rays of the lobe, which have
/// `ofLobe`. It has a fixed list of points: a lobe with few of them in it meets the same few with every ray, which is not
/// what the light sends there however many are sent.
float sharedBy(ShownLight light, float ofOne, float ofLobe) {
  const float inLobe = float(light.points) * ofOne / max(ofLobe, 1e-20);
  return float(kCandidates) * ofOne * inLobe / (inLobe + (light.points > kEvenPoints ? kFewOthers : kFewEven));
}

/// What gets to the receiver from a place, of which no opaque thing is in the way: through panes and haze.
vec3 throughAir(vec3 x, vec3 place, inout int rounds) {
#if LPV_TRANSPARENT
  return throughHaze(x, place) * transmitted(x, mix(x, place, kShadowEnd), kFromSurfaces, rounds);
#else
  return vec3(1.0);
#endif
}

/// Of a light that a ray has met: radiance times the ray's share beside rays to points.
vec3 fromLight(Receiver r, Met met, float distance2, vec3 direction, bool front) {
  const ShownLight light = shownLight(met.light);
  if ((light.flags & kGlossDirected) != 0u) return vec3(0.0);  // points alone know where it sends how much
  float share = 1.0;
  if (r.lobe.alpha >= kMirrorAlpha) {
    float density;
    reflectedFrom(r.lobe, r.n, r.v, direction, density);
    const float ofOne = chanceOf(light) * distance2 / max(abs(dot(met.normal, direction)), 1e-6);
    share = density / (density + sharedBy(light, ofOne, density));
  }
  return share * radianceAt(met, light, front);
}

/// Takes a place that a ray has met on a surface, or keeps the one before. `reflected`: what the lobe and the albedo there
/// make of radiance 1.
void offer(inout GlossPoint p, vec3 reflected, vec4 place, vec3 n, float choice) {
  const float chance = largest(reflected);
  if (chance <= 0.0) return;
  p.met.a += chance;
  if (choice * p.met.a >= chance && p.place.a > 0.0) return;
  p.met.rgb = reflected / chance;
  p.place = place;
  p.normal.xyz = n;
}

/// Where a ray begins that goes on through the pixel's place on its surface: else a mirror's picture is moved.
vec3 startTowards(Receiver r, vec3 direction) {
  const float up = dot(direction, r.n);
  return r.x + r.off / max(up, kLeastUp) * (direction - up * r.n);
}

/// A ray in a direction of the lobe: what it shows of a light.
vec3 rayOfLobe(Receiver r, int k, inout GlossPoint p, inout int rounds) {
  vec3 direction;
  const vec3 worth = reflectedTo(r.lobe, r.n, r.v, fract(r.shift + float(k) * kRayStep), direction);
  if (worth == vec3(0.0)) return vec3(0.0);
  const vec3 x = startTowards(r, direction);
  const Sight sight = firstHit(x, x + r.beyond * direction, rounds);
  const float distance_ = sight.at * r.beyond;
  if (sight.at >= 1.0 || distance_ < kNearest) return vec3(0.0);
  const vec3 place = x + distance_ * direction;
  const Met met = metAt(sight, place);
  const vec3 arrives = worth * throughAir(x, place, rounds);
  if (met.light >= 0) return arrives * fromLight(r, met, distance_ * distance_, direction, sight.front);
  if (met.surface >= 0) {
    const float choice = randomOf(r.seed, 2u * uint(k));
    offer(p, arrives * albedoAt(met, sight.front), vec4(place, distance_), met.normal, choice);
  }
  return vec3(0.0);
}

/// A point of a light that a ray may go to.
struct Candidate {
  vec3 reflected;  // of its radiance by the lobe, its share beside rays of the lobe
  vec3 place;
  int light;
};

Candidate candidateAt(Receiver r, int k) {
  float at = fract(r.shift.x + 0.5 * r.shift.y + float(k) * kGoldenStep);
  Candidate c = Candidate(vec3(0.0), vec3(0.0), lightAt(at));
  const ShownLight light = shownLight(c.light);
  const int point = light.firstPoint + min(int(at * float(light.points)), light.points - 1);
  const vec4 from = texelFetch(lightPoints, kLightPointTexels * point);
  const vec4 emits = texelFetch(lightPoints, kLightPointTexels * point + 1);
  c.place = from.xyz;
  const vec3 d = from.xyz - r.x;
  const float r2 = dot(d, d) + 1e-8, apart = sqrt(r2), along = -dot(emits.xyz, d) / apart;
  const float sends = emits.w > 1.5 ? abs(along) : max(along, 0.0), chance = chanceOf(light);
  if (sends <= 0.0 || light.points == 0 || chance <= 0.0) return c;
  float density;
  const vec3 reflected = reflectedFrom(r.lobe, r.n, r.v, d / apart, density);
  const float ofOne = chance * r2 / sends, shared_ = sharedBy(light, ofOne, density);
  const bool known = (light.flags & (kGlossDirected | kGlossUnseen)) != 0u;  // to rays to points alone
  const vec3 radiance = from.w * float(light.points) / light.area * texelFetch(lightPoints, kLightPointTexels * point + 2).rgb;
  const float share = known ? 1.0 : shared_ / (shared_ + density);
  c.reflected = share * reflected * radiance / (float(kCandidates) * ofOne);
  return c;
}

/// What kCandidates points of the lights send, and a ray to one of them, chosen by what it sends: all of it arrives if
/// that does (Talbot, Cline and Egbert 2005).
vec3 rayToLight(Receiver r, int k, inout int rounds) {
  vec3 all = vec3(0.0), place = vec3(0.0);
  float weights = 0.0;
  int light = 0;
  for (int i = 0; i < kCandidates; ++i) {
    const Candidate c = candidateAt(r, k * kCandidates + i);
    const float weight = largest(c.reflected);
    all += c.reflected;
    weights += weight;
    const float choice = randomOf(r.seed, 2u * uint(k * kCandidates + i) + 1u);
    if (weight <= 0.0 || choice * weights >= weight) continue;
    place = c.place;
    light = c.light;
  }
  if (weights <= 0.0 || params.shadows == 0) return all;
#if LPV_TRANSPARENT
  all *= throughHaze(r.x, place);
#endif
  return all * transmitted(r.x, mix(r.x, place, kShadowEnd), light, rounds);
}

/// Whether what the turns before have seen of lights is all the same, nearly: then more say no more. A block goes on
/// together: a pixel that has seen nothing yet may be beside one that has.
bool isKnown(ivec2 at) {
  const GlossPoint p = glossPoints[glossIndex(frame, at)];
  const float all = largest(p.lights.rgb) / p.lights.a;
  return p.lights.a >= kLeastTurns && varianceOf(p) <= kEvenEnough * kEvenEnough * all * all;
}

/// Whether places of the pixel have been met and are asked about, a bit each.
uint metBy(ivec2 at) {
  uint met = 0u;
  for (int i = 0; i < kGlossPlaces; ++i) {
    const bool here = glossPoints[glossIndex(frame, at + ivec2(i * pictureWidth(frame), 0))].place.a > 0.0;
    met |= here && isAsked(params, at, i) ? 1u << i : 0u;
  }
  return met;
}

void turnOfRays(ivec2 at) {
  const Receiver r = receiverAt(ofPicture(at));
  const ivec2 next = ivec2(pictureWidth(frame), 0);
  GlossPoint p[kGlossPlaces];
  for (int i = 0; i < kGlossPlaces; ++i) {
    p[i] = GlossPoint(vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    if (params.turn > 0) p[i] = glossPoints[glossIndex(frame, at + i * next)];
  }
  const bool mirror = r.lobe.alpha < kMirrorAlpha;
  vec3 sum = vec3(0.0);
  int rounds = 0;
  for (int i = 0; i < kGlossRays && rounds < kMostRayRounds; ++i) {
    const int k = params.turn * kGlossRays + i;
    sum += rayOfLobe(r, k, p[i % kGlossPlaces], rounds);
    if (!mirror && lightsShown() > 0) sum += rayToLight(r, k, rounds);
  }
  const vec3 lights = sum / float(kGlossRays);
  p[0].lights += vec4(lights, 1.0);
  p[0].normal.a += largest(lights) * largest(lights);
  for (int i = 0; i < kGlossPlaces; ++i) glossPoints[glossIndex(frame, at + i * next)] = p[i];
}

void main() {
  const ivec2 size = ivec2(pictureWidth(frame), params.bandRows), block = ivec2(kNearFieldBlockX, kNearFieldBlockY);
  const ivec2 blocks = (size + block - 1) / block;
  const int index = params.first + int(gl_WorkGroupID.x);
  const ivec2 corner = block * ivec2(index % blocks.x, index / blocks.x), at = corner + ivec2(gl_LocalInvocationID.xy);
  const uint thread = gl_LocalInvocationIndex;
  if (thread < uint(kGlossPlaces)) metInBlock[thread] = 0u;
  if (thread == 0u) openInBlock = 0u;
  barrier();
  const bool inside = all(lessThan(at, size)), glossy = inside && isGlossy(ofPicture(at));
  if (glossy && (params.turn == 0 || !isKnown(at))) atomicOr(openInBlock, 1u);
  barrier();
  if (glossy && openInBlock != 0u) turnOfRays(at);
  if (inside && !glossy && params.turn == 0) glossPoints[glossIndex(frame, at)].lights = vec4(0.0);
  if (params.last == 0) return;
  const uint met = glossy ? metBy(at) : 0u;
  for (int i = 0; i < kGlossPlaces; ++i)
    if ((met >> i & 1u) != 0u) atomicOr(metInBlock[i], 1u << thread);
  barrier();
  if (thread < uint(kGlossPlaces))
    listPoints(metInBlock[thread], corner + ivec2(int(thread) * size.x, 0), ivec2(1));
}
