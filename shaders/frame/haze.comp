// What haze scatters once towards the camera (MATHS.md 3g): a turn of rays from places along each pixel's view to points of
// the lights, or of the patches of surfaces. Of a light that the view passes at a distance the point comes first: the place
// is chosen by the angle under which it sees the view (equi-angular: Kulla and Fajardo 2012), and of kHazeCandidates such
// pairs one is asked for, by what it scatters (Talbot, Cline and Egbert 2005). Beside a light, where 1 / r^2 of a single point
// says little, the place comes first, and of all points one is asked for. What nothing is in the way of counts whole either way.
// A thread has a pixel.
#include "layout.h"
#include "common/sh.glsl"
#include "common/random.glsl"
#include "frame/position.glsl"
#define LPV_FACING 0
#include "visibility/light_points.glsl"
#include "visibility/occluders.glsl"
#include "transport/polygons.glsl"

layout(local_size_x = kNearFieldTile, local_size_y = kNearFieldTile) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kHazeParams) uniform HazeBlock { HazeParams params; };
layout(std430, binding = kHazeLights) readonly buffer HazeLights { HazeLight hazeLights[]; };
layout(binding = kDirect) uniform samplerBuffer direct;  // the lights (transport/emitter_list.glsl)
layout(binding = kHazeSumOut, rgba32f) uniform image2D hazeSum;
layout(binding = kHazeChanceOut, rg32f) uniform image2D hazeChance;
#include "frame/haze_view.glsl"

// Steps of a sequence in four dimensions whose points are spread evenly (Roberts 2018), and of its shifts from pixel to
// pixel, which are other numbers.
const vec4 kSampleSteps = vec4(0.8566748839, 0.7338918566, 0.6287067210, 0.5385972572);
const mat2x4 kPixelSteps = mat2x4(0.8191725134, 0.5497004779, 0.7548776662, 0.2451223338,
                                  0.6710436067, 0.3819660113, 0.5698402910, 0.8191725134);
const vec2 kRayStep = vec2(0.7548776662, 0.5698402910);
const float kGoldenStep = 0.6180339887;
const float kLeastApart = 0.02;  // of what a point stands for, by the square of a distance: nearer counts as so far,
const float kLeastApartOfPatch = 0.3;  // and of a patch, which sends what it does from a disc of that size
const float kFewPolygons = 32.0;
const int kPlacesByPolygons = 8;   // on the view, of a ray to a light of few polygons beside it,
const int kPlacesOfPolygons = 12;  // and on the polygons, for each
const int kPlacesByPoints = 2;     // the same beside any other light,
const int kPointsOfNearPart = 4;   // and of each of its parts that is near
const float kSmallAngle = 1e-2;    // below, a triangle looks alike from all of it
const float kBeside = 1.5;       // radii of a light's sphere from its middle: nearer views are beside it

/// The light that a number in [0, 1) chooses, and where within its share the number is.
int lightAt(inout float at) {
  int low = 0, high = params.lights - 1;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (hazeLights[middle].end <= at) low = middle + 1;
    else high = middle;
  }
  const HazeLight light = hazeLights[low];
  at = clamp((at - light.end + light.share) / max(light.share, 1e-30), 0.0, 0.999999);
  return low;
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

bool isBeside(View v, HazeLight light) {
  const vec3 d = light.sphere.xyz - frame.eye;
  const float t = clamp(dot(d, v.direction), v.begin, v.end), reach = kBeside * light.sphere.w;
  return distance(d, t * v.direction) < reach;
}

/// Of four points spread over a light one, in proportion to what it sends, and how often it is chosen so: of what patches
/// and pictures send much comes from few.
int pointOf(HazeLight light, float at, float choice, out float chance) {
  ivec4 points;
  vec4 sends;
  for (int k = 0; k < 4; ++k) {
    points[k] = light.firstPoint + min(int(fract(at + 0.25 * float(k)) * float(light.points)), light.points - 1);
    sends[k] = texelFetch(lightPoints, kLightPointTexels * points[k]).w;
  }
  const float all = dot(sends, vec4(1.0)), wanted = choice * all;
  int chosen = 0;
  for (float before = sends[0]; chosen < 3 && before <= wanted; before += sends[chosen]) ++chosen;
  chance = all > 0.0 ? 4.0 * sends[chosen] / (all * float(light.points)) : 0.0;
  return points[chosen];
}

/// A point, then a place; nothing of lights that the view passes beside.
Scattered byPoint(View v, vec4 u, float choice) {
  const HazeLight light = hazeLights[lightAt(u.x)];
  if (light.share <= 0.0 || isBeside(v, light)) return kNothing;
  float chance, density;
  const int i = pointOf(light, u.x, choice, chance);
  if (chance <= 0.0) return kNothing;
  const vec3 point = texelFetch(lightPoints, kLightPointTexels * i).xyz;
  const vec4 emits = texelFetch(lightPoints, kLightPointTexels * i + 1);
  const float area = areaOf(light, emits);
  const vec3 place = placeAround(point, emits.xyz, area, u.zw), d = place - frame.eye;
  const float along = dot(d, v.direction), apart = sqrt(max(dot(d, d) - along * along, 0.0) + leastApart(emits, area));
  const float t = placeOnView(v, along, apart, u.y, density);
  Scattered s = scatteredAt(v, t, i, place, area);
  s.light /= light.share * chance * density;
  return s;
}

/// Takes one of several in proportion to what they scatter, `weights` so far.
void choose(Scattered s, float choice, inout Scattered chosen, inout float weights) {
  const float weight = largest(s.light);
  weights += weight;
  if (weight > 0.0 && choice * weights < weight) chosen = s;
}

/// What all of them scatter with nothing in the way, and what of that something keeps, by the one that is asked for.
struct Found {
  vec3 all, kept;
};

Found found(vec3 all, Scattered chosen, float weights, inout int rounds) {
  if (weights <= 0.0) return Found(vec3(0.0), vec3(0.0));
  const vec3 share = transmitted(chosen.at, mix(chosen.at, chosen.place, kShadowEnd), chosen.source, rounds);
  return Found(all, (1.0 - share) * (weights / largest(chosen.light)) * chosen.light);
}

/// From lights that are passed at a distance.
Found rayAfar(View v, vec4 shift, uint seed, int k, inout int rounds) {
  vec3 all = vec3(0.0);
  float weights = 0.0;
  Scattered chosen = kNothing;
  for (int i = 0; i < kHazeCandidates; ++i) {
    const int n = k * kHazeCandidates + i;
    const Scattered s = byPoint(v, fract(shift + float(n) * kSampleSteps), randomOf(seed, 2u * uint(n) + 1u));
    all += s.light;
    choose(s, randomOf(seed, 2u * uint(n)), chosen, weights);
  }
  const Found f = found(all, chosen, weights, rounds);
  return Found(f.all / float(kHazeCandidates), f.kept / float(kHazeCandidates));
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
      const float share = scattersFrom(v, t, x, place) * throughHaze(x, place);
      const Scattered s = Scattered(each * share * radiance.rgb, x, place, source);
      sum += s.light;
      choose(s, randomOf(seed, uint(k)), chosen, weights);
    }
  }
  if (weights > 0.0) chosen.light *= weights / largest(chosen.light);
  return sum;
}

/// The same of a light of many triangles, or with a picture, by its points.
vec3 allOfPoints(View v, int i, float t, vec4 u, uint seed, out Scattered chosen) {
  const HazeLight light = hazeLights[i];
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
      s.light *= worth;
      all += s.light;
      choose(s, randomOf(seed, uint(part * kPointsOfNearPart + k)), chosen, weights);
    }
  }
  if (weights > 0.0) chosen.light *= weights / largest(chosen.light);
  return all;
}

bool isFewPolygons(int i) {
  return texelFetch(direct, 1 + 2 * i).w == kAsPolygons && texelFetch(direct, 2 + 2 * i).y <= kFewPolygons;
}

/// From a light that the view passes beside, over several places; `chance`: that it was chosen.
Found rayBeside(View v, int i, float chance, vec4 shift, uint seed, int k, inout int rounds) {
  const HazeLight light = hazeLights[i];
  const bool few = isFewPolygons(i);
  const vec3 d = light.sphere.xyz - frame.eye;
  const float along = dot(d, v.direction), radius = light.sphere.w;
  const float apart = sqrt(max(dot(d, d) - along * along, 0.0) + 0.25 * radius * radius);
  vec3 all = vec3(0.0);
  float weights = 0.0;
  Scattered chosen = kNothing;
  const int places = few ? kPlacesByPolygons : kPlacesByPoints;
  for (int place = 0; place < places; ++place) {
    const int n = k * places + place;
    const vec4 u = fract(shift + float(n) * kSampleSteps);
    const float at = fract(shift.y + float(n / 2) * kGoldenStep);
    float density;
    float t = placeOnView(v, along, apart, at, density);
    if ((n & 1) == 1) {  // anywhere on the view: what is scattered forward comes from afar, too
      t = mix(v.begin, v.end, at);
      density = densityOnView(v, along, apart, t);
    }
    density = 0.5 * (density + 1.0 / (v.end - v.begin));
    Scattered one;
    vec3 here;
    if (few) here = allOfPolygons(v, i, t, u, hashed(seed + uint(n)), one);
    else here = allOfPoints(v, i, t, u, hashed(seed + uint(n)), one);
    all += here / density;
    one.light /= density;
    choose(one, randomOf(seed, 2u * uint(n)), chosen, weights);
  }
  const Found f = found(all, chosen, weights, rounds);
  return Found(f.all / (float(places) * chance), f.kept / (float(places) * chance));
}

/// For each of a turn's rays one of the lights that the view passes beside, by about what it scatters, and its chance; -1
/// where there are none.
void chooseBeside(View v, uint seed, out int lights[kHazeRays], out float chances[kHazeRays]) {
  float all = 0.0;
  for (int ray = 0; ray < kHazeRays; ++ray) lights[ray] = -1;
  for (int i = 0; i < params.lights; ++i) {
    const HazeLight light = hazeLights[i];
    if (light.points == 0 || !isBeside(v, light)) continue;
    const float worth = light.power / light.sphere.w;
    all += worth;
    for (int ray = 0; ray < kHazeRays; ++ray) {
      if (randomOf(seed, 1u + 2u * uint((params.turn * kHazeRays + ray) * params.lights + i)) * all >= worth) continue;
      lights[ray] = i;
      chances[ray] = worth;
    }
  }
  for (int ray = 0; ray < kHazeRays; ++ray) chances[ray] /= max(all, 1e-30);
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
  chooseBeside(v, seed, beside, chances);
  vec4 sum = vec4(0.0);
  vec2 chance = vec2(0.0);
  int sent = 0, rounds = 0;
  for (; v.end > v.begin && sent < kHazeRays && rounds < kMostRayRounds; ++sent) {
    const int k = params.turn * kHazeRays + sent;
    Found f = rayAfar(v, shift, seed, k, rounds);
    if (beside[sent] >= 0) {
      const Found more = rayBeside(v, beside[sent], chances[sent], shift, seed, k, rounds);
      f = Found(f.all + more.all, f.kept + more.kept);
    }
    const vec3 arrives = f.all - f.kept;
    const float single = params.ofSurfaces == 1 ? largest(arrives) : largest(f.kept);
    sum += vec4(arrives, largest(arrives) * largest(arrives));
    chance += vec2(single, single * single);
  }
  const float share = float(kHazeRays) / float(max(sent, 1));
  const bool anew = params.firstTurn == 1;
  imageStore(hazeSum, pixel, share * sum + (anew ? vec4(0.0) : imageLoad(hazeSum, pixel)));
  imageStore(hazeChance, pixel, vec4(share * chance + (anew ? vec2(0.0) : imageLoad(hazeChance, pixel).xy), 0.0, 0.0));
}
