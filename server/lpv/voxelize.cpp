#include "lpv/voxelize.h"

#include <algorithm>
#include <cmath>

#include "gpu/failure.h"
#include "gpu/gl.h"

namespace lpv {

namespace {

/// Triangles of the first piece, while nothing is known of their size.
constexpr double kFirstTriangles = 1024.0;

/// The linear map that takes the cross product of two object-space edges to that of the transformed edges (the cofactor
/// matrix), turned over for mirrors: the object-space outer side in grid space.
glm::dmat4 outwardFromObject(const glm::dmat4& gridFromObject) {
  const glm::dvec3 a(gridFromObject[0]), b(gridFromObject[1]), c(gridFromObject[2]);
  const double side = glm::dot(a, glm::cross(b, c)) < 0.0 ? -1.0 : 1.0;
  return {glm::dvec4(side * glm::cross(b, c), 0.0), glm::dvec4(side * glm::cross(c, a), 0.0),
          glm::dvec4(side * glm::cross(a, b), 0.0), glm::dvec4(0.0)};
}

/// Words of a cell, as shaders/deposit.glsl has them.
std::size_t accumulatorWords(const VoxelSource& source) {
  const bool flux = source.method.injection == Injection::kFlux;
  if (flux) return source.textured() ? 25 : 9;
  return source.textured() ? 13 : 4;
}

/// Lobes one triangle can put into one cell: a direction per vertex spreads them over at most 180 degrees each way.
std::uint64_t lobesPerTriangle(const VoxelSource& source) {
  if (source.method.method == InjectionMethod::kDense) return std::uint64_t(source.method.denseSamples);
  return source.directed() ? 9 : 1;
}

gpu::Defines variantOf(const VoxelSource& source) {
  const bool flux = source.method.injection == Injection::kFlux;
  return {{"LPV_FLUX", flux ? "1" : "0"},
          {"LPV_TEXTURED", source.textured() ? "1" : "0"},
          {"LPV_DIRECTIONS", source.directed() ? "1" : "0"}};
}

/// Area of all triangles in the grid's unit, cell^2: what the largest moment can be.
double gridArea(const Mesh& mesh, const glm::dmat4& areaFromObject) {
  const glm::dmat3 map(areaFromObject);
  double area = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 p(mesh.positions[t.x]), q(mesh.positions[t.y]), r(mesh.positions[t.z]);
    area += glm::length(map * glm::cross(q - p, r - p));
  }
  return area;
}

/// Scales of a light's fixed point, into `params` and `voxels`.
void chooseScales(layout::VoxelizeParams& params, LightVoxels& voxels) {
  const VoxelSource& source = voxels.source;
  const double triangles = double(source.mesh->triangles.size());
  if (source.method.injection == Injection::kFlux) {
    const double area = gridArea(*source.mesh, params.areaFromObject);
    // A little more than the sum, for its rounding. A light without area has nothing to scale.
    voxels.unit = area > 0.0 ? area * (1.0 + 1e-9) : 1.0;
    params.areaFromObject /= voxels.unit;
    params.scale.x = std::ldexp(1.0, layout::kFluxBits);
    voxels.roundingError = 0.5 * triangles / params.scale.x;
    return;
  }
  const Expected<FixedPoint> fixedPoint = fixedPointFor(std::uint64_t(triangles) * lobesPerTriangle(source));
  if (!fixedPoint.ok()) throw gpu::Failure(fixedPoint.status());
  voxels.unit = 1.0;
  params.scale.x = std::ldexp(1.0, fixedPoint->shift);
  voxels.roundingError = fixedPoint->error;
}

VoxelizeJob jobOf(LightVoxels& voxels, const GpuLightTexture* texture) {
  const VoxelSource& source = voxels.source;
  VoxelizeJob job;
  job.variant = variantOf(source);
  job.varying = source.textured() || source.directed();
  job.params.gridFromObject = source.gridFromObject;
  job.params.areaFromObject = 0.5 * outwardFromObject(source.gridFromObject);
  job.params.dims = glm::ivec4(source.dims, 0);
  const auto samples = std::uint32_t(source.method.denseSamples);
  job.params.triangles.z = samples;
  job.params.triangles.w = (samples + std::uint32_t(layout::kSamplesPerThread) - 1) / layout::kSamplesPerThread;
  voxels.brightest = texture != nullptr ? texture->brightest : 1.0;
  job.params.scale.y = 1.0 / voxels.brightest;
  if (texture != nullptr) {
    job.params.texture = glm::ivec4(texture->size, texture->levels, 0);
    job.params.textureMean = glm::vec4(texture->mean / texture->brightest, 0.0);
  }
  chooseScales(job.params, voxels);
  return job;
}

}  // namespace

Voxelizer::Voxelizer() : params_("voxelize params", sizeof(layout::VoxelizeParams), gpu::BufferUse::kDynamic) {}

TriangleInjector& Voxelizer::injectorFor(InjectionMethod method) {
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

void Voxelizer::bind(LightField& field, const GpuMesh& mesh, const GpuLightTexture* texture,
                     const LightVoxels& voxels) {
  const std::size_t bytes = field.grid.cells() * accumulatorWords(voxels.source) * sizeof(std::uint32_t);
  if (field.accumulators.size() < bytes) {
    field.accumulators = {};  // first the old memory, then the new
    field.accumulators = gpu::Buffer("accumulators", bytes);
  }
  field.accumulators.bindStorage(layout::kAccumulators);
  voxels.cells.bindStorage(layout::kVoxelCells);
  voxels.moments.bindStorage(layout::kVoxelMoments);
  mesh.positionTexels->bind(layout::kPositions);
  mesh.triangleTexels->bind(layout::kTriangles);
  if (voxels.source.directed()) mesh.directions->bindStorage(layout::kDirections);
  params_.bindUniform(layout::kParams);
  if (texture == nullptr) return;
  mesh.uvs->bindStorage(layout::kUvs);
  texture->radiance.bind(layout::kLightTexture);
  texture->rowIntegrals.bindStorage(layout::kRowIntegrals);
}

void Voxelizer::collect(const VoxelizeJob& job, const LightVoxels& voxels) {
  voxels.cells.bindAsDispatchArguments();
  collect_.get(job.variant).dispatchIndirect(0);
  gpu::memoryBarrier();
}

Pieces Voxelizer::run(LightField& field, const GpuMesh& mesh, const GpuLightTexture* texture, LightVoxels& voxels,
                      Pacing pacing) {
  constexpr std::array<std::uint32_t, layout::kVoxelHeaderWords> kEmpty = {1, 1, 1};
  voxels.cells.update(0, gpu::bytesOfValue(kEmpty));
  VoxelizeJob job = jobOf(voxels, texture);
  TriangleInjector& injector = injectorFor(voxels.source.method.method);
  for (std::uint32_t first = 0; first < mesh.triangleCount;) {
    const auto wanted = std::uint32_t(pacing.unitsFor(Stage::kVoxelize, kFirstTriangles));
    const std::uint32_t count = std::min({wanted, injector.limit(job), mesh.triangleCount - first});
    job.params.triangles.x = first;
    job.params.triangles.y = count;
    params_.update(0, gpu::bytesOfValue(job.params));
    bind(field, mesh, texture, voxels);
    injector.dispatch(job);
    first += count;
    if (first == mesh.triangleCount) collect(job, voxels);
    co_yield piece(Stage::kVoxelize, double(count));
  }
}

}  // namespace lpv
