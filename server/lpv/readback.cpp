#include "lpv/readback.h"

#include <algorithm>
#include <cstring>

#include "gpu/gl.h"
#include "lpv/pacing/chunked.h"

namespace lpv {

namespace {

/// Where the exposure follows a frame's pixels.
std::size_t exposureOffset(std::size_t pixelBytes) { return (pixelBytes + 15) / 16 * 16; }

/// Appends a part of what is at `from` to values that have room for them: memory that is new is touched
/// only here.
template <typename T>
void append(std::vector<T>& values, const std::byte* from, const Chunk& part) {
  const T* first = reinterpret_cast<const T*>(from + part.offset);
  values.insert(values.end(), first, first + part.bytes / sizeof(T));
}

/// The grid without its guard.
Grid productOf(const LightField& field) {
  Grid grid = field.grid;
  grid.origin += double(field.guard) * grid.cell;
  grid.dims -= 2 * field.guard;
  return grid;
}

/// Runs of cells in memory, in units of cells, that hold `box`.
std::vector<Chunk> runsOf(const Grid& grid, const CellBox& box) {
  if (box.lower == glm::ivec3(0) && box.upper == grid.dims) return {{0, grid.cells()}};
  std::vector<Chunk> runs;
  for (int z = box.lower.z; z < box.upper.z; ++z) {
    for (int y = box.lower.y; y < box.upper.y; ++y)
      runs.push_back({grid.index({box.lower.x, y, z}), std::size_t(box.upper.x - box.lower.x)});
  }
  return runs;
}

/// One layer's cells of `box`: appended, or with `onto` added to what is there.
GpuTask takeLayer(const std::byte* from, const LightField& field, CellBox box, bool onto, std::vector<float>& out) {
  constexpr std::size_t kCellBytes = layout::kVolumeFloats * sizeof(float);
  std::size_t taken = 0, at = 0;
  for (const Chunk& run : runsOf(field.grid, box)) {
    for (const Chunk& part : chunksOf(run.bytes * kCellBytes)) {
      if (onto) {
        const float* first = reinterpret_cast<const float*>(from + run.offset * kCellBytes + part.offset);
        for (std::size_t i = 0; i < part.bytes / sizeof(float); ++i) out[at++] += first[i];
      } else {
        append(out, from + run.offset * kCellBytes, part);
      }
      taken += part.bytes;
      if (taken < kChunkBytes) continue;
      taken = 0;
      co_yield yield();
    }
  }
  co_yield yield();
}

/// The cells of `box`, layer by layer, all light in them.
GpuTask takeLayers(const gpu::Readback& readback, const LightField& field, CellBox box,
                   const std::vector<std::string>& groups, Volume& out) {
  const std::size_t layerBytes = field.grid.cells() * layout::kVolumeFloats * sizeof(float);
  const std::byte* from = readback.bytes().data();
  const std::byte* apart = from + std::size_t(field.lookedUpGroups()) * layerBytes;
  for (const std::string& group : groups) {
    VolumeLayer& layer = out.layers.emplace_back();
    layer.group = group;
    layer.coefficients.reserve(out.grid.cells() * layout::kVolumeFloats);
    co_await takeLayer(from, field, box, false, layer.coefficients);
    from += layerBytes;
    if (field.apart == 0) continue;
    out.lookedUp.push_back(layer);
    co_await takeLayer(apart, field, box, true, layer.coefficients);
    apart += layerBytes;
  }
}

/// Guard cells that are as the cells beside them.
GpuTask repeatOutermost(const Volume& volume, Volume& out) {
  for (const VolumeLayer& layer : volume.layers) {
    VolumeLayer& more = out.layers.emplace_back();
    more.group = layer.group;
    more.coefficients.reserve(out.grid.cells() * layout::kVolumeFloats);
    for (int z = 0; z < out.grid.dims.z; ++z) {
      for (int y = 0; y < out.grid.dims.y; ++y) {
        for (int x = 0; x < out.grid.dims.x; ++x) {
          const glm::ivec3 cell = glm::clamp(glm::ivec3(x, y, z) - kGuardCells, glm::ivec3(0), volume.grid.dims - 1);
          const float* from = &layer.coefficients[volume.grid.index(cell) * layout::kVolumeFloats];
          more.coefficients.insert(more.coefficients.end(), from, from + layout::kVolumeFloats);
        }
      }
      co_yield yield();
    }
  }
}

}  // namespace

gpu::Readback& withRoom(gpu::Readback& readback, const char* label, std::size_t bytes) {
  if (readback.size() < bytes) readback = gpu::Readback(label, bytes);
  return readback;
}

GpuTask copyVolume(const LightField& field, gpu::Readback& target) {
  const gpu::Buffer& volume = field.incidentVolume;
  withRoom(target, "volume", volume.size());
  for (const Chunk& part : chunksOf(volume.size())) {
    target.copyFrom(volume, part.offset, part.offset, part.bytes);
    co_yield yield();
  }
}

void copyEmitterList(const LightField& field, const EmitterBufferList& emitters, Readbacks& readbacks) {
  const std::size_t bytes = emitters.count * sizeof(glm::vec4);
  withRoom(readbacks.emitterList, "emitter list", bytes).copyFrom(emitters.texels, 0, 0, bytes);
  if (field.transport != Transport::kGather) return;
  const std::size_t cells = field.emitterDistance.size();
  withRoom(readbacks.emitterDistance, "emitter distance", cells).copyFrom(field.emitterDistance, 0, 0, cells);
}

void copyCounters(const LightField& field, Readbacks& readbacks) {
  constexpr std::size_t kBytes = sizeof(layout::Counters);
  withRoom(readbacks.counters, "counters", kBytes).copyFrom(field.counters, 0, 0, kBytes);
}

GpuTask takeVolume(const gpu::Readback& readback, const LightField& field, const std::vector<std::string>& groups,
                   bool guarded, Volume& out) {
  out.grid = productOf(field);
  co_await takeLayers(readback, field, field.inner(), groups, out);
  if (!guarded) co_return;
  auto more = std::make_shared<Volume>();
  more->grid = guardedGrid(out.grid);
  more->stage = out.stage;
  if (field.guard == kGuardCells) {
    co_await takeLayers(readback, field, {glm::ivec3(0), field.grid.dims}, groups, *more);
  } else {
    co_await repeatOutermost(out, *more);
  }
  out.guarded = std::move(more);
}

EmitterListPtr takeEmitterList(const LightField& field, const EmitterBufferList& emitters, const Readbacks& readbacks,
                               LightVisibilityPtr visibility, ReflectedLightPtr reflected) {
  const std::size_t texels = emitters.count;
  if (field.transport == Transport::kPropagate) return nullptr;
  auto list = std::make_shared<EmitterList>();
  list->grid = field.grid;
  list->visibility = std::move(visibility);
  list->reflected = std::move(reflected);
  list->always = field.transport == Transport::kDirect || emitters.everywhere || list->visibility != nullptr ||
                 list->reflected != nullptr;
  list->texels.resize(texels);
  std::memcpy(list->texels.data(), readbacks.emitterList.bytes().data(), texels * sizeof(glm::vec4));
  if (list->always) return list;
  list->emitterDistance.resize(list->grid.cells());
  std::memcpy(list->emitterDistance.data(), readbacks.emitterDistance.bytes().data(),
              list->emitterDistance.size() * sizeof(float));
  return list;
}

void copyReflected(const PatchSet& patches, Readbacks& readbacks) {
  const std::size_t bytes = patches.lights.size(), ofPieces = patches.pieceLights.size();
  withRoom(readbacks.patchLights, "patch lights", bytes).copyFrom(patches.lights, 0, 0, bytes);
  withRoom(readbacks.patches, "patches", patches.bytesOfPatches())
      .copyFrom(patches.patches, 0, 0, patches.bytesOfPatches());
  if (patches.folded())
    withRoom(readbacks.pieceLights, "piece lights", ofPieces).copyFrom(patches.pieceLights, 0, 0, ofPieces);
}

ReflectedLightPtr takeReflected(const PatchSet& patches, const Readbacks& readbacks) {
  std::vector<glm::vec4> texels(patches.source->patches.size() * layout::kLightPointTexels);
  std::memcpy(texels.data(), readbacks.patchLights.bytes().data(), texels.size() * sizeof(glm::vec4));
  auto out = std::make_shared<ReflectedLight>();
  for (std::size_t i = 0; i < patches.source->patches.size(); ++i) {
    const glm::vec4* point = &texels[i * layout::kLightPointTexels];
    const double area = -double(point[1].w);
    out->radiance.push_back(double(point[0].w) / area * glm::dvec3(point[2]));
  }
  out->slopes = patches.slopesIn(readbacks.patches.bytes());
  std::vector<glm::vec4> pieces(patches.source->folds.pieces.size());
  if (patches.folded())
    std::memcpy(pieces.data(), readbacks.pieceLights.bytes().data(), pieces.size() * sizeof(glm::vec4));
  for (const glm::vec4& radiance : pieces) out->pieceRadiance.emplace_back(radiance);
  out->of = patches.source;
  if (patches.folded()) out->findPiecesOfPatches();
  return out;
}

layout::Counters takeCounters(const Readbacks& readbacks) {
  layout::Counters counts;
  std::memcpy(&counts, readbacks.counters.bytes().data(), sizeof counts);
  return counts;
}

GpuTask copyFrame(View& view, Pacing pacing) {
  const FrameTargets& targets = *view.targets;
  const glm::ivec2 size = targets.size;
  const bool display = bool(targets.display);
  const std::size_t rowBytes = std::size_t(size.x) * (display ? 3 : 3 * sizeof(float));
  const std::size_t bytes = rowBytes * std::size_t(size.y);
  gpu::Readback& target = withRoom(view.readback, "frame", exposureOffset(bytes) + sizeof(glm::vec4));
  if (targets.exposure) target.copyFrom(targets.exposure, 0, exposureOffset(bytes), sizeof(glm::vec4));
  for (int row = 0; row < size.y;) {
    const int rows = std::clamp(pacing.unitsFor(Stage::kReadback) / size.x, 1, size.y - row);
    target.copyPixels(targets.result(), row, rows, GL_RGB, display ? GL_UNSIGNED_BYTE : GL_FLOAT,
                      std::size_t(row) * rowBytes);
    row += rows;
    if (row < size.y) co_yield submitted(Stage::kReadback, double(rows) * size.x);
  }
}

std::shared_ptr<Frame> emptyFrame(const FrameRequest& request) {
  auto frame = std::make_shared<Frame>();
  frame->size = request.size;
  frame->format = request.format;
  frame->exposureEv = request.exposure.ev;
  frame->camera = request.camera;
  const std::size_t values = std::size_t(request.size.x) * std::size_t(request.size.y) * 3;
  if (request.format == PixelFormat::kRgb32F) {
    frame->rgb32f.reserve(values);
  } else {
    frame->rgb8.reserve(values);
  }
  return frame;
}

GpuTask takeRows(const View& view, int first, int rows, Frame& out) {
  const bool linear = out.format == PixelFormat::kRgb32F;
  const std::size_t rowBytes = std::size_t(out.size.x) * 3 * (linear ? sizeof(float) : 1);
  const std::byte* pixels = view.readback.bytes().data() + std::size_t(first) * rowBytes;
  for (const Chunk& part : chunksOf(std::size_t(rows) * rowBytes)) {
    if (linear) {
      append(out.rgb32f, pixels, part);
    } else {
      append(out.rgb8, pixels, part);
    }
    co_yield yield();
  }
}

GpuTask takeFrame(const View& view, const FrameRequest& request, FramePtr& out) {
  const std::shared_ptr<Frame> frame = emptyFrame(request);
  co_await takeRows(view, 0, request.size.y, *frame);
  if (view.targets->exposure) {
    glm::vec4 found(0.0F);
    std::memcpy(&found, view.readback.bytes().data() + exposureOffset(frame->rgb8.size()), sizeof found);
    frame->exposureEv = double(found.y);
  }
  out = frame;
}

}  // namespace lpv
