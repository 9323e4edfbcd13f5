#include "lpv/frame/buried.h"

#include <algorithm>

#include "gpu/buffer_texture.h"
#include "gpu/gl.h"
#include "lpv/frame/near_field.h"
#include "lpv/frame/parts.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

constexpr int kPixelsOfOne = 16;  // of so many pixels one may be buried; of a room a few in a thousand are
constexpr double kPixelUnits = NearFieldWork{.rays = 0.5}.units();  // rays are short

/// Over the G-buffer's depth, which is farther there.
void drawDepths(int count) {
  glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_TRUE);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glEnable(GL_PROGRAM_POINT_SIZE);
  glDrawArrays(GL_POINTS, 0, count);
  glDisable(GL_PROGRAM_POINT_SIZE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

}  // namespace

BuriedPass::BuriedPass() : params_("buried params", sizeof(layout::BuriedParams), gpu::BufferUse::kDynamic) {
  glCreateVertexArrays(1, &noVertices_);
}

BuriedPass::~BuriedPass() { glDeleteVertexArrays(1, &noVertices_); }

GpuTask BuriedPass::run(const Gbuffer& gbuffer, const GpuOccluders& occluders, const gpu::Buffer& frameParams,
                        Pacing pacing) {
  const glm::ivec2 size = gbuffer.target.size();
  layout::BuriedParams params{};
  params.pixelSize = 1.0F / glm::vec2(size);
  params.most = size.x * size.y / kPixelsOfOne + 1;
  const gpu::Buffer list("buried pixels", (1 + std::size_t(params.most)) * sizeof(glm::vec4));
  const gpu::BufferTexture view("buried pixels", list);
  gpu::Program& find = find_.get({occluders.transparent()});
  for (int row = 0; row < size.y;) {
    const int room = int(pacing.unitsFor(Stage::kShade) / (kPixelUnits * size.x)) / kTile.y * kTile.y;
    const int rows = std::min(std::max(room, kTile.y), size.y - row);
    params.firstRow = row;
    params_.update(0, gpu::bytesOfValue(params));
    params_.bindUniform(layout::kBuriedParams);
    frameParams.bindUniform(layout::kParams);
    gbuffer.normal.bind(layout::kNormal);
    gbuffer.depth.bind(layout::kSurfaceDepth);
    occluders.bind();
    list.bindStorage(layout::kBuried);
    const glm::ivec2 tiles = partsOf({size.x, rows}, kTile);
    find.dispatch(std::uint32_t(tiles.x), std::uint32_t(tiles.y));
    row += rows;
    co_yield submitted(Stage::kShade, kPixelUnits * size.x * rows);
  }
  gpu::memoryBarrier();
  gbuffer.target.bind();
  params_.bindUniform(layout::kBuriedParams);
  view.bind(layout::kBuriedList);
  glBindVertexArray(noVertices_);
  draw_.get({}).use();
  drawDepths(params.most);
  co_yield submitted(Stage::kShade, double(params.most));
}

}  // namespace lpv
