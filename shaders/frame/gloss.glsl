// The lobe of a pixel's surface (MATHS.md 3e; server/scene/gloss.h).

layout(binding = kAlbedo) uniform sampler2D albedo;
layout(binding = kNormal) uniform sampler2D normal;
layout(binding = kSurfaceDepth) uniform sampler2D surfaceDepth;
layout(binding = kGlossMaterial) uniform sampler2D material;  // roughness, metalness
layout(binding = kGlossShares) uniform sampler2D lobeShares;  // scene/gloss.h: GlossShare

const float kDielectricReflectance = 0.04;
const float kLeastAlpha = 1e-4;
const float kMirrorAlpha = 3e-3;  // below, no point of a light is in the lobe but by chance: rays look for lights
const float kLeastCosine = 1e-3;  // of a view along the surface, as bent normals have it

struct Lobe {
  vec3 straight;  // reflectance straight on
  float alpha;    // of GGX
  float mu;       // cosine of the view
  vec3 gain;      // by what bounces between facets
  vec3 all;       // what is reflected of even light
  float diffuse;  // of light that is reflected in all directions alike, what remains
};

vec3 surfacePosition(FrameParams frame, ivec2 pixel) {
  return gridPosition(frame, vec2(pixel) + 0.5, texelFetch(surfaceDepth, pixel, 0).x);
}
vec3 surfaceNormal(ivec2 pixel) { return unitFromOctahedral(texelFetch(normal, pixel, 0).xy); }

/// Of a pixel's surface, as it is seen.
Lobe lobeAt(FrameParams frame, ivec2 pixel) {
  const vec2 m = texelFetch(material, pixel, 0).xy;
  const vec3 v = normalize(frame.eye - surfacePosition(frame, pixel));
  Lobe lobe;
  lobe.straight = mix(vec3(kDielectricReflectance), texelFetch(albedo, pixel, 0).rgb, m.y);
  lobe.alpha = max(m.x * m.x, kLeastAlpha);
  lobe.mu = max(dot(surfaceNormal(pixel), v), kLeastCosine);
  const vec2 share = textureLod(lobeShares, vec2(lobe.mu, m.x), 0.0).xy;
  const float whole = max(share.x + share.y, 1e-6), lost = (1.0 - whole) / whole;
  lobe.gain = 1.0 + lobe.straight * lost;
  lobe.all = min((lobe.straight * share.x + share.y) * lobe.gain, vec3(1.0));
  const float dielectric = (kDielectricReflectance * share.x + share.y) * (1.0 + kDielectricReflectance * lost);
  lobe.diffuse = (1.0 - m.y) * (1.0 - min(dielectric, 1.0));
  return lobe;
}

float smithLambda(float cosine, float alpha) {
  const float c2 = cosine * cosine;
  return 0.5 * (sqrt(1.0 + alpha * alpha * max(1.0 - c2, 0.0) / c2) - 1.0);
}

vec3 schlick(Lobe lobe, float cosine) {
  const float c = 1.0 - clamp(cosine, 0.0, 1.0), c2 = c * c;
  return lobe.straight + (1.0 - lobe.straight) * (c2 * c2 * c);
}

/// What the lobe makes of light from l, per solid angle: BRDF times cosine; and how often rays go there.
vec3 reflectedFrom(Lobe lobe, vec3 n, vec3 v, vec3 l, out float density) {
  const float nl = dot(n, l);
  density = 0.0;
  if (nl <= 0.0) return vec3(0.0);
  const vec3 h = normalize(v + l), across = cross(n, h);
  const float nh = dot(n, h), a2 = lobe.alpha * lobe.alpha, below = a2 * nh * nh + dot(across, across);
  const float facets = a2 / (kPi * below * below), of = smithLambda(lobe.mu, lobe.alpha);
  density = facets / ((1.0 + of) * 4.0 * lobe.mu);
  return schlick(lobe, dot(v, h)) * lobe.gain * (facets / ((1.0 + of + smithLambda(nl, lobe.alpha)) * 4.0 * lobe.mu));
}

/// A direction of the lobe, by facets that are seen from v (Dupuy and Benyoub 2023), and what a ray there is worth; u in
/// [0, 1)^2. 0 where it goes below the surface.
vec3 reflectedTo(Lobe lobe, vec3 n, vec3 v, vec2 u, out vec3 direction) {
  const vec3 right = normalize(cross(n, abs(n.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
  const mat3 frame3 = mat3(right, cross(n, right), n);
  const vec3 from = vec3(dot(v, right), dot(v, frame3[1]), lobe.mu);
  const vec3 stretched = normalize(vec3(lobe.alpha * from.xy, from.z));
  const float turn = 2.0 * kPi * u.x, z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
  const float across = sqrt(clamp(1.0 - z * z, 0.0, 1.0));
  const vec3 cap = vec3(across * cos(turn), across * sin(turn), z) + stretched;
  const vec3 h = frame3 * normalize(vec3(lobe.alpha * cap.xy, max(cap.z, 0.0)));
  direction = reflect(-v, h);
  const float nl = dot(n, direction);
  if (nl <= 0.0) return vec3(0.0);
  const float of = smithLambda(lobe.mu, lobe.alpha);
  return schlick(lobe, dot(v, h)) * lobe.gain * ((1.0 + of) / (1.0 + of + smithLambda(nl, lobe.alpha)));
}
