// Where a light's voxels are summed: integers only, so that the sums do not depend on the order of the additions and are
// the same bits on every run and from every injector.
//
// Words of a cell: shaders/layout.h. LPV_TEXTURED: moments of each colour. LPV_SETS: COUNT of a light with at most
// kSetTriangles triangles keeps which of them came, and no sums.
// LPV_VPLS: FLUX for GATHER has a table of VPLs instead, shaders/voxelize/vpl_table.glsl.
#ifndef LPV_FLUX
#error "LPV_FLUX: 0 (COUNT) or 1"
#endif
#ifndef LPV_TEXTURED
#error "LPV_TEXTURED: 0 or 1"
#endif

#ifndef LPV_VPLS
#define LPV_VPLS 0
#endif

#ifndef LPV_SETS
#define LPV_SETS 0
#endif

#if LPV_TEXTURED
const int kMomentsPerCell = kColours;
#else
const int kMomentsPerCell = 1;
#endif
#if LPV_FLUX && LPV_TEXTURED
const int kAccumulatorWords = kTexturedFluxWords;
#elif LPV_FLUX
const int kAccumulatorWords = kFluxWords;
#elif LPV_SETS
const int kAccumulatorWords = kSetWords;
#elif LPV_TEXTURED
const int kAccumulatorWords = kTexturedCountWords;
#else
const int kAccumulatorWords = kCountWords;
#endif

#if LPV_VPLS
#include "voxelize/vpl_table.glsl"
#else
#ifdef LPV_RECORD_PAIRS
layout(std430, binding = kRecordedPairs) buffer Recorded { uint recordedCount; uint recordedPad; uvec2 recorded[]; };
#else
layout(std430, binding = kAccumulators) buffer Accumulators { uint words[]; };
#endif
layout(std430, binding = kVoxelCells) buffer Voxels { VoxelHeader voxelHeader; uvec2 voxels[]; };
#endif

#ifndef LPV_RECORD_PAIRS

/// `count` more in a list of which every kCellGroup-th adds a group to later dispatches; the first group is always there,
/// since it also counts triangles without area. The number of the first.
uint appendToList(uint count) {
  const uint slot = atomicAdd(voxelHeader.count, count);
  const uint groups = (slot + count - 1u) / uint(kCellGroup) - (max(slot, 1u) - 1u) / uint(kCellGroup);
  if (groups > 0u) atomicAdd(voxelHeader.groupsX, groups);
  return slot;
}

/// A place in the list. All threads come here at once and wait for one number: those that run in step ask together.
uint nextInList() {
#ifdef LPV_BALLOT
  const uint64_t together = ballotARB(true);
  const uvec2 askers = unpackUint2x32(together), before = unpackUint2x32(together & gl_SubGroupLtMaskARB);
  const uint rank = uint(bitCount(before.x) + bitCount(before.y));
  uint slot = 0u;
  if (rank == 0u) slot = appendToList(uint(bitCount(askers.x) + bitCount(askers.y)));
  return readFirstInvocationARB(slot) + rank;
#else
  return appendToList(1u);
#endif
}

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

/// `area` of emitter, as a share of what the light's scale was made for, about `offset` from the cell's lower corner.
void addVpl(ivec3 cell, double area, vec3 offset, dvec3 direction, dvec3 colour) {
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
  addWide3(at + kVplOffset, weight * dvec3(offset));
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
