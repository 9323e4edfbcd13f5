// What haze scatters once towards the camera (MATHS.md 3g): a turn of rays from places along each pixel's view to points of
// the lights, or of the patches of surfaces. Of polygons that the view passes at a distance, and of patches, the point comes
// first: the place is chosen by the angle under which it sees the view (equi-angular: Kulla and Fajardo 2012). A mesh is
// looked at from a place that its middle chooses, since half of it faces away. Of kHazeCandidates such pairs one is asked
// for, by what it scatters (Talbot, Cline and Egbert 2005). Beside a light, where 1 / r^2 of a single point says little,
// several places come first, and of all points one is asked for. There, of a mesh or a picture, a ray goes where haze
// scatters from, too, and what it meets of the light is weighed against points. What nothing is in the way of counts whole
// either way.
// A thread has a pixel.
//
// LPV_MESHES: some lights have more than few polygons, or a picture, and rays look for them.
#include "layout.h"
#ifndef LPV_MESHES
#error "LPV_MESHES: 0 or 1"
#endif
#include "common/sh.glsl"
#include "common/colour.glsl"
#include "common/random.glsl"
#include "frame/position.glsl"
#define LPV_FACING 0
#define LPV_FROM_PATCHES 0
#include "visibility/light_points.glsl"
#include "visibility/occluders.glsl"
#include "visibility/first_hit.glsl"
#include "transport/polygons.glsl"
#include "frame/gloss_scene.glsl"

layout(local_size_x = kNearFieldTile, local_size_y = kNearFieldTile) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kHazeParams) uniform HazeBlock { HazeParams params; };
layout(std430, binding = kHazeLights) readonly buffer HazeLights { HazeLight hazeLights[]; };
layout(binding = kDirect) uniform samplerBuffer direct;  // the lights (transport/emitter_list.glsl)
layout(binding = kHazeSumOut, rgba32f) uniform image2D hazeSum;
#include "frame/haze_view.glsl"

// Generates lattice rules of 2^m points, for any m (Cools, Kuo and Nuyens 2006, "Constructing Embedded Lattice Rules").
const uvec4 kLattice = uvec4(1u, 182667u, 469891u, 498753u);
// How far the points are moved from one pixel to the next, across and down. Found by a search: no sum or difference of up to
// three of the four steps repeats after more than 6.8 pixels, and smoothing takes in 7.
const mat2x4 kPixelSteps = mat2x4(0.4697810020, 0.9322728369, 0.3101739531, 0.3592728175,
                                  0.9322733513, 0.5302185313, 0.6407293555, 0.3101684353);
const vec2 kRayStep = vec2(0.7548776662, 0.5698402910);
const float kGoldenStep = 0.6180339887;
const float kLeastApart = 0.02;  // of what a point stands for, by the square of a distance: nearer counts as so far,
const float kLeastApartOfPatch = 0.3;  // and of a patch, which sends what it does from a disc of that size
const float kFewPolygons = 32.0;
const int kPlacesByPolygons = 8;   // on the view, of a ray to a light of few polygons beside it,
const int kPlacesOfPolygons = 12;  // and on the polygons, for each
const int kPlacesByPoints = 4;     // the same beside any other light,
const int kPointsOfNearPart = 8;   // and of each of its parts that is near
const float kEvenPoints = 128.0;   // as which points of a light count beside rays that go where haze sends light from
const int kPointsAtOnce = 4;       // seen from one place, of a light of many triangles that is passed at a distance
const float kSmallAngle = 1e-2;    // below, a triangle looks alike from all of it
const float kBeside = 1.5;         // radii of a light's sphere from its middle: nearer views are beside it
const vec3 kEvenness = vec3(0.02, 0.2, 1.0);  // of variances: places and lights are spread evenly, so that they differ by less
const float kUnevenness = 0.15;    // of what few points say beside a mesh, the share that is taken for chance

/// Of `count` numbers spread evenly over [0, 1), (j + shift) / count, how many are below another.
int countBelow(float end, float shift, int count) { return clamp(int(ceil(end * float(count) - shift)), 0, count); }

/// Which of the evenly spread numbers is taken k-th, so that few of them are spread evenly, too; `count`: a power of 2.
int placeOf(int k, int count) { return int(bitfieldReverse(uint(k)) >> (32 - findMSB(count))); }

/// The k-th point of the lattice, whose first 2^m are spread evenly.
vec4 latticePoint(int k) { return vec4(bitfieldReverse(uint(k)) * kLattice) / 4294967296.0; }

/// How often what has a share of [0, 1) is chosen: as often as numbers fall into it, if some always do.
float chanceOf(float share, int taken, int count) { return share * float(count) >= 1.0 ? float(taken) / float(count) : share; }

struct Choice {
  int light;
  float chance, at;  // at: where within the light's share
};

/// By the k-th number.
Choice lightOf(int k, float shift, int count) {
  const int place = placeOf(k, count);
  int low = 0, high = params.lights - 1;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (countBelow(hazeLights[middle].end, shift, count) <= place) low = middle + 1;
    else high = middle;
  }
  const HazeLight light = hazeLights[low];
  const float begin = low > 0 ? hazeLights[low - 1].end : 0.0, end = low < params.lights - 1 ? light.end : 1.0;
  const int taken = countBelow(end, shift, count) - countBelow(begin, shift, count);
  const float at = (float(place) + shift - begin * float(count)) / max(light.share * float(count), 1e-30);
  return Choice(low, chanceOf(light.share, taken, count), clamp(at, 0.0, 0.999999));
}

/// What a point makes the haze scatter.
struct Scattered {
  vec3 light;      // towards the camera, over how often it is chosen, with nothing solid in the way
  vec3 at, place;  // where it is scattered, and where it comes from
  int source;      // of those that emit, or kFromSurfaces
};
const Scattered kNothing = Scattered(vec3(0.0), vec3(0.0), vec3(0.0), kFromSurfaces);

/// What a point stands for, and what is added to the squares of its distances for that; `emits`: of its texels.
float areaOf(HazeLight light, vec4 emits) { return light.pointArea > 0.0 ? light.pointArea : max(-emits.w, 0.0); }
float leastApart(vec4 emits, float area) { return (emits.w < 0.0 ? kLeastApartOfPatch : kLeastApart) * area + 1e-8; }

/// At t along the view, of light from a place around point i, which stands for an area.
Scattered scatteredAt(View v, float t, int i, vec3 place, float area) {
  const vec4 from = texelFetch(lightPoints, kLightPointTexels * i);
  const vec4 emits = texelFetch(lightPoints, kLightPointTexels * i + 1);
  const vec4 colour = texelFetch(lightPoints, kLightPointTexels * i + 2);
  Scattered s = Scattered(vec3(0.0), frame.eye + t * v.direction, place, max(int(colour.a), kFromSurfaces));
  const vec3 to = place - s.at;
  const float r2 = dot(to, to) + 1e-12, sent = -dot(emits.xyz, to) * inversesqrt(r2);
  const float sends = emits.w > 1.5 ? abs(sent) : max(sent, 0.0);
  if (sends <= 0.0) return s;
  s.light = from.w * sends / (r2 + leastApart(emits, area)) * throughHaze(s.at, place) * scattersFrom(v, t, s.at, place) * colour.rgb;
  return s;
}

/// A place around a point, in its plane, for what it stands for.
vec3 placeAround(vec3 p, vec3 n, float area, vec2 u) {
  const vec3 right = normalize(cross(n, abs(n.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
  const float turn = 2.0 * kPi * u.x;
  return p + sqrt(u.y * area / kPi) * (cos(turn) * right + sin(turn) * cross(n, right));
}

/// How far along the view a light's middle is; `apart`: how far from the view the light is taken to be.
float alongView(View v, HazeLight light, out float apart) {
  const vec3 d = light.sphere.xyz - frame.eye;
  const float along = dot(d, v.direction);
  apart = sqrt(max(dot(d, d) - along * along, 0.0) + 0.25 * light.sphere.w * light.sphere.w);
  return along;
}

bool isBeside(View v, HazeLight light) {
  const vec3 d = light.sphere.xyz - frame.eye;
  const float t = clamp(dot(d, v.direction), v.begin, v.end), reach = kBeside * light.sphere.w;
  return distance(d, t * v.direction) < reach;
}

/// Of four points spread over a light one, in proportion to what it sends, and how often it is chosen so: of what patches
/// and pictures send much comes from few.
int pointOf(HazeLight light, float at, float which, out float chance) {
  ivec4 points;
  vec4 sends;
  for (int k = 0; k < 4; ++k) {
    points[k] = light.firstPoint + min(int(fract(at + kGoldenStep * float(k)) * float(light.points)), light.points - 1);
    sends[k] = texelFetch(lightPoints, kLightPointTexels * points[k]).w;
  }
  const float all = dot(sends, vec4(1.0)), wanted = which * all;
  int chosen = 0;
  for (float before = sends[0]; chosen < 3 && before <= wanted; before += sends[chosen]) ++chosen;
  chance = all > 0.0 ? 4.0 * sends[chosen] / (all * float(light.points)) : 0.0;
  return points[chosen];
}

/// A point, then a place by equal angles about it.
vec3 byPoint(View v, Choice choice, vec4 u, float which, out Scattered chosen) {
  const HazeLight light = hazeLights[choice.light];
  float chance, density;
  const int i = pointOf(light, choice.at, which, chance);
  chosen = kNothing;
  if (chance <= 0.0) return vec3(0.0);
  const vec3 point = texelFetch(lightPoints, kLightPointTexels * i).xyz;
  const vec4 emits = texelFetch(lightPoints, kLightPointTexels * i + 1);
  const float area = areaOf(light, emits);
  const vec3 place = placeAround(point, emits.xyz, area, u.zw), d = place - frame.eye;
  const float along = dot(d, v.direction), apart = sqrt(max(dot(d, d) - along * along, 0.0) + leastApart(emits, area));
  const float t = placeOnView(v, along, apart, u.y, density);
  chosen = scatteredAt(v, t, i, place, area);
  chosen.light /= choice.chance * chance * density;
  return chosen.light;
}

/// Takes one of several in proportion to what they scatter, `weights` so far.
void choose(Scattered s, float choice, inout Scattered chosen, inout float weights) {
  const float weight = largest(s.light);
  weights += weight;
  if (weight > 0.0 && choice * weights < weight) chosen = s;
}

/// A place by equal angles about the middle of a light, then points spread evenly over it, of which many may face away;
/// besides, one of them by what it does.
vec3 byPoints(View v, Choice choice, float at, uint seed, out Scattered chosen) {
  const HazeLight light = hazeLights[choice.light];
  float apart, density, weights = 0.0;
  const float along = alongView(v, light, apart), t = placeOnView(v, along, apart, at, density);
  vec3 all = vec3(0.0);
  chosen = kNothing;
  for (int k = 0; k < kPointsAtOnce; ++k) {
    const float where = fract(choice.at + float(k) / float(kPointsAtOnce));
    const int point = light.firstPoint + min(int(where * float(light.points)), light.points - 1);
    const Scattered s = scatteredAt(v, t, point, pointPosition(point), light.pointArea);
    all += s.light;
    choose(s, randomOf(seed, uint(k)), chosen, weights);
  }
  const float worth = float(light.points) / (float(kPointsAtOnce) * choice.chance * density);
  if (weights > 0.0) chosen.light *= worth * weights / largest(chosen.light);
  return worth * all;
}

/// What all of them scatter with nothing in the way, and what of that something keeps, by the one that is asked for.
struct Found {
  vec3 all, kept;
  float byChance;  // of all of it, by points that are not spread evenly over what they stand for
};
const Found kNothingFound = Found(vec3(0.0), vec3(0.0), 0.0);

/// `worth`: of one of those that have been looked at.
Found found(vec3 all, float byChance, Scattered chosen, float weights, float worth, inout int rounds) {
  if (weights <= 0.0) return kNothingFound;
  const vec3 share = transmitted(chosen.at, mix(chosen.at, chosen.place, kShadowEnd), chosen.source, rounds);
  return Found(worth * all, (1.0 - share) * (worth * weights / largest(chosen.light)) * chosen.light, worth * byChance);
}

bool isFewPolygons(int i) {
  return params.ofSurfaces == 0 && texelFetch(direct, 1 + 2 * i).w == kAsPolygons && texelFetch(direct, 2 + 2 * i).y <= kFewPolygons;
}

/// From lights that are passed at a distance.
Found rayAfar(View v, vec4 shift, uint seed, int k, inout int rounds) {
  vec3 all = vec3(0.0);
  float byChance = 0.0, weights = 0.0;
  Scattered chosen = kNothing;
  for (int i = 0; i < kHazeCandidates; ++i) {
    const int n = k * kHazeCandidates + i;
    const Choice choice = lightOf(n, shift.x, params.turns * kHazeRays * kHazeCandidates);
    const HazeLight light = hazeLights[choice.light];
    if (light.share <= 0.0 || isBeside(v, light)) continue;
    const vec4 u = fract(shift + latticePoint(n));
    const bool isMesh = light.sphere.w > 0.0 && !isFewPolygons(choice.light);
    Scattered s;
    vec3 here;
    if (isMesh) here = byPoints(v, choice, u.y, hashed(seed + uint(n)), s);
    else here = byPoint(v, choice, u, randomOf(seed, 2u * uint(n) + 1u), s);
    all += here;
    if (params.ofSurfaces == 1) byChance += largest(here);
    choose(s, randomOf(seed, 2u * uint(n)), chosen, weights);
  }
  return found(all, byChance, chosen, weights, 1.0 / float(kHazeCandidates), rounds);
}

/// Of triangle t of those of a light that x sees, a place, evenly by solid angle, or where it is small by area.
vec3 placeWithin(int t, vec3 x, float angle, vec2 u) {
  const vec3 a = texelFetch(direct, t).xyz, b = texelFetch(direct, t + 1).xyz, c = texelFetch(direct, t + 2).xyz;
  if (angle < kSmallAngle) return mix(a, mix(b, c, u.y), sqrt(u.x));
  const vec3 to = directionWithin(normalize(a - x), normalize(b - x), normalize(c - x), angle, u), n = cross(b - a, c - a);
  return x + dot(a - x, n) / dot(to, n) * to;
}

float solidAngleOf(int t, vec3 x, float sides) {
  return triangleSolidAngle(texelFetch(direct, t).xyz - x, texelFetch(direct, t + 1).xyz - x,
                            texelFetch(direct, t + 2).xyz - x, sides);
}

/// What few polygons scatter at t along the view, by places spread evenly over their solid angles, and one of these by
/// what it does.
vec3 allOfPolygons(View v, int i, float t, vec4 u, uint seed, out Scattered chosen) {
  const vec4 radiance = texelFetch(direct, 1 + 2 * i), where = texelFetch(direct, 2 + 2 * i);
  const vec3 x = frame.eye + t * v.direction;
  const int first = int(where.x), end = first + 3 * int(where.y);
  float all = 0.0;
  for (int at = first; at < end; at += 3) all += solidAngleOf(at, x, where.z);
  chosen = kNothing;
  if (all <= 0.0) return vec3(0.0);
  const int source = int(texelFetch(lightPoints, kLightPointTexels * hazeLights[i].firstPoint + 2).a);
  const float each = all / float(kPlacesOfPolygons);
  vec3 sum = vec3(0.0);
  float weights = 0.0, next = u.w * each, before = 0.0;
  int k = 0;
  for (int at = first; at < end; at += 3) {
    const float angle = solidAngleOf(at, x, where.z);
    for (before += angle; next < before && k < kPlacesOfPolygons; next += each, ++k) {
      const vec3 place = placeWithin(at, x, angle, fract(u.xz + float(k) * kRayStep));
      const vec3 share = scattersFrom(v, t, x, place) * throughHaze(x, place);
      const Scattered s = Scattered(each * share * radiance.rgb, x, place, source);
      sum += s.light;
      choose(s, randomOf(seed, uint(k)), chosen, weights);
    }
  }
  if (weights > 0.0) chosen.light *= weights / largest(chosen.light);
  return sum;
}

/// Whether rays may find the light: all that it sends from a place goes by its normal there.
bool isMetByRays(int i) { return LPV_MESHES == 1 && (shownLight(i).flags & (kGlossDirected | kGlossUnseen)) == 0u; }

/// How much of what a place of a light scatters at x is found by its points, and not by rays that haze chooses (multiple
/// importance sampling, the balance heuristic: Veach and Guibas 1995). Beside the light few of its points are where most
/// is scattered from. `n`: of the light there.
float shareOfPoints(View v, float area, vec3 x, vec3 place, vec3 n) {
  const vec3 to = place - x;
  const float r2 = dot(to, to) + 1e-12, cosine = abs(dot(n, to)) * inversesqrt(r2);
  const float byPoints = kEvenPoints / area * r2;
  return byPoints / (byPoints + cosine * phase(dot(to, v.direction) * inversesqrt(r2)));
}

/// A direction from which haze scatters light along the view, as often as it does so much; u in [0, 1)^2.
vec3 directionByHaze(View v, vec2 u) {
  const float g = params.anisotropy, s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u.x);
  const float cosine = abs(g) < 1e-3 ? 2.0 * u.x - 1.0 : clamp((1.0 + g * g - s * s) / (2.0 * g), -1.0, 1.0);
  const float turn = 2.0 * kPi * u.y, sine = sqrt(1.0 - cosine * cosine);
  const vec3 right = normalize(cross(v.direction, abs(v.direction.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
  return cosine * v.direction + sine * (cos(turn) * right + sin(turn) * cross(v.direction, right));
}

/// What a ray by haze finds of a light at t along the view: its share beside the light's points.
vec3 rayByHaze(View v, int i, float t, vec2 u, inout int rounds) {
  const vec3 x = frame.eye + t * v.direction, direction = directionByHaze(v, u);
  const vec3 lower = lowestOccluder(), upper = highestOccluder();
  const float beyond = length(max(abs(x - lower), abs(x - upper)));
  const Sight sight = firstHit(x, x + beyond * direction, rounds);
  if (sight.at >= 1.0) return vec3(0.0);
  const vec3 place = x + sight.at * beyond * direction;
  const Met met = metAt(sight, place);
  if (met.light != i) return vec3(0.0);
  const ShownLight light = shownLight(i);
  const float share = 1.0 - shareOfPoints(v, light.area, x, place, met.normal);
  const vec3 arrives = share * radianceAt(met, light, sight.front) * throughHaze(x, place) / phase(dot(direction, v.direction));
  return scattersFrom(v, t, x, place) * arrives * transmitted(x, mix(x, place, kShadowEnd), kFromSurfaces, rounds);
}

/// The same of a light of many triangles, or with a picture, by its points.
vec3 allOfPoints(View v, int i, float t, vec4 u, uint seed, out Scattered chosen) {
  const HazeLight light = hazeLights[i];
  const bool met = isMetByRays(i);
  const float area = shownLight(i).area;
  chosen = kNothing;
  vec3 all = vec3(0.0);
  float weights = 0.0;
  for (int part = 0; part < kCandidates; ++part) {
    const LightPart p = partOf(light.firstPoint, light.points, part, u.w, frame.eye + t * v.direction);
    const int count = p.end - p.begin, taken = p.near ? min(count, kPointsOfNearPart) : 1;
    const float worth = float(count) / float(taken);
    for (int k = 0; k < taken; ++k) {
      const int point = p.begin + (p.one - p.begin + k * count / taken) % count;
      Scattered s = scatteredAt(v, t, point, pointPosition(point), light.pointArea);
      const vec3 n = texelFetch(lightPoints, kLightPointTexels * point + 1).xyz;
      s.light *= met ? worth * shareOfPoints(v, area, s.at, s.place, n) : worth;
      all += s.light;
      choose(s, randomOf(seed, uint(part * kPointsOfNearPart + k)), chosen, weights);
    }
  }
  if (weights > 0.0) chosen.light *= weights / largest(chosen.light);
  return all;
}

/// From a light that the view passes beside, over several places; `chance`: that it was chosen.
Found rayBeside(View v, int i, float chance, vec4 shift, uint seed, int k, inout int rounds) {
  const HazeLight light = hazeLights[i];
  const bool few = isFewPolygons(i), met = !few && isMetByRays(i);
  float apart;
  const float along = alongView(v, light, apart);
  vec3 all = vec3(0.0), byHaze = vec3(0.0);
  float weights = 0.0;
  Scattered chosen = kNothing;
  const int places = few ? kPlacesByPolygons : kPlacesByPoints;
  for (int place = 0; place < places; ++place) {
    const int n = k * places + place, pair = n / 2;
    // Every other place is anywhere on the view: what is scattered forward comes from afar, too. Either kind has a lattice of
    // its own: of one that they share each would see a half of the light.
    const bool anywhere = (n & 1) == 1;
    const vec4 u = fract((anywhere ? shift.zwxy : shift) + latticePoint(pair));
    float density;
    float t = placeOnView(v, along, apart, u.y, density);
    if (anywhere) {
      t = mix(v.begin, v.end, u.y);
      density = densityOnView(v, along, apart, t);
    }
    density = 0.5 * (density + 1.0 / (v.end - v.begin));
    Scattered one;
    vec3 here;
    if (few) here = allOfPolygons(v, i, t, u, hashed(seed + uint(n)), one);
    else here = allOfPoints(v, i, t, u, hashed(seed + uint(n)), one);
#if LPV_MESHES
    if (met) byHaze += rayByHaze(v, i, t, fract(u.zw + 0.5), rounds) / density;
#endif
    all += here / density;
    one.light /= density;
    choose(one, randomOf(seed, 2u * uint(n)), chosen, weights);
  }
  const float worth = 1.0 / (float(places) * chance);
  Found of = found(all, few ? 0.0 : kUnevenness * largest(all), chosen, weights, worth, rounds);
  of.all += worth * byHaze;
  return of;
}

/// About what a light that the view passes beside scatters; 0 of others.
float worthBeside(View v, HazeLight light) {
  return light.points > 0 && isBeside(v, light) ? light.power / light.sphere.w : 0.0;
}

/// For each of a turn's rays one of the lights that the view passes beside, in proportion to their worth, and its chance;
/// -1 where there are none.
void chooseBeside(View v, float shift, out int lights[kHazeRays], out float chances[kHazeRays]) {
  const int count = params.turns * kHazeRays;
  float all = 0.0, end = 0.0;
  for (int i = 0; i < params.lights; ++i) all += worthBeside(v, hazeLights[i]);
  for (int ray = 0; ray < kHazeRays; ++ray) lights[ray] = -1;
  for (int i = 0, begin = 0; i < params.lights && begin < count && all > 0.0; ++i) {
    const float share = worthBeside(v, hazeLights[i]) / all;
    const int next = countBelow(end += share, shift, count);
    for (int ray = 0; ray < kHazeRays; ++ray) {
      const int place = placeOf(params.turn * kHazeRays + ray, count);
      if (place < begin || place >= next) continue;
      lights[ray] = i;
      chances[ray] = chanceOf(share, next - begin, count);
    }
    begin = next;
  }
}

void main() {
  const ivec2 size = imageSize(hazeSum), tiles = (size + kNearFieldTile - 1) / kNearFieldTile;
  const int tile = params.first + int(gl_WorkGroupID.x);
  const ivec2 pixel = kNearFieldTile * ivec2(tile % tiles.x, tile / tiles.x) + ivec2(gl_LocalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size))) return;
  const ivec2 inPicture = pixel + ivec2(0, params.firstRow);
  const vec4 shift = fract(kPixelSteps * vec2(inPicture & 1023));
  const uint seed = hashed(packedPixel(inPicture));
  const View v = viewOf(pixel);
  int beside[kHazeRays];
  float chances[kHazeRays];
  chooseBeside(v, randomOf(~seed, 0u), beside, chances);
  vec3 sum = vec3(0.0);
  vec3 ofRays = vec3(0.0), squares = vec3(0.0);  // found in all; by which light is looked at; by chance alone
  int sent = 0, rounds = 0;
  for (; v.end > v.begin && sent < kHazeRays && rounds < kMostRayRounds; ++sent) {
    const int k = params.turn * kHazeRays + sent;
    const Found afar = rayAfar(v, shift, seed, k, rounds);
    Found near = kNothingFound;
    if (beside[sent] >= 0) near = rayBeside(v, beside[sent], chances[sent], shift, seed, k, rounds);
    const vec3 kept = afar.kept + near.kept, arrives = afar.all + near.all - kept;
    const vec3 chosen = (params.lights > 1 ? afar.all : vec3(0.0)) + (chances[sent] < 1.0 ? near.all : vec3(0.0));
    const vec3 one = vec3(largest(arrives), largest(chosen), largest(kept) + afar.byChance + near.byChance);
    sum += arrives;
    ofRays += one;
    squares += one * one;
  }
  const float rays = float(max(sent, 1)), share = float(kHazeRays) / rays;
  const vec3 variance = max(squares - ofRays * ofRays / rays, vec3(0.0)) * rays / max(rays - 1.0, 1.0);  // of the sum
  const vec4 turn = vec4(share * sum, share * share * dot(variance, kEvenness));
  imageStore(hazeSum, pixel, turn + (params.firstTurn == 1 ? vec4(0.0) : imageLoad(hazeSum, pixel)));
}
