#include "lpv/frame/haze.h"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include "gpu/gl.h"
#include "lpv/frame/near_field.h"
#include "lpv/frame/parts.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

gpu::Texture hazePicture(const char* label, const glm::ivec2& size) {
  return gpu::Texture::make2d(label, size, GL_RGBA32F, gpu::Sampling::kNearestClamp);
}

/// What a turn of a tile takes: a candidate about as much as a shaded pixel.
constexpr double kPixelsOfTile = double(kTile.x) * kTile.y;
constexpr double kHazeTurnUnits = NearFieldWork{.weighed = kPixelsOfTile * layout::kHazeRays * layout::kHazeCandidates,
                                                .rays = kPixelsOfTile * layout::kHazeRays}
                                      .units();

/// About what each light may scatter from somewhere in the grid, which is what it is looked at for.
double worthOf(const layout::HazeLight& light, const glm::dvec3& dims) {
  const glm::dvec3 from = glm::dvec3(light.sphere) - 0.5 * dims;
  return double(light.power) / (glm::dot(from, from) + 0.25 * glm::dot(dims, dims));
}

layout::HazeLight hazeLight(const EmittingLight& light, const LightPool& range) {
  const Bounds box = light.mesh->bounds.transformed(light.gridFromObject);
  const double radius = range.distant ? 0.0 : 0.5 * glm::length(box.extent());
  layout::HazeLight out{};
  out.sphere = glm::vec4(glm::vec3(box.centre()), float(radius));
  out.firstPoint = range.firstPoint;
  out.points = range.points;
  out.pointArea = range.distant ? 0.0F : float(range.area / std::max(range.points, 1));
  out.power = float(range.power);
  return out;
}

std::vector<layout::HazeLight> hazeLights(const HazeSources& sources) {
  const glm::dvec3 dims(sources.dims);
  std::vector<layout::HazeLight> out;
  double all = 0.0, before = 0.0;
  for (std::size_t i = 0; i < sources.lights.size(); ++i)
    all += worthOf(out.emplace_back(hazeLight(sources.lights[i], sources.pools.ranges[i])), dims);
  for (layout::HazeLight& light : out) {
    const double worth = light.points > 0 ? worthOf(light, dims) / std::max(all, 1e-300) : 0.0;
    light.end = float(before += worth);
    light.share = float(worth);
  }
  return out;
}

/// Patches are of about one size: each as often.
std::vector<layout::HazeLight> hazeLights(const PatchSet& patches) {
  layout::HazeLight all{};
  all.points = patches.count;
  all.end = all.share = 1.0F;
  return {all};
}

}  // namespace

HazeBuffer::HazeBuffer(const glm::ivec2& s)
    : size(s), sum(hazePicture("haze, all rays", s)), scattered(hazePicture("haze", s)) {}

struct HazePass::Picture {
  const HazeBuffer& buffer;
  const Gbuffer& gbuffer;
  const EmitterBuffer& seenLights;
  const HazeSources& sources;
  const gpu::Buffer& frameParams;

  void bind() const {
    frameParams.bindUniform(layout::kParams);
    gbuffer.depth.bind(layout::kSurfaceDepth);
    seenLights.depth.bind(layout::kEmitterDepth);
  }
};

HazePass::HazePass() : params_("haze params", sizeof(layout::HazeParams), gpu::BufferUse::kDynamic) {}

/// All turns of rays to the points of a list, added to the sums; those to lights begin anew.
GpuTask HazePass::look(const Picture& picture, const gpu::BufferTexture& points, std::vector<layout::HazeLight> lights,
                       bool ofSurfaces, Pacing pacing) {
  const HazeSources& sources = picture.sources;
  const auto isMesh = [](const LightPool& range) { return !range.distant && range.points > int(kPointsOfFewPolygons); };
  const Variant variant = {sources.panes, !ofSurfaces && std::ranges::any_of(sources.pools.ranges, isMesh)};
  const std::size_t bytes = std::bit_ceil(lights.size() * sizeof(layout::HazeLight));
  if (lights_.size() < bytes) {
    lights_ = {};  // first the old memory, then the new
    lights_ = gpu::Buffer("lights in haze", bytes, gpu::BufferUse::kDynamic, gpu::Undefined{});
  }
  layout::HazeParams params{};
  params.turns = sources.turns;
  params.ofSurfaces = ofSurfaces ? 1 : 0;
  params.firstRow = sources.firstRow;
  params.lights = int(lights.size());
  params.scattering = float(sources.scattering);
  params.anisotropy = float(sources.anisotropy);
  const glm::ivec2 tiles = partsOf(picture.buffer.size, kTile);
  const int count = tiles.x * tiles.y;
  for (params.turn = 0; params.turn < sources.turns; ++params.turn) {
    params.firstTurn = !ofSurfaces && params.turn == 0 ? 1 : 0;
    for (params.first = 0; params.first < count;) {
      const int some = std::clamp(int(pacing.unitsFor(Stage::kShade) / kHazeTurnUnits), 1, count - params.first);
      params_.update(0, gpu::bytesOfValue(params));
      params_.bindUniform(layout::kHazeParams);
      lights_.update(0, gpu::bytesOf(std::span<const layout::HazeLight>(lights)));
      lights_.bindStorage(layout::kHazeLights);
      picture.bind();
      points.bind(layout::kLightPoints);
      sources.occluders.bind();
      sources.shown.bind();
      sources.emitters.view.bind(layout::kDirect);
      picture.buffer.sum.bindImage(layout::kHazeSumOut, GL_READ_WRITE);
      rays_.get(variant).dispatch(std::uint32_t(some));
      gpu::memoryBarrier();
      params.first += some;
      co_yield submitted(Stage::kShade, some * kHazeTurnUnits);
    }
  }
}

GpuTask HazePass::run(HazeBuffer& buffer, const Gbuffer& gbuffer, const EmitterBuffer& seenLights,
                      const HazeSources& sources, const gpu::Buffer& frameParams, Pacing pacing) {
  const Picture picture = {buffer, gbuffer, seenLights, sources, frameParams};
  std::vector<layout::HazeLight> lights = hazeLights(sources);
  co_await look(picture, sources.pools.view, std::move(lights), false, pacing);
  if (sources.reflected != nullptr) {
    std::vector<layout::HazeLight> patches = hazeLights(*sources.reflected);
    co_await look(picture, sources.reflected->lightTexels, std::move(patches), true, pacing);
  }
  layout::HazeParams params{};
  params.turns = sources.turns;
  params_.update(0, gpu::bytesOfValue(params));
  params_.bindUniform(layout::kHazeParams);
  picture.bind();
  buffer.sum.bind(layout::kHazeSum);
  buffer.scattered.bindImage(layout::kHazeOut, GL_WRITE_ONLY);
  const glm::ivec2 tiles = partsOf(buffer.size, kTile);
  filter_.get({}).dispatch(std::uint32_t(tiles.x), std::uint32_t(tiles.y));
  gpu::memoryBarrier();
  co_yield submitted(Stage::kShade, 10.0 * buffer.size.x * buffer.size.y);
}

}  // namespace lpv
