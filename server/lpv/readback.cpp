#include "lpv/readback.h"

#include <algorithm>
#include <cstring>

#include "gpu/gl.h"
#include "lpv/pacing/chunked.h"
#include "shaders/layout.h"

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

EmitterListPtr emitterListFrom(const SessionState& session) {
  if (session.field->transport == Transport::kPropagate) return nullptr;
  auto direct = std::make_shared<EmitterList>();
  direct->grid = session.field->grid;
  direct->always = session.field->transport == Transport::kDirect;
  direct->texels.resize(session.emitters.count);
  std::memcpy(direct->texels.data(), session.emitterListReadback.bytes().data(),
              direct->texels.size() * sizeof(glm::vec4));
  if (direct->always) return direct;
  direct->emitterDistance.resize(direct->grid.cells());
  std::memcpy(direct->emitterDistance.data(), session.emitterDistanceReadback.bytes().data(),
              direct->emitterDistance.size() * sizeof(float));
  return direct;
}

GpuTask takeVolume(const gpu::Readback& readback, const SessionState& session, VolumeStage stage, VolumePtr& out) {
  const Grid& grid = session.field->grid;
  auto volume = std::make_shared<Volume>();
  volume->grid = grid;
  volume->stage = stage;
  const std::byte* from = readback.bytes().data();
  const std::size_t layerBytes = grid.cells() * layout::kVolumeFloats * sizeof(float);
  for (const std::string& group : session.groups) {
    VolumeLayer& layer = volume->layers.emplace_back();
    layer.group = group;
    layer.coefficients.reserve(grid.cells() * layout::kVolumeFloats);
    for (const Chunk& part : chunksOf(layerBytes)) {
      append(layer.coefficients, from, part);
      co_yield yield();
    }
    from += layerBytes;
  }
  if (stage == VolumeStage::kTransported) volume->direct = emitterListFrom(session);
  out = std::move(volume);
}

}  // namespace

gpu::Readback& withRoom(gpu::Readback& readback, const char* label, std::size_t bytes) {
  if (readback.size() < bytes) readback = gpu::Readback(label, bytes);
  return readback;
}

GpuTask copyVolume(SessionState& session, VolumeStage stage) {
  const bool injected = stage == VolumeStage::kInjected;
  gpu::Readback& target = withRoom(injected ? session.injectedReadback : session.volumeReadback,
                                   injected ? "injected volume" : "volume", session.incidentVolume.size());
  for (const Chunk& part : chunksOf(session.incidentVolume.size())) {
    target.copyFrom(session.incidentVolume, part.offset, part.offset, part.bytes);
    co_yield yield();
  }
}

void queueEmitterListCopy(SessionState& session) {
  const std::size_t bytes = session.emitters.count * sizeof(glm::vec4);
  withRoom(session.emitterListReadback, "direct lights", bytes).copyFrom(session.emitters.texels, 0, 0, bytes);
  if (session.field->transport != Transport::kGather) return;
  const std::size_t cells = session.field->emitterDistance.size();
  withRoom(session.emitterDistanceReadback, "emitterDistance", cells)
      .copyFrom(session.field->emitterDistance, 0, 0, cells);
}

void queueCounterCopy(SessionState& session) {
  constexpr std::size_t kBytes = sizeof(layout::Counters);
  withRoom(session.countersReadback, "counters", kBytes).copyFrom(session.field->counters, 0, 0, kBytes);
}

GpuTask takeCopies(SessionState& session, const VolumeCopies& copies) {
  if (copies.transported)
    co_await takeVolume(session.volumeReadback, session, VolumeStage::kTransported, session.transportedVolume);
  if (copies.injected)
    co_await takeVolume(session.injectedReadback, session, VolumeStage::kInjected, session.injectedVolume);
  if (!copies.counters) co_return;
  layout::Counters counts;
  std::memcpy(&counts, session.countersReadback.bytes().data(), sizeof counts);
  session.trianglesSkipped = counts.degenerate;
  session.clampedCells = counts.clamped;
  session.touchedCells = counts.touched;
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

GpuTask takeFrame(const View& view, const FrameRequest& request, FramePtr& out) {
  auto frame = std::make_shared<Frame>();
  frame->size = request.size;
  frame->format = request.format;
  frame->exposureEv = request.exposure.ev;
  const std::size_t values = std::size_t(request.size.x) * std::size_t(request.size.y) * 3;
  const std::byte* pixels = view.readback.bytes().data();
  const bool linear = request.format == PixelFormat::kRgb32F;
  if (linear) {
    frame->rgb32f.reserve(values);
  } else {
    frame->rgb8.reserve(values);
  }
  for (const Chunk& part : chunksOf(linear ? values * sizeof(float) : values)) {
    if (linear) {
      append(frame->rgb32f, pixels, part);
    } else {
      append(frame->rgb8, pixels, part);
    }
    co_yield yield();
  }
  if (view.targets->exposure) {
    glm::vec4 found(0.0F);
    std::memcpy(&found, pixels + exposureOffset(values), sizeof found);
    frame->exposureEv = double(found.y);
  }
  out = std::move(frame);
}

}  // namespace lpv
