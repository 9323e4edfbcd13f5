#include "lpv/voxelize.h"

#include <algorithm>
#include <cmath>

#include "shaders/layout.h"

namespace lpv {

namespace {

/// Triangles of the first piece, while nothing is known of their size.
constexpr double kFirstTriangles = 1024.0;
const layout::uvec4 kEmptyList(0, 1, 1, 0);

/// The linear map that takes the cross product of two object-space edges to that of the transformed edges (the cofactor
/// matrix), turned over for mirrors: the object-space outer side in grid space.
glm::dmat4 outwardFromObject(const glm::dmat4& gridFromObject) {
  const glm::dvec3 a(gridFromObject[0]), b(gridFromObject[1]), c(gridFromObject[2]);
  const double side = glm::dot(a, glm::cross(b, c)) < 0.0 ? -1.0 : 1.0;
  return {glm::dvec4(side * glm::cross(b, c), 0.0), glm::dvec4(side * glm::cross(c, a), 0.0),
          glm::dvec4(side * glm::cross(a, b), 0.0), glm::dvec4(0.0)};
}

layout::VoxelizeParams paramsOf(const LightField& field, const EmittingLight& light, const glm::dvec3& weight,
                                int shift) {
  layout::VoxelizeParams params{};
  params.gridFromObject = light.gridFromObject;
  params.outwardFromObject = outwardFromObject(light.gridFromObject);
  params.dims = glm::ivec4(field.grid.dims, 0);
  params.weight = glm::vec4(weight * std::ldexp(1.0, shift), 0.0);
  return params;
}

}  // namespace

Voxelizer::Voxelizer()
    : params_("voxelize params", sizeof(layout::VoxelizeParams), gpu::BufferUse::kDynamic),
      large_("large triangles",
             std::size_t(layout::kListHeaderWords + layout::kMaxPieceTriangles * layout::kMaxSlices) *
                 sizeof(std::uint32_t),
             gpu::BufferUse::kDynamic) {}

void Voxelizer::begin(LightField& field) {
  field.current = 1 - field.current;
  field.touched[std::size_t(field.current)].update(0, gpu::bytesOfValue(kEmptyList));
  field.counters.update(0, gpu::bytesOfValue(layout::Counters{}));
}

void Voxelizer::dispatch(LightField& field, const GpuMesh& mesh, std::uint32_t triangles, bool twoSided) {
  mesh.positions->bindStorage(layout::kPositions);
  mesh.triangles->bindStorage(layout::kTriangles);
  field.accumulators.bindStorage(layout::kAccumulators);
  field.touched[std::size_t(field.current)].bindStorage(layout::kTouchedCells);
  field.counters.bindStorage(layout::kCounters);
  large_.bindStorage(layout::kLargeTriangles);
  large_.bindAsDispatchArguments();
  params_.bindUniform(layout::kParams);
  const gpu::Defines variant = {{"LPV_CHANNELS", std::to_string(field.channels)},
                                {"LPV_TWO_SIDED", twoSided ? "1" : "0"}};
  gpu::Defines pass = variant;
  pass.emplace_back("LPV_SMALL", "1");
  programs_.get(pass).dispatch((triangles + std::uint32_t(layout::kVoxelizeGroup) - 1) /
                               std::uint32_t(layout::kVoxelizeGroup));
  gpu::memoryBarrier();
  pass.back() = {"LPV_LARGE", "1"};
  programs_.get(pass).dispatchIndirect(0);
  gpu::memoryBarrier();
}

Pieces Voxelizer::add(LightField& field, const EmittingLight& light, const GpuMesh& mesh, const glm::dvec3& weight,
                      const FixedPoint& fixedPoint, Pacing pacing) {
  layout::VoxelizeParams params = paramsOf(field, light, weight, fixedPoint.shift);
  for (std::uint32_t first = 0; first < mesh.triangleCount;) {
    const int wanted = std::min(pacing.unitsFor(Stage::kVoxelize, kFirstTriangles), layout::kMaxPieceTriangles);
    const std::uint32_t count = std::min(std::uint32_t(wanted), mesh.triangleCount - first);
    params.triangles = glm::uvec4(first, count, 0, 0);
    params_.update(0, gpu::bytesOfValue(params));
    large_.update(0, gpu::bytesOfValue(kEmptyList));
    dispatch(field, mesh, count, light.twoSided);
    first += count;
    co_yield piece(Stage::kVoxelize, double(count));
  }
}

}  // namespace lpv
