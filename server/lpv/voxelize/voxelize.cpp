#include "lpv/voxelize/voxelize.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <glm/gtx/component_wise.hpp>
#include <utility>

#include "gpu/failure.h"
#include "gpu/gl.h"
#include "lpv/pacing/chunked.h"
#include "lpv/voxelize/fixed_point.h"

namespace lpv {

namespace {

/// The linear map that takes the cross product of two object-space edges to that of the transformed edges (the cofactor
/// matrix), turned over for mirrors: the object-space outer side in grid space.
glm::dmat4 outwardFromObject(const glm::dmat4& gridFromObject) {
  const glm::dvec3 a(gridFromObject[0]), b(gridFromObject[1]), c(gridFromObject[2]);
  const double side = glm::dot(a, glm::cross(b, c)) < 0.0 ? -1.0 : 1.0;
  return {glm::dvec4(side * glm::cross(b, c), 0.0), glm::dvec4(side * glm::cross(c, a), 0.0),
          glm::dvec4(side * glm::cross(a, b), 0.0), glm::dvec4(0.0)};
}

/// Whether cells keep which triangles came to them instead of sums.
bool keepsSets(const VoxelizeInputs& source) {
  return source.method.injection == Injection::kCount && source.method.method != InjectionMethod::kDense &&
         !source.textured() && !source.directed() && source.triangles().size() <= layout::kSetTriangles;
}

/// Words of a cell's accumulators.
std::size_t accumulatorWords(const VoxelizeInputs& source) {
  const bool flux = source.method.injection == Injection::kFlux;
  if (flux) return source.textured() ? layout::kTexturedFluxWords : layout::kFluxWords;
  if (keepsSets(source)) return layout::kSetWords;
  return source.textured() ? layout::kTexturedCountWords : layout::kCountWords;
}

/// Lobes one triangle can put into one cell: a direction per vertex spreads them over at most 180 degrees each way.
std::uint64_t lobesPerTriangle(const VoxelizeInputs& source) {
  if (source.method.method == InjectionMethod::kDense) return std::uint64_t(source.method.denseSamples);
  return source.directed() ? 9 : 1;
}

/// Edge of what fills cells, cells: a light that is narrower along two of its mesh's axes has mostly strips and slivers
/// in them.
constexpr double kThinLight = 2.0;

/// Whether VPLs keep second moments of where they emit. By the light's extent, so that its tessellation and its pose do
/// not matter.
bool keepsSquares(const VoxelizeInputs& source) {
  if (!source.method.vpls || source.textured()) return source.method.vpls;
  glm::dvec3 extent = source.mesh->bounds.extent();
  for (int k = 0; k < 3; ++k) extent[k] *= glm::length(glm::dvec3(source.gridFromObject[k]));
  const double most = glm::compMax(extent), least = glm::compMin(extent);
  return extent.x + extent.y + extent.z - most - least < kThinLight;
}

gpu::Defines variantOf(const VoxelizeInputs& source) {
  const bool flux = source.method.injection == Injection::kFlux;
  gpu::Defines variant = {{"LPV_FLUX", flux ? "1" : "0"},
                          {"LPV_TEXTURED", source.textured() ? "1" : "0"},
                          {"LPV_DIRECTIONS", source.directed() ? "1" : "0"}};
  if (source.method.vpls) {
    variant.emplace_back("LPV_VPLS", "1");
    variant.emplace_back("LPV_SQUARES", keepsSquares(source) ? "1" : "0");
  }
  if (keepsSets(source)) variant.emplace_back("LPV_SETS", "1");
  return variant;
}

gpu::Defines treeVariantOf(const VoxelizeInputs& source) {
  return {{"LPV_TEXTURED", source.textured() ? "1" : "0"}, {"LPV_SQUARES", keepsSquares(source) ? "1" : "0"}};
}

/// Words of an entry of the table of VPLs.
std::size_t vplWords(const VoxelizeInputs& source) {
  const int words = source.textured() ? layout::kTexturedVplWords : layout::kPlainVplWords;
  return std::size_t(words + (keepsSquares(source) ? layout::kSquareWords : 0));
}

constexpr double kMostEntries = 1 << 23;

/// Entries of the table: twice the VPLs there were last time, or that there may be. A power of two.
std::uint32_t entriesFor(const LightVoxels& voxels, double area) {
  const double triangles = double(voxels.source.triangles().size());
  const double guess = voxels.tree->vplCount > 0 ? voxels.tree->vplCount : 3.0 * triangles + 3.0 * area;
  return std::bit_ceil(std::uint32_t(std::clamp(2.0 * guess, 256.0, kMostEntries)));
}

/// Zeros of at least so many bytes.
GpuTask makeZeros(const char* label, std::size_t bytes, gpu::Buffer& out) {
  if (out.size() >= bytes) co_return;
  out = {};  // first the old memory, then the new
  out = gpu::Buffer(label, bytes, gpu::BufferUse::kDevice, gpu::Undefined{});
  co_await fillChunked(out);
}

void makeList(LightField& field, std::uint32_t entries) {
  const std::size_t listBytes = sizeof(layout::VoxelHeader) + entries * sizeof(glm::uvec2);
  if (field.vplList.size() < listBytes) {
    field.vplList = {};
    field.vplList = gpu::Buffer("VPL list", listBytes, gpu::BufferUse::kDynamic, gpu::Undefined{});
  }
  if (field.vplHeader.size() == 0) field.vplHeader = gpu::Readback("VPL header", sizeof(layout::VoxelHeader));
}

/// One group is always there: it also counts triangles without area.
constexpr layout::VoxelHeader kEmptyList = [] {
  layout::VoxelHeader header{};
  header.groupsX = header.groupsY = header.groupsZ = 1;
  return header;
}();

/// What is known of a light's triangles before they are voxelized.
struct TriangleCosts {
  double area = 0.0;  ///< of all, in the grid's unit, cell^2: what the largest moment can be
  std::vector<double> costs;  ///< of the triangles, in units of Stage::kVoxelize: means of a few at a time
};

/// A triangle's area x outward normal, in the grid's unit, cell^2.
glm::dvec3 areaNormal(const Mesh& mesh, const glm::uvec3& t, const glm::dmat3& areaFromObject) {
  const glm::dvec3 p(mesh.positions[t.x]), q(mesh.positions[t.y]), r(mesh.positions[t.z]);
  return areaFromObject * glm::cross(q - p, r - p);
}

/// Triangles whose costs are added up, and between whose areas others may work.
constexpr std::size_t kTrianglesPerCost = 64, kTrianglesPerPause = 1 << 16;

GpuTask estimateCosts(const VoxelizeInputs& source, const glm::dmat4& areaFromObject, TriangleCosts& out) {
  const glm::dmat3 map(areaFromObject);
  const glm::ivec3& dims = source.dims;
  const double face = double(glm::compMax(dims)) * glm::compMax(dims);  // most columns that one triangle meets
  const std::size_t triangles = source.triangles().size();
  for (std::size_t first = 0; first < triangles; first += kTrianglesPerCost) {
    const std::size_t end = std::min(triangles, first + kTrianglesPerCost);
    VoxelizeWork work{double(end - first), 0.0};
    for (std::size_t i = first; i < end; ++i) {
      const double area = glm::length(areaNormal(*source.mesh, source.triangles()[i], map));
      out.area += area;
      work.columns += std::min(area, face);
    }
    out.costs.push_back(work.units() / work.triangles);
    if (end % kTrianglesPerPause == 0) co_yield yield();
  }
}

/// How many triangles from `first` on make up `room` units, and what they are; at least one.
struct Batch {
  std::uint32_t count = 0;
  double units = 0.0;
};
Batch nextBatch(const TriangleCosts& of, std::uint32_t first, std::uint32_t end, double room) {
  Batch batch;
  while (first + batch.count < end) {
    const std::uint32_t at = first + batch.count;
    const double cost = of.costs[at / kTrianglesPerCost];
    const auto left = std::uint32_t(kTrianglesPerCost - at % kTrianglesPerCost);
    const auto fit = std::uint32_t(std::min(std::max(0.0, (room - batch.units) / cost), 1e9));
    const std::uint32_t taken = std::min({left, end - at, std::max(fit, batch.count == 0 ? 1U : 0U)});
    batch.count += taken;
    batch.units += taken * cost;
    if (taken < left) break;
  }
  return batch;
}

/// For collect.comp; nothing comes to a cell from a triangle without area.
void listNormals(layout::VoxelizeParams& params, const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::dvec3 area = areaNormal(mesh, mesh.triangles[i], glm::dmat3(params.areaFromObject));
    // Scaled first: the squares of a tiny triangle's normal would not fit.
    const double size = glm::compMax(glm::abs(area));
    if (size > 0.0) params.normals[i] = glm::vec4(glm::normalize(area / size), 0.0);
  }
}

/// Scales of a light's fixed point, into `params` and `voxels`.
void chooseScales(layout::VoxelizeParams& params, double area, LightVoxels& voxels) {
  const VoxelizeInputs& source = voxels.source;
  const double triangles = double(source.triangles().size());
  if (source.method.injection == Injection::kFlux) {
    // A little more than the sum, for its rounding. A light without area has nothing to scale.
    voxels.areaScale = area > 0.0 ? area * (1.0 + 1e-9) : 1.0;
    params.areaFromObject /= voxels.areaScale;
    params.momentUnits = std::ldexp(1.0, layout::kFluxBits);
    voxels.roundingError = 0.5 * triangles / params.momentUnits;
    return;
  }
  const Expected<FixedPoint> fixedPoint = fixedPointFor(std::uint64_t(triangles) * lobesPerTriangle(source));
  if (!fixedPoint.ok()) throw gpu::Failure(fixedPoint.status());
  voxels.areaScale = 1.0;
  params.momentUnits = std::ldexp(1.0, fixedPoint->shift);
  voxels.roundingError = fixedPoint->error;
}

/// But for its scales, for which the areas of the triangles are needed.
VoxelizeJob jobOf(LightVoxels& voxels, const GpuLightTexture* texture) {
  const VoxelizeInputs& source = voxels.source;
  VoxelizeJob job;
  job.variant = variantOf(source);
  job.varying = source.textured() || source.directed();
  job.params.gridFromObject = source.gridFromObject;
  job.params.areaFromObject = 0.5 * outwardFromObject(source.gridFromObject);
  job.params.dims = source.dims;
  const auto samples = std::uint32_t(source.method.denseSamples);
  job.params.samplesPerTriangle = samples;
  job.params.threadsPerTriangle = (samples + std::uint32_t(layout::kSamplesPerThread) - 1) / layout::kSamplesPerThread;
  voxels.radianceScale = texture != nullptr ? texture->radianceScale : 1.0;
  job.params.colourScale = 1.0 / voxels.radianceScale;
  if (texture != nullptr) {
    job.params.textureSize = texture->size;
    job.params.textureLevels = texture->levels;
    job.params.textureMean = glm::vec3(texture->mean / texture->radianceScale);
  }
  if (keepsSets(source)) listNormals(job.params, *source.mesh);
  return job;
}

}  // namespace

/// One light's voxelization under way. It has the field's accumulators: where it is abandoned they go with it, and the
/// next begins with zeros again.
struct Voxelizer::Run {
  LightField& field;
  gpu::Buffer accumulators;
  const GpuMesh& mesh;
  const GpuLightTexture* texture;
  LightVoxels& voxels;
  TriangleCosts costs;
  VoxelizeJob job;
  Pacing pacing;
};

Voxelizer::Voxelizer() : params_("voxelize params", sizeof(layout::VoxelizeParams), gpu::BufferUse::kDynamic) {}

TriangleVoxelizer& Voxelizer::voxelizerFor(InjectionMethod method) {
  switch (method) {
    case InjectionMethod::kRaster:
      return raster_;
    case InjectionMethod::kDense:
      return dense_;
    case InjectionMethod::kCompute:
      break;
  }
  return compute_;
}

void Voxelizer::bind(const Run& run) {
  run.accumulators.bindStorage(layout::kAccumulators);
  if (run.voxels.tree != nullptr) {
    run.field.vplList.bindStorage(layout::kVoxelCells);
    run.voxels.tree->nodes.bindStorage(layout::kTreeNodes);
  } else {
    run.voxels.cells.bindStorage(layout::kVoxelCells);
    run.voxels.moments.bindStorage(layout::kVoxelMoments);
  }
  run.mesh.positionTexels->bind(layout::kPositions);
  const bool merges = run.voxels.source.merges();
  (merges ? run.mesh.mergedTexels : run.mesh.triangleTexels)->bind(layout::kTriangles);
  if (run.voxels.source.directed()) run.mesh.directions->bindStorage(layout::kDirections);
  params_.bindUniform(layout::kParams);
  if (run.texture == nullptr) return;
  run.mesh.uvs->bindStorage(layout::kUvs);
  run.texture->radiance.bind(layout::kLightTexture);
  run.texture->rowIntegrals.bindStorage(layout::kRowIntegrals);
  run.texture->rowMoments.bindStorage(layout::kRowMoments);
}

void Voxelizer::collect(const Run& run) {
  bind(run);
  params_.update(0, gpu::bytesOfValue(run.job.params));
  run.voxels.cells.bindAsDispatchArguments();
  collect_.get(run.job.variant).dispatchIndirect(0);
  gpu::memoryBarrier();
}

GpuTask Voxelizer::deposit(Run& run) {
  TriangleVoxelizer& voxelizer = voxelizerFor(run.voxels.source.method.method);
  const auto triangles = std::uint32_t(run.voxels.source.triangles().size());
  for (std::uint32_t first = 0; first < triangles;) {
    const std::uint32_t end = first + std::min(voxelizer.limit(run.job), triangles - first);
    const Batch batch = nextBatch(run.costs, first, end, run.pacing.unitsFor(Stage::kVoxelize));
    run.job.params.firstTriangle = first;
    run.job.params.triangleCount = batch.count;
    params_.update(0, gpu::bytesOfValue(run.job.params));
    bind(run);
    voxelizer.dispatch(run.job);
    first += batch.count;
    co_yield submitted(Stage::kVoxelize, batch.units);
  }
}

/// Again with a larger table while VPLs found no room in it.
GpuTask Voxelizer::buildVplTree(Run& run) {
  VplTree& tree = *run.voxels.tree;
  layout::VoxelizeParams& params = run.job.params;
  const gpu::Defines variant = treeVariantOf(run.voxels.source);
  const std::function<void()> bindLight = [&] { bind(run); };
  params.boxLower = tree.box.lower;
  params.boxSize = tree.box.upper - tree.box.lower;
  for (std::uint32_t entries = entriesFor(run.voxels, run.voxels.areaScale);; entries *= 2) {
    params.tableEntries = entries;
    co_await makeZeros("VPL table", entries * vplWords(run.voxels.source) * sizeof(std::uint32_t), run.accumulators);
    makeList(run.field, entries);
    run.field.vplList.update(0, gpu::bytesOfValue(kEmptyList));
    co_await trees_.prepare(tree);
    co_await deposit(run);
    co_await trees_.count(tree, variant, bindLight);
    run.field.vplHeader.copyFrom(run.field.vplList, 0, 0, sizeof kEmptyList);
    const gpu::Fence counted = gpu::Fence::insert();
    co_yield submitted(Stage::kVoxelize, 0.0);
    co_yield waitFor(counted);
    const VplCounts counts = VplTreeBuilder::read(run.field.vplHeader);
    if (counts.lost == 0) {
      const VoxelizeInputs& source = run.voxels.source;
      const TreeScales scales = {run.voxels.areaScale, params.momentUnits, source.origin, source.cell};
      co_await trees_.build(tree, counts, variant, scales, bindLight);
      co_yield submitted(Stage::kVoxelize, 0.0);
      co_return;
    }
    co_await fillChunked(run.accumulators);
  }
}

/// Into a list of cells, or a tree of VPLs.
GpuTask Voxelizer::voxelize(Run& run) {
  if (run.voxels.tree != nullptr) {
    co_await buildVplTree(run);
    co_return;
  }
  const std::size_t words = run.field.grid.cells() * accumulatorWords(run.voxels.source);
  co_await makeZeros("accumulators", words * sizeof(std::uint32_t), run.accumulators);
  run.voxels.cells.update(0, gpu::bytesOfValue(kEmptyList));
  co_await deposit(run);
  collect(run);
  co_yield submitted(Stage::kVoxelize, 0.0);
}

GpuTask Voxelizer::run(LightField& field, const GpuMesh& mesh, const GpuLightTexture* texture, LightVoxels& voxels,
                       Pacing pacing) {
  Run run{field, std::exchange(field.accumulators, {}), mesh, texture, voxels, {}, jobOf(voxels, texture), pacing};
  co_await estimateCosts(voxels.source, run.job.params.areaFromObject, run.costs);
  chooseScales(run.job.params, run.costs.area, voxels);
  co_await voxelize(run);
  field.accumulators = std::move(run.accumulators);
}

}  // namespace lpv
