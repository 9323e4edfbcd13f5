// The table's VPLs to where they belong; the table is left empty. A thread per VPL.
#include "voxelize/vpl_pass.glsl"
#include "voxelize/vpl_entries.glsl"

/// Differences of squares need the digits that the table has.
#if LPV_SQUARES
#define Sum double
#define Sum3 dvec3
#else
#define Sum float
#define Sum3 vec3
#endif

/// Fixed point of the table, as a share of the light's area; the table is left at zero.
Sum taken(int at) {
  uvec2 bits = uvec2(words[at], words[at + 1]);
  words[at] = words[at + 1] = 0u;
  const bool negative = bits.y >= 0x80000000u;
  if (negative) bits = uvec2(0u - bits.x, ~bits.y + (bits.x == 0u ? 1u : 0u));
  const Sum size = (Sum(bits.y) * Sum(4294967296.0) + Sum(bits.x)) * Sum(params.shareOfUnit);
  return negative ? -size : size;
}

Sum3 taken3(int at) { return Sum3(taken(at), taken(at + kWideWords), taken(at + 2 * kWideWords)); }

#if LPV_SQUARES
/// From squares about the cell's lower corner and their weight.
mat3 covarianceOf(dvec3 on, dvec3 off, double weight, dvec3 m) {
  if (!(weight > 0.0lf)) return mat3(0.0);
  const vec3 variance = max(vec3(on / weight - m * m), 0.0);
  // Rounding must not give two axes more in common than they have.
  const vec3 most = sqrt(vec3(variance.x * variance.y, variance.x * variance.z, variance.y * variance.z));
  const vec3 c = clamp(vec3(off / weight - dvec3(m.x * m.y, m.x * m.z, m.y * m.z)), -most, most);
  return mat3(variance.x, c.x, c.y, c.x, variance.y, c.z, c.y, c.z, variance.z);
}
#endif

void main() {
  if (thread() >= voxelHeader.count) return;
  const int base = int(voxels[thread()].x) * kVplWords;
  const uint key = words[base + kVplKey] - 1u;
  words[base + kVplKey] = 0u;
  Vpl v;
  const Sum area = taken(base + kVplArea);
  v.area = float(area);
  v.direction = vec3(taken3(base + kVplDirection));
  const Sum3 moment = taken3(base + kVplOffset);
#if LPV_TEXTURED
  const vec3 colour = vec3(taken3(base + kVplColour));
  const Sum weight = taken(base + kVplWeight);
  v.colour = v.area > 0.0 ? colour / v.area : vec3(0.0);
#else
  const Sum weight = area;
#endif
  const ivec3 cell = params.lower + cellInBox(int(key >> kBinBits), params.upper - params.lower);
  const Sum3 middle = weight > Sum(0.0) ? clamp(moment / weight, Sum(0.0), Sum(1.0)) : Sum3(0.5);
  v.position = params.origin + params.cell * (vec3(cell) + vec3(middle));
  v.area *= params.areaScale;
  v.direction *= params.areaScale;
  const float face = params.cell * params.cell;
#if LPV_SQUARES
  const dvec3 on = taken3(base + kVplSquares), off = taken3(base + kVplSquares + 3 * kWideWords);
  v.positionCovariance = face * covarianceOf(on, off, weight, middle);
#else
  v.positionCovariance = face * covarianceInCell(v.area, v.direction);
#endif
  v.area *= face;
  v.direction *= face;
  v.spread = spreadOf(v.area, v.direction);
  const Node node = nodeAt(nodeIndex(0, cell));
  storeVpl(node.first + 1u + placeOf(node.bins, key & ((1u << kBinBits) - 1u)), v);
}
