// Bindings, work-group sizes and buffer layouts, read by C++ and by GLSL. A change here changes both sides; the C++
// side asserts sizes and offsets (std140 for parameter blocks, std430 for storage).

#ifdef __cplusplus
#pragma once
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#define LPV_CONST inline constexpr
namespace lpv::layout {
using uint = std::uint32_t;
using glm::dmat4;
using glm::dvec4;
using glm::ivec4;
using glm::mat4;
using glm::uvec4;
using glm::vec4;
#else
#define LPV_CONST const
#endif

// --- storage buffers
LPV_CONST int kAccumulators = 2;   // uint, words per cell as shaders/voxelize/deposit.glsl has them
LPV_CONST int kVoxelCells = 3;     // one light's cells: kVoxelHeaderWords, then uvec2 (cell, lobes or pairs) each
LPV_CONST int kLargeTriangles = 4; // kListHeaderWords, then work items
LPV_CONST int kCounters = 5;       // Counters
LPV_CONST int kFieldOut = 6;       // vec4 per halo cell and channel
LPV_CONST int kFieldSum = 7;       // vec4 per halo cell and channel (clamped form only)
LPV_CONST int kProduct = 8;        // float, 12 per cell: 3 colours x 4 coefficients
LPV_CONST int kExposure = 9;       // vec4: the exposure; then one per group of its reduction
LPV_CONST int kRecordedPairs = 10; // tests only: uvec2 (triangle, cell)
LPV_CONST int kTestIn = 11;        // tests only
LPV_CONST int kTestOut = 12;       // tests only
LPV_CONST int kVoxelMoments = 13;  // vec4, one per set of the light's cells (shaders/voxelize/deposit.glsl)
LPV_CONST int kLobeCounts = 14;    // float per cell: N of eq. 1, all lights together; negative once divided by
LPV_CONST int kUvs = 15;           // float, 2 per vertex
LPV_CONST int kDirections = 16;    // float, 3 per vertex, object space
LPV_CONST int kRowIntegrals =
    17;  // double, 3 per texel and one more texel per row (shaders/voxelize/texture_integral.glsl)
LPV_CONST int kTreeNodes = 18;  // uvec4 per node of every level of a light's tree (shaders/voxelize/vpl_tree.glsl)
LPV_CONST int kTreeRecords = 19;  // vec4, LPV_RECORD per record of a light's tree (shaders/transport/vpls.glsl)
LPV_CONST int kReceiverBlocks = 20;  // uint per block of cells: x | y << 8 | z << 16, in blocks
LPV_CONST int kCursors = 21;  // uvec2 per block: where its walk through the tree stands before its even, odd turns
LPV_CONST int kEmitterDistanceBuffer = 22;  // float per cell: cells to the nearest VPL that was taken by itself

// --- uniform blocks
LPV_CONST int kParams = 0;  // one struct below per stage
LPV_CONST int kDrawParams = 1;  // DrawParams of one object

// --- texture units
LPV_CONST int kFieldIn = 0;  // samplerBuffer over a field
LPV_CONST int kFieldSource = 1;  // samplerBuffer over the injected field
LPV_CONST int kIncident = 2;  // 2, 3, 4: sampler3D of incident radiance, one per colour (or per channel)
LPV_CONST int kAlbedo = 5;
LPV_CONST int kNormal = 6;
LPV_CONST int kSurfaceDepth = 7;
LPV_CONST int kEmission = 8;
LPV_CONST int kEmitterDepth = 9;
LPV_CONST int kRadiance = 10;
LPV_CONST int kLightTexture = 11;  // radiance factor of the light that is voxelized
LPV_CONST int kPositions = 12;  // samplerBuffer: vec3 per vertex, object space
LPV_CONST int kTriangles = 13;  // usamplerBuffer: uvec3 per triangle
LPV_CONST int kTree = 14;  // samplerBuffer over the records of a light's tree
LPV_CONST int kDirect =
    15;  // samplerBuffer: the lights as receivers look at them (shaders/transport/emitter_list.glsl)
LPV_CONST int kEmitterDistance = 16;  // sampler3D: cells to the nearest VPL
// --- image units
LPV_CONST int kIncidentOut = 0;  // 0, 1, 2
LPV_CONST int kEmitterDistanceOut = 3;

// --- work-groups
LPV_CONST int kVoxelizeGroup = 64;  // small triangles: a thread each
LPV_CONST int kColumnGroup = 16;  // large triangles: threads of one work item
LPV_CONST int kCellGroup = 64;  // touched cells: a thread each
LPV_CONST int kFieldGroupX = 8;  // cells along x, y of a group that walks the field: as fast on llvmpipe as
LPV_CONST int kFieldGroupY = 4;  // 32 x 1, with fewer idle threads in narrow boxes
LPV_CONST int kFieldMarch = 4;  // cells along z per thread, so that the slab behind is still in registers
LPV_CONST int kNodeGroup = 64;  // nodes of a tree: a thread each
LPV_CONST int kBlockX = 8;  // a block of receivers: cells along x, y and z; a work-group each
LPV_CONST int kBlockY = 4;
LPV_CONST int kBlockZ = 4;  // all of a column by one thread: what it reads of the tree serves them all
LPV_CONST int kExposureGroup = 64;  // threads of the exposure reduction
LPV_CONST int kExposurePixels = 1024;  // pixels per group of its first pass

// --- vertex attributes of drawn meshes, also their buffer bindings
LPV_CONST int kPositionAttribute = 0;  // vec3, object space
LPV_CONST int kNormalAttribute = 1;  // vec3, object space
LPV_CONST int kUvAttribute = 2;  // vec2

// --- voxelization
LPV_CONST int kLatticeUnits = 256;  // lattice units per cell edge (MATHS.md 2, snapping)
LPV_CONST int kSmallColumns = 48;  // triangles with more columns are split,
LPV_CONST int kManyTriangles = 512;  // or, where there are so many that all threads have one,
LPV_CONST int kManyColumns = 160;  // with more than this
LPV_CONST int kSmallVaryingColumns = 32;  // the same with texture or directions
LPV_CONST int kColumnsPerThread = 16;  // of a split one without, about
LPV_CONST int kMaxSlices = 8;  // work items of one split triangle
LPV_CONST int kMaxVaryingSlices = 128;  // of one with texture or directions: llvmpipe ends a thread's loops after 2^16
                                        // rounds in all, without a word
LPV_CONST int kMaxPieceTriangles = 8191;  // per dispatch: kMaxSlices items of each stay below 65535 groups
LPV_CONST int kFluxBits = 50;  // FLUX: the light's whole area is 2^50 in fixed point, its sums 64 bits wide
LPV_CONST int kSetTriangles = 32;  // COUNT of a light with so few: a cell keeps which of them came to it
LPV_CONST int kSamplesPerThread = 32;  // dense sampling

// A list whose length also is an indirect dispatch: one group per work item.
LPV_CONST int kListHeaderWords = 4;  // groups x, y, z, count; the entries follow
// The same for one light's cells (or VPLs), kCellGroup of them a group.
LPV_CONST int kVoxelHeaderWords = 8;  // groups x, y, z, count, triangles of zero area; VPLs that found no room, records
                                      // of the tree, cells that hold VPLs; the entries follow

// --- VPLs and their tree (MATHS.md 3b)
LPV_CONST int kNormalBins = 54;  // per cell: 3 x 3 on each face of a cube
LPV_CONST int kMaxLevels = 9;  // of a tree: blocks of 1, 2, 4 .. 256 cells
LPV_CONST int kPlainRecordTexels = 4;  // vec4 of a record (shaders/transport/vpls.glsl) ...
LPV_CONST int kTexturedRecordTexels = 5;  // ... and of one with a colour
LPV_CONST float kSteadiness = 2.5;  // second order counts 1 / (1 + (2.5 x)^4), x: extent over squared distance
LPV_CONST int kMostProbes = 64;  // places of the table that a VPL is looked for in
LPV_CONST float kFarFromVpls = 1e4;  // cells: nothing near
LPV_CONST float kNearFieldBegin = 2.0;  // cells from an emitter: up to here receivers look at the lights themselves,
LPV_CONST float kNearFieldEnd = 3.0;  // from here on at the volume (MATHS.md 3c)
LPV_CONST int kMaxRounds = 32768;  // of one dispatch's walk through a tree: llvmpipe ends a thread's loops after
                                   // 2^16 rounds in all, without a word

struct Counters {
  uint degenerate;  // light triangles of zero area
  uint clamped;  // output cells cut back to phi >= 0, |D| <= phi
  uint touched;  // cells that hold light
  uint pad0;
};

struct VoxelizeParams {
  dmat4 gridFromObject;  // grid space: cell units from the grid's minimum corner
  dmat4 areaFromObject;  // times the object-space cross product of two edges: area x outward normal, cell^2
  dvec4 scale;  // x: fixed-point units of a moment of 1; y: 1 / the brightest texel
  ivec4 dims;  // cells x, y, z
  uvec4 triangles;  // x first, y how many; z: samples of each, w: threads of each (dense sampling)
  ivec4 texture;  // width, height, mip levels
  vec4 textureMean;  // rgb mean of all texels
  ivec4 boxLower;  // VPLs: first cell of the light's box
  ivec4 boxSize;  // VPLs: its cells along x, y, z; w: entries of the table, a power of two
  vec4 normals[kSetTriangles];  // sets of triangles: unit, outward, grid space
};

struct TreeParams {
  ivec4 lower;  // first cell of the light's box; w: levels
  ivec4 upper;  // one past its last cell; w: the level of this pass
  uvec4 offsets[3];  // nodes before each level
  vec4 scale;  // x: area that a moment of 1 stands for, cell^2; y: threads before this dispatch's first
  dvec4 unit;  // x: what one fixed-point unit stands for, as a share of it
};

struct GatherParams {
  ivec4 dims;  // cells; w: blocks before this piece's first
  vec4 weight;  // per channel: radiance of a colour of 1, in units of the channel's palette radiance
  vec4 rule;  // x: k of the distance rule
  ivec4 tree;  // x: records; z: first channel of the light's group; w: which turn of a walk through a
               // large tree this is, from 0
};

struct InjectParams {
  ivec4 dims;  // cells; w: the light's group
  vec4 weight;  // per channel: intensity of a moment of 1, W/sr per unit of the channel's palette radiance
  vec4 lobe;  // x: sides that emit (band 0), y: 1 for one side, 0 for two (band 1 cancels)
  ivec4 boxLower;  // VPLs: first cell of the light's box
  ivec4 boxSize;  // VPLs: its cells along x, y, z
};

struct PropagateParams {
  ivec4 dims;
  ivec4 lower;  // first cell of the box to compute
  ivec4 upper;  // one past the last cell; w: groups along y of one channel
};

struct VolumeParams {
  ivec4 dims;  // w: first z of this piece
  vec4 palette[3];  // rgb radiance of each channel
  vec4 factors;  // x: factor of band 0, y: factor of band 1
  ivec4 group;  // x: which group of lights, y: its first channel
};

struct FrameParams {
  mat4 clipFromEye;  // reversed depth: near 1, far 0; eye space is world space moved to the eye
  vec4 rayOrigin;  // grid space: from the eye to the top left corner of the picture plane at view depth 1
  vec4 rayRight;  // grid space: across the whole picture
  vec4 rayDown;  // grid space: down the whole picture
  vec4 eye;  // grid space
  vec4 depth;  // view depth = x / (stored depth + y), metres; z, w: 1 / size of the picture in pixels
  vec4 palette;  // rgb radiance of the one channel of a monochrome volume
  vec4 exposure;  // x: 2^ev, applied to what automatic exposure finds too; y: key of automatic exposure;
                  // z: groups of pixels before this dispatch's first
  ivec4 dims;  // cells; w: pixels of the picture
};

struct DrawParams {
  mat4 eyeFromObject;
  mat4 normalFromObject;  // inverse transpose of the linear part
  vec4 colour;  // albedo, or radiance of the front
  vec4 backColour;  // radiance of the back
};

#ifdef __cplusplus
static_assert(sizeof(Counters) == 16);
static_assert(sizeof(VoxelizeParams) == 896 && offsetof(VoxelizeParams, dims) == 288);
static_assert(sizeof(TreeParams) == 128 && offsetof(TreeParams, unit) == 96);
static_assert(sizeof(GatherParams) == 64);
static_assert(kBlockZ == 4);  // gather.comp: a column is a vec4
static_assert(sizeof(InjectParams) == 80);
static_assert(sizeof(PropagateParams) == 48);
static_assert(sizeof(VolumeParams) == 96 && offsetof(VolumeParams, factors) == 64);
static_assert(sizeof(FrameParams) == 192 && offsetof(FrameParams, dims) == 176);
static_assert(sizeof(DrawParams) == 160 && offsetof(DrawParams, colour) == 128);
}  // namespace lpv::layout
#undef LPV_CONST
#endif
