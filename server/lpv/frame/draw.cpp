#include "lpv/frame/draw.h"

#include <algorithm>
#include <cstring>

#include "gpu/gl.h"

namespace lpv {

namespace {

/// Bytes from one DrawParams to the next: uniform ranges start at multiples of 256 on every driver.
constexpr std::size_t kStride = 256;

void attribute(GLuint array, GLuint index, GLint components) {
  glVertexArrayAttribFormat(array, index, components, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(array, index, index);
}

void bindArray(GLuint array, GLuint index, const std::shared_ptr<gpu::Buffer>& values, GLsizei stride) {
  if (values == nullptr) {
    glDisableVertexArrayAttrib(array, index);
    return;
  }
  glEnableVertexArrayAttrib(array, index);
  glVertexArrayVertexBuffer(array, index, values->id(), 0, stride);
}

/// Parameters of all items of a pass.
gpu::Buffer drawParams(const std::vector<DrawItem>& items) {
  static_assert(sizeof(layout::DrawParams) <= kStride);
  std::vector<std::byte> bytes(items.size() * kStride);
  for (std::size_t i = 0; i < items.size(); ++i)
    std::memcpy(bytes.data() + i * kStride, &items[i].params, sizeof(layout::DrawParams));
  return {"draw params", std::span<const std::byte>(bytes)};
}

/// What a triangle costs besides its pixels, in pixels: on llvmpipe, where bands are dearest (.28 us and 8 ns: emitters
/// of 33,446 and of 676 triangles at 640x360).
constexpr double kTrianglePixels = 32.0;

/// Rows that are drawn at a time: as many pixels as a piece may take, but no more bands than make up for drawing all
/// triangles in each of them.
int rowsOfBand(const glm::ivec2& size, double triangles, double room) {
  const double pixels = double(size.x) * size.y;
  const double bands = std::min(pixels / room, pixels / (kTrianglePixels * std::max(1.0, triangles)));
  return std::clamp(int(size.y / std::max(1.0, bands)), 1, size.y);
}

double trianglesOf(const std::vector<DrawItem>& items) {
  double sum = 0.0;
  for (const DrawItem& item : items) sum += trianglesOf(item);
  return sum;
}

/// As far as the scissor goes.
void clear(const gpu::Framebuffer& target, DrawMode mode) {
  const glm::vec4 first(mode == DrawMode::kMultiply ? 1.0F : 0.0F);
  for (int i = 0; i < target.colours(); ++i) target.clearColour(i, first);
  if (mode == DrawMode::kNearest) target.clearDepth(0.0F);
}

/// A scissor would cut clears too.
void end() {
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_BLEND);
}

}  // namespace

int trianglesOf(const DrawItem& item) { return item.count > 0 ? item.count : int(item.mesh->triangleCount); }

layout::DrawParams placed(const FrameView& view, const glm::dmat4& worldFromObject) {
  layout::DrawParams params{};
  params.eyeFromObject = glm::mat4(view.eyeFromObject(worldFromObject));
  const glm::dmat3 normals = glm::transpose(glm::inverse(glm::dmat3(worldFromObject)));
  // Lengths do not matter; scaled so that no object is too small or large for single precision.
  double largest = 0.0;
  for (int c = 0; c < 3; ++c) largest = glm::max(largest, glm::length(normals[c]));
  params.normalFromObject = glm::mat4(glm::dmat4(normals / largest));
  return params;
}

MeshDrawer::MeshDrawer() {
  glCreateVertexArrays(1, &vertexArray_);
  attribute(vertexArray_, GLuint(layout::kPositionAttribute), 3);
  attribute(vertexArray_, GLuint(layout::kNormalAttribute), 3);
  attribute(vertexArray_, GLuint(layout::kUvAttribute), 2);
}

MeshDrawer::~MeshDrawer() { glDeleteVertexArrays(1, &vertexArray_); }

void MeshDrawer::begin(const gpu::Framebuffer& target, const PixelRange& band, const gpu::Buffer& frameParams,
                       DrawMode mode) const {
  target.bind();
  frameParams.bindUniform(layout::kParams);
  glBindVertexArray(vertexArray_);
  glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
  (mode == DrawMode::kNearest ? glEnable : glDisable)(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_TRUE);
  (mode == DrawMode::kMultiply ? glEnable : glDisable)(GL_BLEND);
  glBlendFunc(GL_DST_COLOR, GL_ZERO);
  glEnable(GL_SCISSOR_TEST);
  glScissor(band.begin.x, band.begin.y, band.size.x, band.size.y);
  glCullFace(GL_BACK);
}

void MeshDrawer::bind(const DrawItem& item, std::size_t index, const gpu::Buffer& params) const {
  params.bindUniformRange(layout::kDrawParams, index * kStride, sizeof(layout::DrawParams));
  glFrontFace(item.mirrored ? GL_CW : GL_CCW);
  (item.cullBack ? glEnable : glDisable)(GL_CULL_FACE);
  const GpuMesh& mesh = *item.mesh;
  bindArray(vertexArray_, GLuint(layout::kPositionAttribute), mesh.positions, 3 * sizeof(float));
  bindArray(vertexArray_, GLuint(layout::kNormalAttribute), mesh.normals, 3 * sizeof(float));
  bindArray(vertexArray_, GLuint(layout::kUvAttribute), mesh.uvs, 2 * sizeof(float));
  glVertexArrayElementBuffer(vertexArray_, mesh.triangles->id());
  if (item.texture != nullptr) item.texture->bind(layout::kAlbedo);
  if (item.normals != nullptr) item.normals->bind(layout::kNormal);
  if (item.gloss != nullptr) item.gloss->bind(layout::kGlossMap);
}

GpuTask MeshDrawer::run(Stage stage, const gpu::Framebuffer& target, const gpu::Buffer& frameParams,
                        const std::vector<DrawItem>& items, ProgramOf programOf, Pacing pacing, DrawMode mode,
                        std::optional<PixelRange> pixels) const {
  const gpu::Buffer params = drawParams(items);
  const PixelRange whole = pixels.value_or(PixelRange{glm::ivec2(0), target.size()});
  const double all = trianglesOf(items);
  const int end = whole.begin.y + whole.size.y;
  for (PixelRange band = whole; band.begin.y < end; band.begin.y += band.size.y) {
    band.size.y = std::min(rowsOfBand(whole.size, all, pacing.unitsFor(stage)), end - band.begin.y);
    const double bandPixels = double(band.size.x) * band.size.y;
    co_await drawBand(stage, target, frameParams, band, kTrianglePixels + bandPixels / std::max(1.0, all), items,
                      params, programOf, pacing, mode);
  }
}

GpuTask MeshDrawer::drawBand(Stage stage, const gpu::Framebuffer& target, const gpu::Buffer& frameParams,
                             const PixelRange& band, double unitsPerTriangle, const std::vector<DrawItem>& items,
                             const gpu::Buffer& params, const ProgramOf& programOf, Pacing pacing,
                             DrawMode mode) const {
  double queued = 0.0;  // since the last pause
  begin(target, band, frameParams, mode);
  clear(target, mode);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const int triangles = trianglesOf(items[i]);
    for (int first = 0; first < triangles;) {
      const double room = (pacing.unitsFor(stage) - queued) / unitsPerTriangle;
      const int count = std::min(std::max(1, int(room)), triangles - first);
      programOf(items[i]).use();
      bind(items[i], i, params);
      const std::size_t offset = std::size_t(items[i].first + first) * 12;  // bytes
      glDrawElements(GL_TRIANGLES, 3 * count, GL_UNSIGNED_INT, reinterpret_cast<const void*>(offset));
      first += count;
      queued += count * unitsPerTriangle;
      if (count < int(room)) continue;
      end();
      co_yield submitted(stage, queued);
      queued = 0.0;
      begin(target, band, frameParams, mode);
    }
  }
  end();
  co_yield submitted(stage, items.empty() ? double(band.size.x) * band.size.y : queued);
}

}  // namespace lpv
