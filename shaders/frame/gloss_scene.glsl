// What reflections show (server/lpv/resources/gloss_scene.h). Texels:
//   0: (texel of the first light, lights, -, -)
//   surface  (albedo, flags) (texel of its picture or 0, boxes across and down, -)
//   light    (radiance of the front, flags) (as above, lights so far as a share of all power) (first point, points,
//            area of one side, its own share of all power)
//   picture  means of boxes with shared exponents, four to a texel
// Shapes are those of visibility/first_hit.glsl, which the caller has included.

layout(binding = kGlossScene) uniform usamplerBuffer glossScene;

struct ShownLight {
  vec3 radiance;
  uint flags;
  int firstPoint, points;
  float area;
  float share;  // of all power
};

int lightsShown() { return int(texelFetch(glossScene, 0).y); }
int lightTexel(int light) { return int(texelFetch(glossScene, 0).x) + kGlossLightTexels * light; }

ShownLight shownLight(int light) {
  const uvec4 first = texelFetch(glossScene, lightTexel(light)), third = texelFetch(glossScene, lightTexel(light) + 2);
  return ShownLight(uintBitsToFloat(first.xyz), first.w, int(third.x), int(third.y), uintBitsToFloat(third.z),
                    uintBitsToFloat(third.w));
}

/// One of the lights, which there are, in proportion to their power, and where within its share `at` is; `at` in [0, 1).
int lightAt(inout float at) {
  const int count = lightsShown();
  int light = 0;
  float before = 0.0, end = uintBitsToFloat(texelFetch(glossScene, lightTexel(0) + 1).w);
  while (light + 1 < count && end <= at) {
    before = end;
    ++light;
    end = uintBitsToFloat(texelFetch(glossScene, lightTexel(light) + 1).w);
  }
  at = clamp((at - before) / max(end - before, 1e-30), 0.0, 0.999999);
  return light;
}

/// Per unit of area, how often points of it are chosen so.
float chanceOf(ShownLight light) { return light.share / max(light.area, 1e-30); }

vec3 boxOf(uvec4 picture, ivec2 box) {
  const ivec2 size = ivec2(picture.yz), at = ivec2(mod(vec2(box), vec2(size)));
  const int i = at.y * size.x + at.x;
  const uint packed_ = texelFetch(glossScene, int(picture.x) + i / 4)[i % 4];
  return vec3(packed_ & 511u, packed_ >> 9 & 511u, packed_ >> 18 & 511u) * exp2(float(packed_ >> 27) - 24.0);
}

/// Linear between the middles of boxes; 1 without a picture.
vec3 pictureAt(uvec4 picture, vec2 uv) {
  if (picture.x == 0u) return vec3(1.0);
  const vec2 at = fract(uv) * vec2(picture.yz) - 0.5, share = fract(at);
  const ivec2 box = ivec2(floor(at));
  return mix(mix(boxOf(picture, box), boxOf(picture, box + ivec2(1, 0)), share.x),
             mix(boxOf(picture, box + ivec2(0, 1)), boxOf(picture, box + ivec2(1, 1)), share.x), share.y);
}

/// The place that a ray has met.
struct Met {
  int surface, light;  // -1: it is no such
  vec3 normal;         // grid space, unit, towards where the ray came from
  vec2 uv;
};

Met metAt(Sight sight, vec3 place) {
  const uvec4 mesh = texelFetch(occluders, sight.instance + 3), what = texelFetch(occluders, sight.instance + 6);
  const int texel = int(mesh.y) + kTriangleTexels * sight.triangle;
  const uvec4 first = texelFetch(occluders, texel), second = texelFetch(occluders, texel + 1);
  const uvec4 third = texelFetch(occluders, texel + 2);
  const vec3 a = uintBitsToFloat(first.xyz), b = uintBitsToFloat(second.xyz), c = uintBitsToFloat(third.xyz);
  const vec3 normal = uintBitsToFloat(uvec3(first.w, second.w, third.w));
  const mat4x3 object = objectFromGrid(sight.instance);
  Met met = Met(int(what.x) - 1, int(what.y) - 1, normalize(transpose(mat3(object)) * normal), vec2(0.0));
  if (!sight.front) met.normal = -met.normal;
  const uint uvs = texelFetch(occluders, sight.instance + 5).w;
  if (uvs == 0u) return met;
  const vec3 p = object * vec4(place, 1.0), across = cross(b - a, c - a);
  const float size = max(dot(across, across), 1e-37);
  const float toC = dot(cross(b - a, p - a), across) / size, toB = dot(cross(p - a, c - a), across) / size;
  const vec4 corners = uintBitsToFloat(texelFetch(occluders, int(uvs) + kUvTexels * sight.triangle));
  const vec2 last = uintBitsToFloat(texelFetch(occluders, int(uvs) + kUvTexels * sight.triangle + 1).xy);
  met.uv = corners.xy + toB * (corners.zw - corners.xy) + toC * (last - corners.xy);
  return met;
}

/// What a surface reflects of E = pi there.
vec3 albedoAt(Met met, bool front) {
  const uvec4 surface = texelFetch(glossScene, 1 + kGlossSurfaceTexels * met.surface);
  if (!front && (surface.w & kGlossBothSides) == 0u) return vec3(0.0);
  return uintBitsToFloat(surface.xyz) * pictureAt(texelFetch(glossScene, 2 + kGlossSurfaceTexels * met.surface), met.uv);
}

/// What a light sends from there.
vec3 radianceAt(Met met, ShownLight light, bool front) {
  if (!front && (light.flags & kGlossBothSides) == 0u) return vec3(0.0);
  uvec4 picture = texelFetch(glossScene, lightTexel(met.light) + 1);
  return light.radiance * pictureAt(picture, met.uv);
}
