// What a triangle adds to a light's accumulators.
#include "voxelize/accumulators.glsl"

#ifndef LPV_RECORD_PAIRS

#if !LPV_VPLS
/// Adds to a cell's first word; the first VPL of a cell appends it to the list. Returns where the cell's sums begin.
int touchedCell(ivec3 position, uint lobes) {
  const int cell = (position.z * params.dims.y + position.y) * params.dims.x + position.x;
  if (atomicAdd(words[cell * kAccumulatorWords], lobes) == 0u) {
    voxels[nextInList()].x = uint(cell);
  }
  return cell * kAccumulatorWords + kFirstSum;
}
#endif

void addWord(int at, float value) { atomicAdd(words[at], uint(int(roundEven(value)))); }

/// 64 bits in two words. 1.5 x 2^52 + v has v rounded to an integer in its low mantissa bits (|v| < 2^51).
void addWide(int at, double value) {
  const uvec2 bits = unpackDouble2x32(value + 6755399441055744.0lf);
  const uint high = bits.y - 0x43380000u;
  const uint before = atomicAdd(words[at], bits.x);
  const uint carried = high + (before + bits.x < before ? 1u : 0u);
  if (carried != 0u) atomicAdd(words[at + 1], carried);
}

void addWide3(int at, dvec3 value) {
  for (int i = 0; i < 3; ++i) addWide(at + kWideWords * i, value[i]);
}

#if LPV_VPLS

/// `area` of emitter, as a share of what the light's scale was made for, that emits from about `offset` from the cell's
/// lower corner, with `covariance` about that.
void addVpl(ivec3 cell, double area, dvec3 offset, dmat3 covariance, dvec3 direction, dvec3 colour) {
  const double zeroth = params.momentUnits * area;
  if (zeroth < 0.5lf) return;  // a corner cut so small has no area in fixed point: a VPL without one is no light
  const int at = vplPlace(cell, normalBin(vec3(direction)));
  if (at < 0) return;
  addWide(at + kVplArea, zeroth);
  addWide3(at + kVplDirection, zeroth * direction);
#if LPV_TEXTURED
  const double weight = zeroth * max(colour.r, max(colour.g, colour.b));
  addWide3(at + kVplColour, zeroth * colour);
  addWide(at + kVplWeight, weight);
#else
  const double weight = zeroth;
#endif
  addWide3(at + kVplOffset, weight * offset);
#if LPV_SQUARES
  const dmat3 square = covariance + outerProduct(offset, offset);
  addWide3(at + kVplSquares, weight * dvec3(square[0][0], square[1][1], square[2][2]));
  addWide3(at + kVplSquares + 3 * kWideWords, weight * dvec3(square[0][1], square[0][2], square[1][2]));
#endif
}

#elif LPV_FLUX
/// `area` x (colour, colour x direction), a direction for each colour, area as a share of what the light's scale was made for.
void addMoments(ivec3 cell, double area, dmat3 direction, dvec3 colour) {
  const int base = touchedCell(cell, 1u);
  for (int k = 0; k < kMomentsPerCell; ++k) {
    const double zeroth = params.momentUnits * area * colour[k];
    const int at = base + kWideWords * kMomentParts * k;
    addWide(at, zeroth);
    addWide3(at + kWideWords, zeroth * direction[k]);
  }
}
#elif LPV_SETS
/// Triangle number `index`, which comes once to a cell.
void addToSet(ivec3 cell, uint index) { touchedCell(cell, 1u << index); }
#else
/// `lobes` of one colour, the sum of their directions given.
void addLobes(ivec3 cell, uint lobes, vec3 directions, vec3 colour) {
  const int base = touchedCell(cell, lobes);
  const float scale = float(params.momentUnits);
#if LPV_TEXTURED
  for (int k = 0; k < kColours; ++k) {
    const int at = base + kMomentParts * k;
    addWord(at, scale * colour[k] * float(lobes));
    for (int i = 0; i < 3; ++i) addWord(at + 1 + i, scale * colour[k] * directions[i]);
  }
#else
  for (int i = 0; i < 3; ++i) addWord(base + i, scale * directions[i]);
#endif
}
#endif

#endif
