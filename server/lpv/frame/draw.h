#pragma once
// Drawing meshes: what the G-buffer and the emitter pass have in common.

#include <functional>
#include <optional>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/framebuffer.h"
#include "gpu/program.h"
#include "lpv/frame/frame_view.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/scene_cache.h"

namespace lpv {

/// One mesh to be drawn.
struct DrawItem {
  const GpuMesh* mesh = nullptr;
  int first = 0, count = 0;  ///< triangles of it; 0: all
  const gpu::Texture* texture = nullptr;  ///< or null
  const gpu::Texture* normals = nullptr;  ///< tangent-space, or null
  const gpu::Texture* gloss = nullptr;    ///< green: roughness, blue: metalness; or null
  bool mirrored = false;                  ///< the transform turns its front over
  bool cullBack = false;
  bool alphaVaries = false;  ///< with the texture
  layout::DrawParams params;
};

/// The part of DrawItem's params that follows from where the mesh is.
layout::DrawParams placed(const FrameView& view, const glm::dmat4& worldFromObject);

/// How many triangles are drawn.
int trianglesOf(const DrawItem& item);

/// Of a target, columns and rows.
struct PixelRange {
  glm::ivec2 begin{0}, size{0};
};

/// What becomes of a pixel that several meshes are drawn to.
enum class DrawMode {
  kNearest,   ///< reversed depth test, from black
  kMultiply,  ///< all multiply it, from white; no depth
};

/// Draws lists of meshes, a bounded number of pixels and triangles at a time.
class MeshDrawer {
 public:
  /// Which program draws an item.
  using ProgramOf = std::function<gpu::Program&(const DrawItem&)>;

  MeshDrawer();
  MeshDrawer(const MeshDrawer&) = delete;
  MeshDrawer& operator=(const MeshDrawer&) = delete;
  ~MeshDrawer();

  /// Clears `target` and draws all of `items` into it as pieces of `stage`. `programOf` is asked before each draw, and
  /// may bind more. The arguments by reference outlive the coroutine. `pixels`: other ones stay as they are.
  GpuTask run(Stage stage, const gpu::Framebuffer& target, const gpu::Buffer& frameParams,
              const std::vector<DrawItem>& items, ProgramOf programOf, Pacing pacing,
              DrawMode mode = DrawMode::kNearest, std::optional<PixelRange> pixels = {}) const;

 private:
  GpuTask drawBand(Stage stage, const gpu::Framebuffer& target, const gpu::Buffer& frameParams, const PixelRange& band,
                   double unitsPerTriangle, const std::vector<DrawItem>& items, const gpu::Buffer& drawParams,
                   const ProgramOf& programOf, Pacing pacing, DrawMode mode) const;
  void begin(const gpu::Framebuffer& target, const PixelRange& band, const gpu::Buffer& frameParams,
             DrawMode mode) const;
  void bind(const DrawItem& item, std::size_t index, const gpu::Buffer& drawParams) const;

  std::uint32_t vertexArray_ = 0;
};

}  // namespace lpv
