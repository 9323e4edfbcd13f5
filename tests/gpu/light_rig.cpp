#include "gpu/light_rig.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <stdexcept>

#include "reference/compare.h"
#include "reference/meshes.h"
#include "reference/mipmap.h"

namespace lpv::test {

std::unique_ptr<InjectRig> LightTest::rig_;

void LightTest::TearDownTestSuite() { rig_.reset(); }

const InjectRig& LightTest::injected(const Grid& grid, const std::vector<EmittingLight>& lights,
                                     const VoxelMethod& method) {
  if (!rig_ || rig_->field.grid != grid) {
    const MeshPtr any = reference::quad();
    rig_ = std::make_unique<InjectRig>(
        grid, std::vector{lightOf(any, {1, 0, 0}), lightOf(any, {0, 1, 0}), lightOf(any, {0, 0, 1})}, method);
  }
  rig_->runWith(lights, method);
  return *rig_;
}

glm::dmat4 poseOf(const glm::dvec3& at, const glm::dvec3& scale, double angle, const glm::dvec3& axis) {
  return glm::translate(glm::dmat4(1.0), at) * glm::rotate(glm::dmat4(1.0), angle, glm::normalize(axis)) *
         glm::scale(glm::dmat4(1.0), scale);
}

EmittingLight placed(const MeshPtr& mesh, const glm::dmat4& gridFromObject, const glm::dvec3& radiance, bool twoSided,
                     const TexturePtr& texture) {
  EmittingLight light = lightOf(mesh, radiance, twoSided);
  light.gridFromObject = gridFromObject;
  light.mirrored = glm::determinant(glm::dmat3(gridFromObject)) < 0.0;
  light.texture = texture;
  return light;
}

MeshPtr withAttributes(const MeshPtr& mesh, const UvOf& uvOf, const DirectionOf& directionOf) {
  auto out = std::make_shared<Mesh>(*mesh);
  out->uvs.resize(mesh->positions.size());
  if (directionOf) out->directions.resize(mesh->positions.size());
  for (std::size_t i = 0; i < mesh->positions.size(); ++i) {
    if (uvOf) out->uvs[i] = uvOf(mesh->positions[i], out->uvs[i]);
    if (directionOf) out->directions[i] = directionOf(mesh->positions[i]);
  }
  const Status status = finishMesh(*out);
  if (!status.ok()) throw std::invalid_argument(status.message());
  return out;
}

std::vector<reference::Emitter> emittersOf(const Grid& grid, const std::vector<EmittingLight>& lights) {
  const glm::dmat4 worldFromGrid = glm::scale(glm::translate(glm::dmat4(1.0), grid.origin), glm::dvec3(grid.cell));
  std::map<TexturePtr, reference::MipChainPtr> chains;
  std::vector<reference::Emitter> out;
  for (const EmittingLight& light : lights) {
    reference::MipChainPtr& chain = chains[light.texture];
    if (light.texture && !chain)
      chain = std::make_shared<const reference::MipChain>(reference::mipChainOf(*light.texture));
    const reference::Emitters e = reference::emittersOf(grid, *light.mesh, worldFromGrid * light.gridFromObject,
                                                        light.radiance, light.twoSided, chain);
    out.insert(out.end(), e.triangles.begin(), e.triangles.end());
  }
  return out;
}

reference::Field injectedOf(const InjectRig& rig) { return fieldOf(rig.field.injected, rig.field, rig.palette); }

double brightestCell(const reference::Field& field) {
  double most = 0.0;
  for (const auto& cell : field.cells) {
    for (const reference::Coefficients& c : cell) most = std::max(most, c.x);
  }
  return most;
}

double relativeError(const reference::Field& got, const reference::Field& want) {
  for (const auto& cell : got.cells) {
    for (const reference::Coefficients& c : cell) {
      if (!(glm::dot(c, c) < HUGE_VAL)) return HUGE_VAL;  // NaN too
    }
  }
  const double brightest = brightestCell(want);
  return brightest > 0.0 ? reference::largestDifference(got, want) / brightest : HUGE_VAL;
}

VoxelMap voxelsOf(const LightVoxels& voxels) {
  const std::vector<std::uint32_t> list = read<std::uint32_t>(voxels.cells);
  const std::vector<glm::vec4> moments = read<glm::vec4>(voxels.moments);
  VoxelMap cells;
  for (std::size_t i = 0; i < list[3]; ++i) {
    const std::size_t entry = std::size_t(layout::kVoxelHeaderWords) + 2 * i;
    const auto first = moments.begin() + std::ptrdiff_t(i) * voxels.sets;
    const bool fresh =
        cells.emplace(list[entry], std::pair(list[entry + 1], std::vector(first, first + voxels.sets))).second;
    EXPECT_TRUE(fresh) << "cell " << list[entry] << " is listed twice";
  }
  return cells;
}

}  // namespace lpv::test
