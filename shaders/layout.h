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
using glm::ivec2;
using glm::ivec3;
using glm::ivec4;
using glm::mat4;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;
#define LPV_FUNCTION inline constexpr
#define LPV_VEC3 \
  alignas(16)  // std140: a vector of three begins at a multiple of 16 bytes; a scalar may follow in its last 4
#else
#define LPV_CONST const
#define LPV_FUNCTION
#define LPV_VEC3
#endif

// --- storage buffers
LPV_CONST int kAccumulators = 2;   // uint: the accumulators of every cell, or the entries of a table of VPLs
LPV_CONST int kVoxelCells = 3;  // one light's cells: VoxelHeader, then uvec2 (cell, lobes or pairs) each; with a table
                                // its used entries, uvec2 (entry, unused)
LPV_CONST int kLargeTriangles = 4;  // ListHeader, then uint per work item
LPV_CONST int kCounters = 5;  // Counters
LPV_CONST int kFieldOut = 6;  // vec4 per halo cell and channel
LPV_CONST int kFieldSum = 7;  // vec4 per halo cell and channel (clamped form), or what is added to a field
LPV_CONST int kIncidentVolume = 8;  // float, kVolumeFloats per cell
LPV_CONST int kExposure = 9;  // vec4: the exposure; then one per group of its reduction
LPV_CONST int kRecordedPairs = 10;  // tests only: uvec2 (triangle, cell)
LPV_CONST int kTestIn = 11;  // tests only
LPV_CONST int kTestOut = 12;  // tests only
LPV_CONST int kVoxelMoments = 13;  // vec4 (C, C x direction), one or, with a texture, kColours per cell of the light
LPV_CONST int kLobeCounts = 14;  // float per cell: N of eq. 1, all lights together; negative once divided by
LPV_CONST int kUvs = 15;  // float, 2 per vertex
LPV_CONST int kDirections = 16;  // float, 3 per vertex, object space
LPV_CONST int kRowIntegrals =
    17;  // double, 3 per texel and one more texel per row (shaders/voxelize/texture_integral.glsl)
LPV_CONST int kTreeNodes = 18;  // uvec4 per node of every level of a light's tree (shaders/voxelize/vpl_tree.glsl)
LPV_CONST int kTreeEntries = 19;  // vec4, kPlainEntryTexels or kTexturedEntryTexels per entry of a light's tree
                                  // (shaders/transport/vpls.glsl)
LPV_CONST int kReceiverBlocks = 20;  // uint per block of cells: packedBlock()
LPV_CONST int kCursors =
    21;  // uvec2 per block: resume position of its walk through the tree, double-buffered by turn parity
LPV_CONST int kAddedDistance = 21;  // as kEmitterDistanceBuffer, of lights that are added (gather_sum.comp)
LPV_CONST int kEmitterDistanceBuffer = 22;  // float per cell: cells to the nearest VPL that was taken by itself
LPV_CONST int kThinTriangles = 23;  // ListHeader, then uint: triangles that snapping makes a segment over several cells
LPV_CONST int kRowMoments =
    24;  // double, 2 per texel and one more texel per row (shaders/voxelize/texture_integral.glsl)
LPV_CONST int kNearFieldTiles = 25;  // uint per tile of a picture: 1 where a pixel needs the near field
LPV_CONST int kNearFieldPoints = 26;  // ListHeader, then uvec4 per four points that are to be evaluated
LPV_CONST int kShadowPoints = 27;  // four per kNearFieldPoints entry (shaders/visibility/shadow_points.glsl)
LPV_CONST int kCellVisibility = 28;  // CellVisibility per cell: what it sees of one light
LPV_CONST int kPatchSums = 28;  // float, kPatchSumsOfPoint per shadow point (shaders/visibility/patch_sums.glsl)
LPV_CONST int kPatches = 29;  // a Patch each (shaders/visibility/patches.glsl)
LPV_CONST int kPatchExchange = 30;  // float per two patches, PatchParams.stride to what one sends: E that another gets
                                    // from it of unit radiance x its area; negative: a light is between
LPV_CONST int kPatchSent = 4;  // vec4 per patch and parity of bounces: radiance it reflects x its scale
LPV_CONST int kPatchLights = 31;  // as kLightPoints: what patches send
LPV_CONST int kPieceLights = 2;  // vec4 per piece of the folds: its radiance (shaders/frame/fold_rays.comp)
LPV_CONST int kFoldTriangles = 3;  // uint: which pieces a triangle has (shaders/visibility/folds.glsl)
LPV_CONST int kFoldHits = 22;  // int per piece and ray from it: the piece it meets (shaders/visibility/folds.glsl)
LPV_CONST int kPatchShares = 1;  // with panes: uint per two patches: packedShare() of what light keeps between them

LPV_CONST int kBuried =
    2;  // uvec4 (pixels), then vec4 (where in the picture, depth, -) each (shaders/frame/buried.comp)
LPV_CONST int kHazeLights = 2;  // a HazeLight each: which points of lights are looked at through haze, and how often
LPV_CONST int kGlossPoints =
    4;  // a GlossPoint per pixel: what its reflections have met so far (shaders/frame/gloss.glsl)

// --- uniform blocks
LPV_CONST int kParams = 0;  // one struct below per stage
LPV_CONST int kDrawParams = 1;  // DrawParams of one object
LPV_CONST int kNearFieldParams = 2;  // NearFieldParams of one dispatch
LPV_CONST int kShadowParams = 3;  // ShadowParams of one dispatch
LPV_CONST int kSubpixelParams = 2;  // SubpixelParams of one dispatch
LPV_CONST int kBuriedParams = 2;  // BuriedParams of one dispatch
LPV_CONST int kGlossParams = 2;  // GlossParams of one dispatch
LPV_CONST int kHazeParams = 2;  // HazeParams of one dispatch

// --- texture units
LPV_CONST int kFieldIn = 0;  // samplerBuffer over a field
LPV_CONST int kFieldSource = 1;  // samplerBuffer over the injected field
LPV_CONST int kPatchExchangeTexels = 0;  // samplerBuffer over kPatchExchange: four that get something of one
LPV_CONST int kPatchSentTexels = 1;  // samplerBuffer over kPatchSent
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
LPV_CONST int kTree = 14;  // samplerBuffer over the entries of a light's tree
LPV_CONST int kDirect =
    15;  // samplerBuffer: the lights as receivers look at them (shaders/transport/emitter_list.glsl)
LPV_CONST int kEmitterDistance = 16;  // sampler3D: cells to the nearest VPL
LPV_CONST int kNearField = 17;  // irradiance from the lights themselves, and its weight
LPV_CONST int kOccluders = 18;  // usamplerBuffer: what shadow rays can meet (shaders/visibility/occluders.glsl)
LPV_CONST int kPoolLight = 20;  // of a picture: E from a pool of lights as if nothing lay between, and which share
LPV_CONST int kPoolShare = 21;  // arrives, by few rays from each pixel; a: ShadowParams.apart, -1 with nothing to meet
LPV_CONST int kLightPoints = 19;  // samplerBuffer: points of the lights (shaders/visibility/light_points.glsl)
LPV_CONST int kPanes = 23;  // of a picture: what what lies behind panes keeps of its radiance
LPV_CONST int kSubpixelsOwn = 24;  // of a picture: mean albedo of samples (shaders/frame/subpixels.glsl)
LPV_CONST int kSubpixelsFirst = 25;
LPV_CONST int kSubpixelsSecond = 26;
LPV_CONST int kApartAlbedo =
    20;  // of pictures of places where samples are lit: their mean albedo (shaders/frame/subpixels.glsl)
LPV_CONST int kApartLight = 29;  // of them: E in W/m^2; a: the mean of what it would be with nothing in the way
LPV_CONST int kApartPlace = 30;  // of them: the first sample's place, grid space; a: its depth
LPV_CONST int kApartNormal = 31;  // and its normal
LPV_CONST int kSampleAlbedo = 21;  // of one sample of each pixel, as kAlbedo to kEmitterDepth
LPV_CONST int kSampleNormal = 28;
LPV_CONST int kSampleDepth = 29;
LPV_CONST int kSampleEmission = 30;
LPV_CONST int kSampleEmitterDepth = 31;
LPV_CONST int kGloss = 0;  // of a picture: what surfaces reflect by their lobes; a: what of other light they do
LPV_CONST int kGlossLights = 1;  // of a picture: what lobes reflect of lights, before it is smoothed, over all that
                                 // they would of even light; a: variance, or -1 where there is no lobe
LPV_CONST int kGlossSurfaces = 2;  // of a picture: the same of surfaces; a: 0
LPV_CONST int kGlossMet = 13;  // of a picture: E in W/m^2 where its reflections met a surface
LPV_CONST int kGlossScene = 12;  // usamplerBuffer: what reflections show (shaders/frame/gloss_scene.glsl)
LPV_CONST int kGlossShares = 22;  // what lobes reflect in all, by cosine and roughness (server/scene/gloss.h)
LPV_CONST int kBuriedList = 1;  // samplerBuffer over kBuried
LPV_CONST int kHaze = 27;  // of a picture: what haze scatters towards the camera
LPV_CONST int kHazeSum = 1;  // of a picture: the same before it is smoothed, as kHazeSumOut
LPV_CONST int kGlossMaterial = 14;  // of a picture: roughness and metalness of its surfaces
LPV_CONST int kGlossMap = 15;  // of a surface that is drawn: its green multiplies roughness, its blue metalness
// --- image units
LPV_CONST int kHazeOut = 0;  // as kHaze
LPV_CONST int kHazeSumOut = 1;  // of a picture: rgb: what all rays so far have found; a: its variance
LPV_CONST int kIncidentOut = 0;  // 0, 1, 2
LPV_CONST int kEmitterDistanceOut = 3;
LPV_CONST int kNearFieldOut = 4;  // as kNearField
LPV_CONST int kPoolLightOut = 5;
LPV_CONST int kPoolShareOut = 6;
LPV_CONST int kGlossOut = 0;  // as kGloss, or kGlossLights
LPV_CONST int kGlossSurfacesOut = 1;
LPV_CONST int kSubpixelRadianceOut =
    0;  // mean radiance of lights in front; with places apart, of surfaces, at last of all
LPV_CONST int kSubpixelOwnOut = 1;  // as kSubpixelsOwn
LPV_CONST int kSubpixelFirstOut = 2;
LPV_CONST int kSubpixelSecondOut = 3;
LPV_CONST int kApartAlbedoOut = 4;
LPV_CONST int kApartPlaceOut = 5;
LPV_CONST int kApartNormalOut = 6;
LPV_CONST int kSubpixelLightsOut = 7;  // mean radiance of lights in front; a: how much of a pixel they are

// --- work-groups
LPV_CONST int kVoxelizeGroup = 64;  // small triangles: a thread each
LPV_CONST int kColumnGroup = 16;  // large triangles: threads of one work item
LPV_CONST int kThinGroup = 16;  // a segment: threads take its layers of cells
LPV_CONST int kCellGroup = 64;  // touched cells: a thread each
LPV_CONST int kFieldGroupX = 8;  // cells along x, y of a group that walks the field: as fast on llvmpipe as
LPV_CONST int kFieldGroupY = 4;  // 32 x 1, with fewer idle threads in narrow boxes
LPV_CONST int kFieldMarch = 4;  // cells along z per thread, so that the slab behind is still in registers
LPV_CONST int kNodeGroup = 64;  // nodes of a tree: a thread each
LPV_CONST int kBlockX = 8;  // a block of receivers: cells along x, y and z; a work-group each
LPV_CONST int kBlockY = 4;
LPV_CONST int kBlockZ = 4;  // all of a column by one thread: what it reads of the tree serves them all
LPV_CONST int kNearFieldGroup = 32;  // tiles of a picture, blocks of points, or points in fours: a thread each
LPV_CONST int kNearFieldTile = 8;  // pixels across and down
LPV_CONST int kNearFieldBlockX = 8;  // points that a thread decides about: a bit each of a uint
LPV_CONST int kNearFieldBlockY = 4;
LPV_CONST int kNearFieldSpacing = 8;  // of NearFieldParams where frames are reduced
LPV_CONST int kPatchGroup = 64;  // patches, or parts of their rows: a thread each
LPV_CONST int kPatchRows = 4;  // patches that a thread of patch_bounce.comp has: a texel of their exchange
LPV_CONST int kCreviceRays = 128;  // of a patch, to what is nearer than it is large,
LPV_CONST int kPatchPlaces = 16;  // of a triangle, from which they go; known to be parted (scene/parted_patches.h)
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
                                        // rounds in all, without reporting it
LPV_CONST int kMaxPieceTriangles = 8191;  // per dispatch: kMaxSlices items of each stay below 65535 groups
LPV_CONST int kMaxThinTriangles = 65535;  // per dispatch: a group each
LPV_CONST int kFluxBits = 50;  // FLUX: the light's whole area is 2^50 in fixed point, its sums 64 bits wide
LPV_CONST int kSetTriangles = 32;  // COUNT of a light with so few: a cell keeps which of them came to it
LPV_CONST int kSamplesPerThread = 32;  // dense sampling

// --- accumulators of one cell: uint words. The first counts the VPLs that came (COUNT: lobes, N of eq. 1; FLUX:
// pairs); sums in fixed point follow, in COUNT a word each, in FLUX kWideWords each.
LPV_CONST int kColours = 3;
LPV_CONST int kMomentParts = 4;  // C, then C x direction (x, y, z)
LPV_CONST int kWideWords = 2;  // a sum of 64 bits: low word, high word
LPV_CONST int kFirstSum = 1;  // word of a cell where its sums begin
LPV_CONST int kSetWords = 1;  // COUNT of at most kSetTriangles triangles: which of them came, a bit each, and no sums
LPV_CONST int kCountWords = kFirstSum + 3;  // sum of lobe directions; N itself is the zeroth moment
LPV_CONST int kTexturedCountWords = kFirstSum + kMomentParts * kColours;
LPV_CONST int kFluxWords = kFirstSum + kWideWords * kMomentParts;
LPV_CONST int kTexturedFluxWords = kFirstSum + kWideWords * kMomentParts * kColours;

// --- an entry of the table of VPLs: uint words. Sums of kWideWords each; the offset is from the cell's lower corner.
LPV_CONST int kVplKey = 0;  // 0: free; else (cell of the light's box << kBinBits | bin) + 1
LPV_CONST int kBinBits = 6;  // kNormalBins fit
LPV_CONST int kVplArea = 1;
LPV_CONST int kVplDirection = kVplArea + kWideWords;  // area x direction, 3 sums
LPV_CONST int kVplOffset =
    kVplDirection + 3 * kWideWords;  // weight x offset, 3 sums; without texture the weight is the area
LPV_CONST int kPlainVplWords = kVplOffset + 3 * kWideWords;
LPV_CONST int kVplColour = kPlainVplWords;  // area x colour, 3 sums
LPV_CONST int kVplWeight = kVplColour + kColours * kWideWords;  // area x brightest channel
LPV_CONST int kTexturedVplWords = kVplWeight + kWideWords;
LPV_CONST int kSquareWords = 6 * kWideWords;  // at the end, with LPV_SQUARES: weight x squares of where it emits (xx,
                                              // yy, zz, xy, xz, yz), about the cell's lower corner

// --- the volume
LPV_CONST int kCoefficients = 4;  // 2-band SH
LPV_CONST int kVolumeFloats = kColours * kCoefficients;  // of a cell: [colour][coefficient]
LPV_CONST int kSectors = 8;  // layers where light is in layers by the direction that it comes from
LPV_CONST float kSectorBorder = 0.1f;  // sine of the angle up to which two of them share the light beside a border

// --- values of defines that choose a mode
// LPV_LOOKUP: lpv::Lookup
#define LPV_LOOKUP_SH2 0  // trilinear, SH2
#define LPV_LOOKUP_CAP 1  // trilinear, CAP
#define LPV_LOOKUP_NEAREST 2  // nearest cell, SH2
// LPV_SECTORS: lpv::Sectors, how directions are told apart
#define LPV_SECTORS_NONE 0  // a light is in the layer of its group
#define LPV_SECTORS_OCTANTS 1
#define LPV_SECTORS_AROUND_X 2  // 45 degrees each about the x axis
#define LPV_SECTORS_AROUND_Y 3
#define LPV_SECTORS_AROUND_Z 4
// LPV_NEAR_FIELD: where receivers evaluate the lights themselves
#define LPV_NEAR_FIELD_NOWHERE 0
#define LPV_NEAR_FIELD_EMITTERS 1  // near emitters and outside the grid
#define LPV_NEAR_FIELD_EVERYWHERE 2
#define LPV_NEAR_FIELD_SAMPLED 3  // at some pixels, before shading (shaders/frame/near_field.comp)
#define LPV_NEAR_FIELD_KNOWN 4  // everywhere, before shading

// LPV_PASS: of shaders/frame/near_field.comp
#define LPV_PASS_WEIGHTS 0
#define LPV_PASS_FIRST 1
#define LPV_PASS_BETWEEN 2
#define LPV_PASS_LATTICE 3

/// A block of receivers as kReceiverBlocks lists it; numbers of blocks along x, y and z below 2^kBlockBits.
LPV_CONST int kBlockBits = 8;
LPV_FUNCTION uint packedBlock(uint x, uint y, uint z) { return x | (y << kBlockBits) | (z << (2 * kBlockBits)); }

/// What a list begins with whose length is also an indirect dispatch: one group per work item.
struct ListHeader {
  uint groupsX, groupsY, groupsZ;
  uint count;  // entries that follow
};

#ifdef __cplusplus
inline constexpr ListHeader kEmptyListHeader{.groupsX = 0, .groupsY = 1, .groupsZ = 1, .count = 0};
#endif

/// The same for one light's cells (or VPLs), kCellGroup of them a group.
struct VoxelHeader {
  uint groupsX, groupsY, groupsZ;
  uint count;  // entries that follow
  uint degenerate;  // triangles of zero area
  uint lost;  // VPLs that found no room in the table
  uint treeEntries;  // headers and VPLs of the tree
  uint litCells;  // cells that hold VPLs
};

// --- VPLs and their tree (MATHS.md 3b)
LPV_CONST int kNormalBins = 54;  // per cell: 3 x 3 on each face of a cube
LPV_CONST int kMaxLevels = 10;  // of a tree: blocks of 1, 2, 4 .. 512 cells
LPV_CONST int kPlainEntryTexels = 4;  // vec4 of an entry (shaders/transport/vpls.glsl) ...
LPV_CONST int kTexturedEntryTexels = 5;  // ... and of one with a colour
LPV_CONST int kMostProbes = 64;  // places of the table that a VPL is looked for in
LPV_CONST float kColouredSize = 2.0;  // nodes of a textured light count as so much larger: a VPL has one position for
                                      // all colours, so that what is merged loses which colour came from where
LPV_CONST float kFarFromVpls = 1e4;  // cells: nothing near
LPV_CONST float kNearFieldBegin = 2.0;  // cells from an emitter: up to here receivers look at the lights themselves,
LPV_CONST float kNearFieldEnd = 3.0;  // from here on at the volume (MATHS.md 3c)
LPV_CONST float kAsPolygons = 0.0;  // what a light of the emitter list is looked at as
LPV_CONST float kAsVpls = 1.0;
LPV_CONST float kAsEmitterTree = 2.0;
LPV_CONST int kTreeSpaceTexels = 3;  // of an emitter tree's matrix, before its entries
LPV_CONST int kGatherTargets = 4;  // layers that a light is put into: its group's and the one it is on its way to, of
                                   // what is looked up and of what is looked at
LPV_CONST int kMaxRounds = 32768;  // of one dispatch's walk through a tree: llvmpipe ends a thread's loops after
                                   // 2^16 rounds in all, without reporting it

// --- shadow rays (MATHS.md 3d)
LPV_CONST int kLightPointTexels = 3;
LPV_CONST int kOccluderHeader = 6;  // texels before the nodes (shaders/visibility/occluders.glsl)
LPV_CONST float kBoxMargin = 1e-6;  // of coordinates of boxes and of a segment's start: more than rounding can do
LPV_CONST int kLeafItems = 8;  // of a BVH's node: see BvhNode::leaf
LPV_CONST int kInstanceTexels = 7;
LPV_CONST int kTriangleTexels = 3;
LPV_CONST int kUvTexels = 2;  // of a triangle whose alpha varies
LPV_CONST int kAlphasOfTexel = 16;
LPV_CONST float kShadowOffset = 2e-4;  // cells along the receiver's normal where rays begin
LPV_CONST int kAllLights = -1;  // what an occluder blocks, or else the light whose own it blocks; rays between patches
LPV_CONST int kFromSurfaces = -2;  // light that surfaces reflect, which lights block: of an occluder, that alone
LPV_CONST float kFromFolds =
    -3.0;  // less the square of Patch::reach: the same of a patch that stands for small triangles
LPV_CONST float kNoShare = -2.0;  // in the place of what a pixel's share says (ShadowParams.apart): it has none
LPV_CONST int kPatchSumsOfPoint = 64;  // at most, of batches of patches (shaders/visibility/patch_sums.glsl)
LPV_CONST int kLeastPatchBatch = 16;  // patches
LPV_CONST int kNoRay = -2;  // in kFoldHits: none was sent
LPV_CONST int kFoldRays = 8;  // all around from a receiver, a turn
LPV_CONST int kPieceBits = 8;  // of a word of kFoldTriangles: how many pieces; above them the first
LPV_CONST float kShadowEnd = 0.9999;  // of a ray's way, where it has arrived

/// Of the rays from a cell to points of one light, which it gets equal shares of its light from: sums.
struct CellVisibility {
  vec4 all;  // unit vectors towards the points; w: rays
  vec4 seen;  // of those that arrived
};

struct CellVisibilityParams {
  LPV_VEC3 ivec3 dims;  // cells
  int firstBlock;  // blocks before this dispatch's first
  LPV_VEC3 ivec3 blocks;  // along x, y and z
  int turn;  // of four rays
  int turns;  // at most, for a cell
  int firstPoint;  // of the light's points (shaders/visibility/light_points.glsl)
  int pointCount;
  int light;  // of those that emit, in the order of names
  int toTheEnd;  // 1: cells whose first rays agree send the others all the same
  int pad0;
  int pad1;
  int pad2;
};

struct PatchParams {
  int count;  // of patches
  int first;  // threads before this dispatch's first
  int bounce;  // 0: what comes from the lights; a turn of balancing
  int lastBounce;
  int balanced;  // parity of the last turn of balancing
  int pieces;  // of folds, after the patches
  float weight;  // of this turn (server/scene/patches.h: BouncePlan)
  int stride;  // of kPatchExchange: patches, and up to three more
  vec4 lightsLow, lightsHigh;  // the box of all lights, cells
  int foldTurns;  // of kFoldRays rays from each piece
  int pad0, pad1, pad2;
};

struct Counters {
  uint degenerate;  // light triangles of zero area
  uint clamped;  // output cells cut back to phi >= 0, |D| <= phi
  uint touched;  // cells that hold light
  uint pad0;
};

struct VoxelizeParams {
  dmat4 gridFromObject;  // grid space: cell units from the grid's minimum corner
  dmat4 areaFromObject;  // times the object-space cross product of two edges: area x outward normal, cell^2
  double momentUnits;  // fixed-point units of a moment of 1
  double colourScale;  // 1 / the brightest texel
  LPV_VEC3 ivec3 dims;  // cells x, y, z
  uint firstTriangle;
  uint triangleCount;
  uint samplesPerTriangle;  // dense sampling
  uint threadsPerTriangle;  // dense sampling
  int textureLevels;  // of the mip chain
  LPV_VEC3 vec3 textureMean;  // rgb mean of all texels, as a share of the brightest
  LPV_VEC3 ivec3 boxLower;  // VPLs: first cell of the light's box
  LPV_VEC3 ivec3 boxSize;  // VPLs: its cells along x, y, z
  uint tableEntries;  // of the table of VPLs, a power of two
  ivec2 textureSize;  // width, height
  LPV_VEC3 vec4 normals[kSetTriangles];  // sets of triangles: unit, outward, grid space; w: 0
  vec4 pad0;  // with doubles a block's size is a multiple of 32 bytes
};

struct TreeParams {
  LPV_VEC3 ivec3 lower;  // first cell of the light's box
  int levels;
  LPV_VEC3 ivec3 upper;  // one past its last cell
  int level;  // of this pass
  uvec4 nodesBefore[(kMaxLevels + 3) / 4];  // nodes of the levels below level l, in [l / 4][l % 4]
  double shareOfUnit;  // what one fixed-point unit stands for, as a share of areaScale
  float areaScale;  // area that a moment of 1 stands for, in cells of the light's grid, squared
  uint firstThread;  // threads of the pass before this dispatch's first
  LPV_VEC3 vec3 origin;  // where the light's grid begins, cells of the field
  float cell;  // edge of its cells, cells of the field
};

struct GatherParams {
  LPV_VEC3 ivec3 dims;  // cells
  uint firstBlock;  // blocks before this piece's first
  LPV_VEC3 vec3 weight;  // per channel: radiance of a colour of 1, in units of the channel's palette radiance
  float openingRatio;  // k of MATHS.md 3b.3
  int entryCount;  // of the light's tree
  int turn;  // of a walk through a large tree: dispatches of this piece before this one
  int targets;  // 1 .. kGatherTargets
  int unused;
  ivec4 firstChannel;  // of each target: its layer's, or its first sector's
  vec4 share;  // of the light, that goes there
};

struct GatherSumParams {
  LPV_VEC3 ivec3 dims;  // cells
  uint firstBlock;  // blocks before this piece's first
  int channels;  // of a layer
  uint layers;  // a bit each: those that are added
};

struct InjectParams {
  LPV_VEC3 ivec3 dims;  // cells
  int group;  // the light's
  LPV_VEC3 vec3 weight;  // per channel: intensity of a moment of 1, W/sr per unit of the channel's palette radiance
  float sides;  // that emit: 1 or 2; the factor of band 0
  float band1Factor;  // 1 for one side, 0 for two, where band 1 cancels
  float cell;  // VPLs: edge of the cells of the light's grid, cells of the field
  LPV_VEC3 ivec3 boxLower;  // VPLs: first cell of the light's box
  LPV_VEC3 ivec3 boxSize;  // VPLs: its cells along x, y, z
  LPV_VEC3 ivec3 upper;  // VPLs: one past the last cell of the product
  LPV_VEC3 ivec3 firstCell;  // VPLs: of the product, that the light's box meets
  LPV_VEC3 ivec3 cellCount;  // VPLs: of these along x, y, z
  LPV_VEC3 vec3 origin;  // VPLs: where the light's grid begins, cells of the field
};

struct PropagateParams {
  LPV_VEC3 ivec3 dims;  // cells
  LPV_VEC3 ivec3 lower;  // first cell of the box to compute
  LPV_VEC3 ivec3 upper;  // one past the last cell
  int groupsPerChannel;  // along y
};

struct VolumeParams {
  LPV_VEC3 ivec3 dims;  // cells
  int firstSlice;  // z of this piece's first slice
  vec4 palette[kColours];  // rgb radiance of each channel; w: 0
  float band0Factor;
  float band1Factor;
  int group;  // of lights
  int firstChannel;  // of the group
};

struct ExposureParams {
  float factor;  // 2^ev, applied to what automatic exposure finds too
  float key;  // of automatic exposure
  uint firstGroup;  // groups of pixels before this dispatch's first
  uint pad0;
};

struct FrameParams {
  mat4 clipFromEye;  // reversed depth: near 1, far 0; eye space is world space moved to the eye
  LPV_VEC3 vec3 rayOrigin;  // grid space: from the eye to the top left corner of the picture plane at view depth 1
  float depthScale;  // view depth = depthScale / (stored depth + depthOffset), metres
  LPV_VEC3 vec3 rayRight;  // grid space: across the whole picture
  float depthOffset;
  LPV_VEC3 vec3 rayDown;  // grid space: down the whole picture
  LPV_VEC3 vec3 eye;  // grid space
  LPV_VEC3 vec3 palette;  // rgb radiance of the one channel of a monochrome volume
  LPV_VEC3 ivec3 dims;  // cells
  int pixels;  // of the picture
  vec2 pixelSize;  // as a share of the picture's width and height
  int samples;  // of each pixel, that say what is in it: 1 or more
  float openingShare;  // of k: what points of the picture take whole (shaders/transport/emitter_list_four.glsl)
  LPV_VEC3 ExposureParams exposure;
};

struct BuriedParams {
  vec2 pixelSize;  // as a share of the picture
  int firstRow;  // of this dispatch
  int most;  // pixels that there is room for
};

struct NearFieldParams {
  ivec2 stride;  // pixels from a point to those before and after it that are known; 0 for the first points
  int first;  // of the tiles or blocks of points of this dispatch
  int spacing;  // pixels between the points that are evaluated whatever is around them
};

// --- reflections (MATHS.md 3e)
LPV_CONST int kGlossSurfaceTexels = 2;  // of shaders/frame/gloss_scene.glsl
LPV_CONST int kGlossLightTexels = 3;
LPV_CONST uint kGlossBothSides = 1u;  // flags of theirs: it has, or sends, light on both sides;
LPV_CONST uint kGlossDirected = 2u;  // it sends about directions of its mesh's;
LPV_CONST uint kGlossUnseen = 4u;  // rays pass through it
LPV_CONST int kGlossPlaces = 2;  // that a pixel's reflections have met and that E is found at
LPV_CONST int kGlossReach = 3;  // pixels on each side whose places say what E is at a pixel's
LPV_CONST int kGlossRays = 4;  // of a pixel and turn: in directions of the lobe, and as many to points of lights

struct GlossParams {
  int first;  // blocks of pixels before this dispatch's first
  int turn;  // of kGlossRays
  int firstRow;  // of the pixels, in the picture that they are some rows of
  int shadows;  // 1: something may stand in the lights' way
  int last;  // 1: of the block's turns; places that were met are listed
  int bandRow;  // of the pixels: where the band begins that is known at a time, kGlossReach rows before it is wanted
  int bandRows;
  int rowsWanted;  // from kGlossReach on
  int spacing;  // from one pixel to the next at whose place E is found: 1, or, of one place of each, up to kGlossReach
  int pad0, pad1, pad2;
};

// --- haze (MATHS.md 3g)
LPV_CONST int kHazeRays = 4;  // of a pixel and turn
LPV_CONST int kHazeCandidates = 8;  // points of lights that are weighed for a ray

/// Of the points that pixels look at through haze (shaders/visibility/light_points.glsl).
struct HazeLight {
  vec4 sphere;  // around all points: middle, radius, grid space; a radius of 0: no view passes near
  int firstPoint;
  int points;
  float end;  // up to here numbers in [0, 1) choose this light or one before it
  float share;  // of the numbers that choose it
  float pointArea;  // around a point, that it stands for; 0: the point itself says
  float power;  // area x brightness
  float pad0, pad1;
};

struct HazeParams {
  int first;  // tiles before this dispatch's first
  int turn;  // of kHazeRays
  int turns;  // of the lights, or of the surfaces
  int firstTurn;  // 1: the sum begins anew
  int firstRow;  // of the pixels, in the picture that they are some rows of
  int lights;  // HazeLights
  int ofSurfaces;  // 1: points are those of patches, of which few are looked at
  float scattering;  // per cell
  float anisotropy;
  int pad0, pad1, pad2;
};

struct SubpixelParams {
  vec2 offset;  // of the sample from the middle of its pixel, pixels
  int samples;  // of each pixel
  int firstRow;  // of the picture, in the sample's textures
  int firstWanted;  // row of the picture, of those that are summed up
  int endWanted;  // one past the last
  int rays;  // that each pool of lights got from a place apart, at most
  int samplesOfLights;  // in all, where they are apart
  ivec2 begin;  // in the sample's textures, of what is looked at
  int ofLights;  // 1: lights alone are looked for
  int pad0;
};

struct ShadowParams {
  int firstLight;  // of the pool
  int lightsEnd;  // one past its last
  int firstPoint;  // of the pool's points (shaders/visibility/light_points.glsl)
  int pointCount;
  int turn;  // of four rays: this dispatch
  int turns;  // at most, for a point
  int pool;  // this one, of `pools`
  int pools;
  int apart;  // 1: what a pool sends does not go into the sum, but to kPoolLightOut and kPoolShareOut; 2: the same,
              // with what a ray is worth in the place of the number of rays
  int jitter;  // 0: rays go to the same places from every pixel; 1: to others, so that steps become grain
  int even;  // 1: rays go to points that are spread evenly over the pool; 0: to those that are worth most to the
             // receiver
  int foldTurns;  // of rays all around to the pieces of folds; 0: none
  int firstRow;  // of the pixels, in the picture that they are some rows of
  int darkTurns;  // that see nothing before a point is taken for dark, at least 1
  int patchBatch;  // patches to one of kPatchSums, a power of two, kLeastPatchBatch at least
  int smoothedBy;  // pixels between receivers whose rays go to different places, to be smoothed; 0: to the same
  int turnStep;  // from place to place of a turn, in an order in which the first few are spread, too
  int pad0, pad1, pad2;
};

struct DrawParams {
  mat4 eyeFromObject;
  mat4 normalFromObject;  // inverse transpose of the linear part
  LPV_VEC3 vec3 colour;  // albedo, or radiance of the front
  LPV_VEC3 vec3 backColour;  // radiance of the back
  LPV_VEC3 vec3 transmission;  // of a surface: what passes where alpha is 0
  float opacity;  // times the texture's alpha, where that varies
  float leastAlpha;  // of what the G-buffer shows
  float masked;  // 1: what the G-buffer shows has an alpha of 1, the rest of 0
  float normalScale;  // of the picture of normals
  float roughness;
  float metalness;
  float atInfinity;  // 1: behind all else, wherever the camera is
  float pad1;
  float pad2;
};

#ifdef __cplusplus
// Offsets are those of std140 and std430: vectors of three at multiples of 16, doubles at multiples of 8.
static_assert(sizeof(Counters) == 16 && sizeof(ListHeader) == 16 && sizeof(VoxelHeader) == 32);
static_assert(kCountWords == 4 && kTexturedCountWords == 13 && kFluxWords == 9 && kTexturedFluxWords == 25);
static_assert(kPlainVplWords == 15 && kTexturedVplWords == 23 && kNormalBins <= 1 << kBinBits);
static_assert(offsetof(VoxelizeParams, momentUnits) == 256 && offsetof(VoxelizeParams, dims) == 272);
static_assert(offsetof(VoxelizeParams, firstTriangle) == 284 && offsetof(VoxelizeParams, textureLevels) == 300);
static_assert(offsetof(VoxelizeParams, textureMean) == 304 && offsetof(VoxelizeParams, tableEntries) == 348);
static_assert(offsetof(VoxelizeParams, boxLower) == 320 && offsetof(VoxelizeParams, boxSize) == 336);
static_assert(offsetof(VoxelizeParams, textureSize) == 352 && offsetof(VoxelizeParams, normals) == 368);
static_assert(sizeof(VoxelizeParams) == 896);
static_assert(offsetof(TreeParams, levels) == 12 && offsetof(TreeParams, level) == 28);
static_assert(offsetof(TreeParams, nodesBefore) == 32 && offsetof(TreeParams, shareOfUnit) == 80);
static_assert(offsetof(TreeParams, firstThread) == 92 && offsetof(TreeParams, cell) == 108);
static_assert(sizeof(TreeParams) == 112);
static_assert(offsetof(GatherParams, firstBlock) == 12 && offsetof(GatherParams, openingRatio) == 28);
static_assert(offsetof(GatherParams, firstChannel) == 48 && sizeof(GatherParams) == 80);
static_assert(offsetof(GatherSumParams, channels) == 16 && offsetof(GatherSumParams, layers) == 20);
static_assert(kBlockZ == 4);  // gather.comp: a column is a vec4
static_assert(offsetof(InjectParams, group) == 12 && offsetof(InjectParams, sides) == 28);
static_assert(offsetof(InjectParams, band1Factor) == 32 && offsetof(InjectParams, boxLower) == 48);
static_assert(offsetof(InjectParams, cell) == 36 && offsetof(InjectParams, firstCell) == 96);
static_assert(offsetof(InjectParams, origin) == 128 && sizeof(InjectParams) == 144);
static_assert(offsetof(PropagateParams, groupsPerChannel) == 44 && sizeof(PropagateParams) == 48);
static_assert(offsetof(VolumeParams, palette) == 16 && offsetof(VolumeParams, band0Factor) == 64);
static_assert(offsetof(VolumeParams, firstChannel) == 76 && sizeof(VolumeParams) == 80);
static_assert(offsetof(FrameParams, depthScale) == 76 && offsetof(FrameParams, depthOffset) == 92);
static_assert(offsetof(FrameParams, pixels) == 156 && offsetof(FrameParams, eye) == 112);
static_assert(offsetof(FrameParams, palette) == 128 && offsetof(FrameParams, dims) == 144);
static_assert(offsetof(FrameParams, pixelSize) == 160 && offsetof(FrameParams, exposure) == 176);
static_assert(sizeof(ExposureParams) == 16 && sizeof(FrameParams) == 192);
static_assert(offsetof(PatchParams, lightsLow) == 32 && sizeof(PatchParams) == 80 && sizeof(CellVisibility) == 32 &&
              offsetof(CellVisibilityParams, blocks) == 16);
static_assert(offsetof(CellVisibilityParams, turn) == 28 && sizeof(CellVisibilityParams) == 64);
static_assert(sizeof(BuriedParams) == 16 && sizeof(NearFieldParams) == 16 && sizeof(ShadowParams) == 80 &&
              sizeof(SubpixelParams) == 48 && sizeof(GlossParams) == 48 && sizeof(HazeParams) == 48 &&
              sizeof(HazeLight) == 48);
static_assert(offsetof(DrawParams, colour) == 128 && offsetof(DrawParams, backColour) == 144);
static_assert(offsetof(DrawParams, opacity) == 172 && sizeof(DrawParams) == 208);
}  // namespace lpv::layout
#undef LPV_CONST
#undef LPV_FUNCTION
#undef LPV_VEC3
#endif
