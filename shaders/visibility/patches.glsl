// Patches of the surfaces that reflect light (server/scene/patches.h), grid space.
#include "common/random.glsl"
#include "visibility/patch_weight.glsl"

struct Patch {
  vec4 place;   // position, area of what is its own
  vec4 normal;  // of the side that it is on; w: of a patch with pieces the first of these; of a triangle a bit for each of
                // its kPatchPlaces places that are its own (scene/parted_patches.h)
  vec4 albedo;  // w: how many
  vec4 direct;  // E in W/m^2 from the lights
  vec4 arriving[2];  // the same with what patches reflect, by the parity of bounces; of a piece: what others
                     // reflect to it; the second: what of that pieces do, where they are asked again
  vec4 corners[3];  // counter-clockwise seen from the side that it is on; w: 1 where it is a triangle, 0 where it stands
                    // for several; of the second -1 where these have pieces of their own (Folds), of the third then the
                    // square of how far it is from where they are looked for
  float wanted;     // of what patches exchange (transport/patch_balance.comp): what this one gets from all; of a piece: what those
                    // of its patch up to it send together
  float scale[2];   // of its row and column, by the parity of turns
  float of;  // of a piece, which follow the patches: the patch that stands for it; of a patch: what it would get from
             // all if each sent 1, by rays, then by how much more of the others' light comes to it than they account for
  vec4 slope;  // of one that is a triangle: how what it sends changes per cell across it, over what it sends; w: by how
               // much more the lights' light counts, since what others see of it is its open part (transport/patch_crevices.comp)
};

layout(std430, binding = kPatches) buffer Patches { Patch patches[]; };

/// A place on one that is a triangle; u in [0, 1)^2.
vec3 placeOn(Patch p, vec2 u) {
  if (u.x + u.y > 1.0) u = 1.0 - u;
  return p.corners[0].xyz + u.x * (p.corners[1].xyz - p.corners[0].xyz) + u.y * (p.corners[2].xyz - p.corners[0].xyz);
}

/// The k-th of places that are spread evenly over a triangle (Roberts 2018). The one before the first is the middle of an
/// edge, where a pane may stand.
vec3 placeAt(Patch p, int k) { return placeOn(p, fract(0.5 + float(k + 1) * vec2(0.7548776662, 0.5698402910))); }

const uint kAllPlaces = (1u << kPatchPlaces) - 1u;

bool isParted(Patch p) { return p.corners[0].w != 0.0 && uint(p.normal.w) != kAllPlaces; }

const float kLeastNearness = 0.01;  // the least square of a distance, of the patch's area

/// What a place d away on a patch sends beside others.
float sentFrom(vec3 d, Patch p, vec3 n) {
  const float r2 = dot(d, d) + kLeastNearness * p.place.w;
  return max(dot(d, n), 0.0) * max(-dot(d, p.normal.xyz), 0.0) / (r2 * r2);
}

/// How much of what the whole triangle would send to x comes from its own places.
float ownShare(Patch p, vec3 x, vec3 n) {
  if (!isParted(p)) return 1.0;
  float own = 0.0, all = 0.0;
  for (int k = 0; k < kPatchPlaces; ++k) {
    const float sent = sentFrom(placeAt(p, k) - x, p, n);
    own += (uint(p.normal.w) >> k & 1u) == 1u ? sent : 0.0;
    all += sent;
  }
  return all > 0.0 ? own / all : 0.0;
}

/// One of its own places, u in [0, 1)^2.
vec3 ownPlace(Patch p, vec2 u) {
  if (!isParted(p)) return placeOn(p, u);
  const uint own = uint(p.normal.w);
  int left = int(u.x * float(bitCount(own))), place = 0;
  for (int k = 0; k < kPatchPlaces; ++k) {
    const bool isOwn = (own >> k & 1u) == 1u;
    if (isOwn && left == 0) place = k;
    left -= int(isOwn);
  }
  return placeAt(p, place);
}

const float kUneven = 1.5;     // Patch::slope.w of one of which a third is behind others; the middle stands for the rest
const int kRaysOfUneven = 8;

/// Whether much of a patch is behind others.
bool isUneven(Patch p) { return p.corners[0].w != 0.0 && (p.slope.w >= kUneven || isParted(p)); }

/// Where the k-th ray to patch `to` begins, the same whoever asks: the middle; of an uneven one another place for another
/// ray, so that all rays together know how much of it is behind others.
vec3 placeTowards(int from, int to, int ray) {
  const Patch p = patches[from];
  const uint k = 2u * uint(to * kRaysOfUneven + ray);
  const vec3 place = isUneven(p) ? ownPlace(p, vec2(randomOf(uint(from), k), randomOf(uint(from), k + 1u))) : p.place.xyz;
  return place + kShadowOffset * p.normal.xyz;
}

const float kLeastSent = 0.25;

/// What is sent at a place of a patch, over its mean.
float sentAt(Patch p, vec3 place) { return clamp(1.0 + dot(p.slope.xyz, place - p.place.xyz), kLeastSent, 2.0 - kLeastSent); }

/// A share per colour in ten bits each.
uint packedShare(vec3 share) {
  const uvec3 s = uvec3(share * 1023.0 + 0.5);
  return s.r | s.g << 10 | s.b << 20;
}
vec3 unpackedShare(uint share) { return vec3(share & 1023u, (share >> 10) & 1023u, share >> 20) / 1023.0; }
