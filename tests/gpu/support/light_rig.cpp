#include "gpu/support/light_rig.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
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

MeshPtr tangle(bool varying) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-0.9F, 0.9F);
  Mesh mesh;
  for (std::uint32_t i = 0; i < 36; ++i) {
    const float x = place(random), y = place(random), z = place(random);
    mesh.positions.emplace_back(x, y, z);
    if (varying) {
      mesh.directions.emplace_back(z + 1.0F, x, y);
      mesh.uvs.emplace_back(y, z);
    }
    if (i % 3 == 0) mesh.triangles.emplace_back(i, i + 1, i + 2);
  }
  EXPECT_TRUE(finishMesh(mesh).ok());
  return std::make_shared<const Mesh>(mesh);
}

std::vector<glm::dmat3> cubeSymmetries() {
  std::vector<glm::dmat3> out;
  std::array<int, 3> axes = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      glm::dmat3 m(0.0);
      for (int k = 0; k < 3; ++k) m[k][axes[std::size_t(k)]] = (signs >> k & 1) != 0 ? -1.0 : 1.0;
      out.push_back(m);
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  return out;
}

reference::Field turned(const reference::Field& field, const glm::dmat3& symmetry) {
  reference::Field out(field.dims);
  const glm::dvec3 middle = 0.5 * glm::dvec3(field.dims);
  reference::forEachCell(field.dims, [&](const glm::ivec3& cell) {
    const glm::ivec3 to(glm::floor(symmetry * (glm::dvec3(cell) + 0.5 - middle) + middle));
    for (std::size_t c = 0; c < 3; ++c) {
      const reference::Coefficients& l = field.at(cell)[c];
      const glm::dvec3 d = symmetry * glm::dvec3(l.w, l.y, l.z);
      out.at(to)[c] = {l.x, d.y, d.z, d.x};
    }
  });
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
  const double radianceScale = brightestCell(want);
  return radianceScale > 0.0 ? reference::largestDifference(got, want) / radianceScale : HUGE_VAL;
}

VoxelMap voxelsOf(const LightVoxels& voxels) {
  const std::vector<std::uint32_t> list = read<std::uint32_t>(voxels.cells);
  const std::vector<glm::vec4> moments = read<glm::vec4>(voxels.moments);
  VoxelMap cells;
  layout::VoxelHeader header{};
  std::memcpy(&header, list.data(), sizeof header);
  for (std::size_t i = 0; i < header.count; ++i) {
    const std::size_t entry = sizeof header / sizeof(std::uint32_t) + 2 * i;
    const auto first = moments.begin() + std::ptrdiff_t(i) * voxels.momentsPerCell;
    const bool fresh =
        cells.emplace(list[entry], std::pair(list[entry + 1], std::vector(first, first + voxels.momentsPerCell)))
            .second;
    EXPECT_TRUE(fresh) << "cell " << list[entry] << " is listed twice";
  }
  return cells;
}

}  // namespace lpv::test
