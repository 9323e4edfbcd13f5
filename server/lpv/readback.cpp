#include "lpv/readback.h"

#include <cstring>

#include "gpu/gl.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

/// Where the exposure follows a frame's pixels.
std::size_t exposureOffset(std::size_t pixelBytes) { return (pixelBytes + 15) / 16 * 16; }

DirectLightsPtr directFrom(const SessionState& session) {
  if (session.field->transport == Transport::kPropagate) return nullptr;
  auto direct = std::make_shared<DirectLights>();
  direct->grid = session.field->grid;
  direct->always = session.field->transport == Transport::kDirect;
  direct->texels.resize(session.direct.count);
  std::memcpy(direct->texels.data(), session.directReadback.bytes().data(), direct->texels.size() * sizeof(glm::vec4));
  if (direct->always) return direct;
  direct->proximity.resize(direct->grid.cells());
  std::memcpy(direct->proximity.data(), session.proximityReadback.bytes().data(),
              direct->proximity.size() * sizeof(float));
  return direct;
}

VolumePtr volumeFrom(const gpu::Readback& readback, const SessionState& session, VolumeStage stage) {
  const Grid& grid = session.field->grid;
  auto volume = std::make_shared<Volume>();
  volume->grid = grid;
  volume->stage = stage;
  const std::byte* from = readback.bytes().data();
  for (const std::string& group : session.groups) {
    VolumeLayer& layer = volume->layers.emplace_back();
    layer.group = group;
    layer.coefficients.resize(grid.cells() * 12);
    std::memcpy(layer.coefficients.data(), from, layer.coefficients.size() * sizeof(float));
    from += layer.coefficients.size() * sizeof(float);
  }
  if (stage == VolumeStage::kTransported) volume->direct = directFrom(session);
  return volume;
}

}  // namespace

gpu::Readback& withRoom(gpu::Readback& readback, const char* label, std::size_t bytes) {
  if (readback.size() < bytes) readback = gpu::Readback(label, bytes);
  return readback;
}

void queueVolumeCopy(SessionState& session, VolumeStage stage) {
  const bool injected = stage == VolumeStage::kInjected;
  gpu::Readback& target = injected ? session.injectedReadback : session.volumeReadback;
  const std::size_t bytes = session.product.size();
  withRoom(target, injected ? "injected volume" : "volume", bytes).copyFrom(session.product, 0, 0, bytes);
}

void queueDirectCopy(SessionState& session) {
  const std::size_t bytes = session.direct.count * sizeof(glm::vec4);
  withRoom(session.directReadback, "direct lights", bytes).copyFrom(session.direct.texels, 0, 0, bytes);
  if (session.field->transport != Transport::kGather) return;
  const std::size_t cells = session.field->nearestVpl.size();
  withRoom(session.proximityReadback, "proximity", cells).copyFrom(session.field->nearestVpl, 0, 0, cells);
}

void queueCounterCopy(SessionState& session) {
  constexpr std::size_t kBytes = sizeof(layout::Counters);
  withRoom(session.countersReadback, "counters", kBytes).copyFrom(session.field->counters, 0, 0, kBytes);
}

void takeCopies(SessionState& session, const VolumeCopies& copies) {
  if (copies.transported)
    session.transportedVolume = volumeFrom(session.volumeReadback, session, VolumeStage::kTransported);
  if (copies.injected) session.injectedVolume = volumeFrom(session.injectedReadback, session, VolumeStage::kInjected);
  if (!copies.counters) return;
  layout::Counters counts;
  std::memcpy(&counts, session.countersReadback.bytes().data(), sizeof counts);
  session.trianglesSkipped = counts.degenerate;
  session.clampedCells = counts.clamped;
  session.touchedCells = counts.touched;
}

void queueFrameCopy(View& view) {
  const FrameTargets& targets = *view.targets;
  const std::size_t pixels = std::size_t(targets.size.x) * std::size_t(targets.size.y);
  const bool display = bool(targets.display);
  const std::size_t bytes = pixels * (display ? 3 : 3 * sizeof(float));
  gpu::Readback& target = withRoom(view.readback, "frame", exposureOffset(bytes) + sizeof(glm::vec4));
  target.copyPixels(targets.result(), GL_RGB, display ? GL_UNSIGNED_BYTE : GL_FLOAT, 0);
  if (targets.exposure) target.copyFrom(targets.exposure, 0, exposureOffset(bytes), sizeof(glm::vec4));
}

FramePtr takeFrame(const View& view, const FrameRequest& request) {
  auto frame = std::make_shared<Frame>();
  frame->size = request.size;
  frame->format = request.format;
  frame->exposureEv = request.exposure.ev;
  const std::size_t values = std::size_t(request.size.x) * std::size_t(request.size.y) * 3;
  const std::byte* pixels = view.readback.bytes().data();
  if (request.format == PixelFormat::kRgb32F) {
    frame->rgb32f.resize(values);
    std::memcpy(frame->rgb32f.data(), pixels, values * sizeof(float));
    return frame;
  }
  frame->rgb8.resize(values);
  std::memcpy(frame->rgb8.data(), pixels, values);
  if (view.targets->exposure) {
    glm::vec4 found(0.0F);
    std::memcpy(&found, pixels + exposureOffset(values), sizeof found);
    frame->exposureEv = double(found.y);
  }
  return frame;
}

}  // namespace lpv
