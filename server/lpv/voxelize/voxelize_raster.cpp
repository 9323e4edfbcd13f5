#include <algorithm>

#include "gpu/gl.h"
#include "lpv/voxelize/voxelize.h"

namespace lpv {

namespace {

/// Pacing keeps draws shorter.
constexpr auto kMostTriangles = std::uint32_t(layout::kMaxThinTriangles);

}  // namespace

RasterVoxelizer::RasterVoxelizer() { glCreateVertexArrays(1, &noVertices_); }

RasterVoxelizer::~RasterVoxelizer() { glDeleteVertexArrays(1, &noVertices_); }

std::uint32_t RasterVoxelizer::limit(const VoxelizeJob&) const { return kMostTriangles; }

void RasterVoxelizer::dispatch(const VoxelizeJob& job) {
  const glm::ivec3& dims = job.params.dims;
  const int edge = std::max({dims.x, dims.y, dims.z});
  if (target_.size().x < edge) target_ = gpu::Framebuffer::withoutAttachments("columns", glm::ivec2(edge));
  thin_.begin();
  target_.bind();
  glViewport(0, 0, edge, edge);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glBindVertexArray(noVertices_);
  programs_.get(job.variant).use();
  glDrawArrays(GL_TRIANGLES, 0, GLsizei(3 * job.params.triangleCount));
  gpu::memoryBarrier();
  thin_.dispatch(job);
}

}  // namespace lpv
