#include "gpu/support/stage_rig.h"

#include <random>
#include <stdexcept>

#include "lpv/pacing/stage_clock.h"

namespace lpv::test {

namespace {

int haloIndex(const glm::ivec3& cell, const glm::ivec3& dims, int channel) {
  const glm::ivec3 h = dims + 2;
  return ((channel * h.z + cell.z + 1) * h.y + cell.y + 1) * h.x + cell.x + 1;
}

}  // namespace

void finish(GpuTask task) { task.runToEnd(); }

MeshPtr meshOf(const std::vector<std::array<glm::vec3, 3>>& triangles) {
  Mesh mesh;
  for (const auto& triangle : triangles) {
    const auto first = std::uint32_t(mesh.positions.size());
    for (const glm::vec3& p : triangle) mesh.positions.push_back(p);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  const Status status = finishMesh(mesh);
  if (!status.ok()) throw std::invalid_argument(status.message());
  return std::make_shared<Mesh>(std::move(mesh));
}

EmittingLight lightOf(const MeshPtr& mesh, const glm::dvec3& radiance, bool twoSided) {
  EmittingLight light;
  light.mesh = mesh;
  light.radiance = radiance;
  light.twoSided = twoSided;
  return light;
}

Grid unitGrid(const glm::ivec3& dims) { return {glm::dvec3(0.0), 1.0, dims}; }

SceneResources upload(SceneCache& cache, const std::vector<EmittingLight>& lights) {
  Scene scene;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    auto light = std::make_shared<Light>();
    light->mesh = lights[i].mesh;
    light->texture = lights[i].texture;
    scene.lights["light " + std::to_string(i)] = light;
  }
  SceneResources resources;
  finish(cache.upload(scene, resources));
  return resources;
}

reference::Field fieldOf(const FieldBuffer& buffer, const LightField& field, const Palette& palette, int group) {
  const std::vector<glm::vec4> values = read<glm::vec4>(buffer.buffer);
  const glm::ivec3 dims = field.grid.dims;
  reference::Field out(dims);
  reference::forEachCell(dims, [&](const glm::ivec3& cell) {
    for (int k = 0; k < field.channels; ++k) {
      const glm::dvec4 value(values[std::size_t(haloIndex(cell, dims, group * field.channels + k))]);
      for (int c = 0; c < 3; ++c) out.at(cell)[std::size_t(c)] += value * palette.radiance[std::size_t(k)][c];
    }
  });
  return out;
}

std::vector<glm::vec4> haloOf(const reference::Field& field) {
  const glm::ivec3 h = field.dims + 2;
  std::vector<glm::vec4> out(std::size_t(3 * h.x * h.y * h.z), glm::vec4(0.0F));
  reference::forEachCell(field.dims, [&](const glm::ivec3& cell) {
    for (int k = 0; k < 3; ++k)
      out[std::size_t(haloIndex(cell, field.dims, k))] = glm::vec4(field.at(cell)[std::size_t(k)]);
  });
  return out;
}

reference::Field randomField(const glm::ivec3& dims, std::uint32_t seed, int margin) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  reference::Field field(dims);
  reference::forEachCell(dims, [&](const glm::ivec3& cell) {
    const bool inside =
        glm::all(glm::greaterThanEqual(cell, glm::ivec3(margin))) && glm::all(glm::lessThan(cell, dims - margin));
    for (auto& c : field.at(cell)) {
      if (inside)
        c = {double(2.0F + uniform(random)), double(uniform(random)), double(uniform(random)), double(uniform(random))};
    }
  });
  return field;
}

InjectRig::InjectRig(const Grid& grid, std::vector<EmittingLight> l, const VoxelMethod& m)
    : lights(std::move(l)), method(m), palette(choosePalette(lights)), field(grid, palette.channels) {
  run();
}

void InjectRig::run() {
  const SceneResources resources = upload(cache_, lights);
  StageClock clock;
  finish(injector_.retire(field, {&clock}));
  voxels.clear();
  for (const EmittingLight& light : lights) {
    const GpuLightTexture* texture = light.texture ? resources.lightTextures.at(light.texture).get() : nullptr;
    voxels.push_back(
        std::make_shared<LightVoxels>(cellsAround({light}, field.grid.dims), light.texture == nullptr ? 1 : 3));
    voxels.back()->source = {light.mesh, light.texture, light.gridFromObject, field.grid.dims, method};
    finish(voxelizer_.run(field, *resources.meshes.at(light.mesh), texture, *voxels.back(), {&clock}));
  }
  finish(injector_.add(field, lights, voxels, palette, {&clock}));
}

void InjectRig::runWith(std::vector<EmittingLight> others, const VoxelMethod& m) {
  lights = std::move(others);
  method = m;
  palette = choosePalette(lights);
  if (palette.channels > field.channels) throw std::invalid_argument("more channels than the rig was made for");
  run();
}

double InjectRig::roundingError() const {
  double error = 0.0;
  for (const LightVoxelsPtr& light : voxels) error = std::max(error, light->roundingError);
  return error;
}

std::uint32_t InjectRig::touched() const { return read<layout::Counters>(field.counters)[0].touched; }

}  // namespace lpv::test
