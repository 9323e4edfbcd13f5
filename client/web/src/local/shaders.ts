// GLSL of local shading. The lookup is the server's (shaders/transport/lookup.glsl; its formulas: server/lpv/MATHS.md 4):
// of each colour the amount of light at a point, its mean direction and its spread make a cap of uniform light.

export const MOST_LAYERS = 8;

export const vertex = `
precision highp float;
uniform mat4 modelMatrix, viewMatrix, projectionMatrix;
uniform mat3 worldNormal;
in vec3 position;
#ifdef NORMALS
in vec3 normal;
#endif
out vec3 world;
out vec3 eye;
out vec3 turned;

void main() {
  world = (modelMatrix * vec4(position, 1.0)).xyz;
  eye = (viewMatrix * vec4(world, 1.0)).xyz;
#ifdef NORMALS
  turned = worldNormal * normal;
#endif
  gl_Position = projectionMatrix * vec4(eye, 1.0);
}
`;

// Also of tests, which give the uniforms volumes of their own.
export const lookup = `
const float kPi = 3.14159265358979323846;
const float kY0 = 0.28209479177387814347;
const float kY1 = 0.48860251190291992159;

uniform highp sampler3D older[3];
uniform highp sampler3D newer[3];
uniform ivec3 dims;
uniform int layers;
uniform float olderScale[${MOST_LAYERS}], newerScale[${MOST_LAYERS}], weight[${MOST_LAYERS}];
uniform vec3 origin;
uniform float cellSize;
uniform float guard;  // cells of dims on each side that are beyond the grid
uniform float blend;  // 0: older, 1: newer

float atanDeficit(float u) {
  float p = ((-0.00386673891 * u + 0.0200267476) * u - 0.0489143215) * u + 0.0800968172;
  return (((p * u - 0.108657591) * u + 0.142570449) * u - 0.199986812) * u + 0.333333231;
}

float angleOf(float s, float c) {
  float t = min(s, c) / max(s, c);
  float angle = t - t * t * t * atanDeficit(t * t);
  return s <= c ? angle : 0.5 * kPi - angle;
}

float capSegment(float q, float sine, float cosine) {
  if (q * sine > cosine) return (angleOf(q * sine, cosine) - q * sine * cosine) / (sine * sine);
  float t = q * sine / cosine;
  float s = q / cosine;
  return t - t * s * s * atanDeficit(t * t);
}

float shareAcrossHorizon(float sine2, float cosine, float cosTilt) {
  if (sine2 < 1e-6 || cosTilt * cosTilt >= sine2) return 0.0;
  float sine = sqrt(sine2);
  float m = min(1.0, abs(cosTilt) / sine);
  float q = sqrt((1.0 - m) * (1.0 + m));
  if (q == 0.0) return 0.0;
  return max(0.0, capSegment(q, sine, cosine) - abs(cosTilt) * angleOf(q, m * cosine)) / kPi;
}

float irradianceOf(vec4 c, vec3 n) {
  float phi = c.x / kY0;
  if (!(phi > 0.0)) return 0.0;
  vec3 d = c.wyz / kY1;
  float size = length(d);
  if (size < 0.5 * phi) return max(0.0, 0.25 * phi + 0.5 * dot(d, n));
  float along = dot(d, n);
  float rest = (phi - size) / phi;
  return max(0.0, along) + size * shareAcrossHorizon(4.0 * (1.0 - rest) * rest, 1.0 - 2.0 * rest, along / size);
}

// Clamps to the layer's outermost cell centres.
vec4 incidentAt(highp sampler3D volume, int layer, vec3 at) {
#ifdef EXACT
  vec3 p = clamp(at, vec3(0.5), vec3(dims) - 0.5) - 0.5;
  ivec3 low = min(ivec3(p), max(dims - 2, ivec3(0)));
  ivec3 high = min(low + 1, dims - 1);
  vec3 w = p - vec3(low);
  low.z += layer * dims.z;
  high.z += layer * dims.z;
  vec4 a = mix(texelFetch(volume, low, 0), texelFetch(volume, ivec3(high.x, low.yz), 0), w.x);
  vec4 b = mix(texelFetch(volume, ivec3(low.x, high.y, low.z), 0), texelFetch(volume, ivec3(high.xy, low.z), 0), w.x);
  vec4 c = mix(texelFetch(volume, ivec3(low.xy, high.z), 0), texelFetch(volume, ivec3(high.x, low.y, high.z), 0), w.x);
  vec4 d = mix(texelFetch(volume, ivec3(low.x, high.yz), 0), texelFetch(volume, high, 0), w.x);
  return mix(mix(a, b, w.y), mix(c, d, w.y), w.z);
#else
  float z = clamp(at.z, 0.5, float(dims.z) - 0.5) + float(layer * dims.z);
  return textureLod(volume, vec3(at.xy, z) / vec3(dims.xy, layers * dims.z), 0.0);
#endif
}

// Light on its way from one volume to the next: the field is blended, then looked up once.
float received(highp sampler3D before, highp sampler3D after, int layer, vec3 at, vec3 n) {
  vec4 c = newerScale[layer] * incidentAt(after, layer, at);
  if (blend < 1.0) c = mix(olderScale[layer] * incidentAt(before, layer, at), c, blend);
  return irradianceOf(c, n);
}

// W/m^2; 0 further than half a cell outside the grid.
vec3 irradianceAt(vec3 world, vec3 n) {
  vec3 at = (world - origin) / cellSize;
  if (any(lessThan(at, vec3(guard - 0.5))) || any(greaterThan(at, vec3(dims) - guard + 0.5))) return vec3(0.0);
  vec3 sum = vec3(0.0);
  for (int layer = 0; layer < layers; ++layer) {
    sum += weight[layer] * vec3(received(older[0], newer[0], layer, at, n), received(older[1], newer[1], layer, at, n),
                                received(older[2], newer[2], layer, at, n));
  }
  return sum;
}
`;

// LINEAR: radiance and whether a surface is seen, for the exposure; MEASURED: irradiance, position and normal, for tests.
export const fragment = `
precision highp float;
precision highp int;
uniform vec3 albedo, front, back;
uniform float exposure;
in vec3 world;
in vec3 eye;
in vec3 turned;
#ifdef MEASURED
layout(location = 0) out vec4 colour;
layout(location = 1) out vec4 place;
layout(location = 2) out vec4 facing;
#else
out vec4 colour;
#endif
${lookup}
uniform mat3 worldFromEye;

vec3 surfaceNormal() {
#ifdef NORMALS
  return normalize(gl_FrontFacing ? turned : -turned);
#else
  vec3 n = cross(dFdx(eye), dFdy(eye));
  return worldFromEye * normalize(dot(n, eye) < 0.0 ? n : -n);
#endif
}

vec3 shown(vec3 radiance) {
  vec3 x = min(radiance * exposure, 1e4);
  vec3 y = clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
  return mix(1.055 * pow(y, vec3(1.0 / 2.4)) - 0.055, 12.92 * y, lessThanEqual(y, vec3(0.0031308)));
}

void main() {
#ifdef EMITS
  vec3 radiance = gl_FrontFacing ? front : back;
  float surface = 0.0;
#else
  vec3 n = surfaceNormal();
  vec3 incoming = irradianceAt(world, n);
  vec3 radiance = albedo * incoming / kPi;
  float surface = 1.0;
#endif
#if defined(MEASURED)
  colour = vec4(0.0);
#ifndef EMITS
  colour = vec4(incoming, surface);
  place = vec4(world, 1.0);
  facing = vec4(n, 0.0);
#endif
#elif defined(LINEAR)
  colour = vec4(radiance, surface);
#else
  colour = vec4(shown(radiance), 1.0);
#endif
}
`;
