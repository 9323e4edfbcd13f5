#pragma once
// Rays marched through a coverage grid on the GPU.

#include <string>

#include "coverage_grid.h"
#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "shadow_rays.h"

namespace lpv::bench {

/// How a cell's three shares become what a ray loses in it.
enum class CoverageBlend {
  kDirection,  ///< 1 - shares weighted by the ray's direction, |d| / (|dx| + |dy| + |dz|)
  kPath,       ///< 1 - shares weighted by how far the ray gets along each axis within the cell
  kMiddle,  ///< 1 - share where the ray crosses the cell's middle across the axis, else 1: sheets of what a layer of
            ///< cells holds, in its middle
  kPower,  ///< (1 - share) to the power of how far it gets along the axis: a layer of cells takes its share once,
           ///< whichever way a ray goes through it
};

/// Which cells a ray leaves out, so that its own surface is not in its way.
struct CoverageStart {
  enum class Way {
    kNormal,  ///< begins so many cells of the coverage grid from the surface along its normal
    kPlane,  ///< keeps its line, and begins that far from the surface's plane
  } way = Way::kNormal;
  float cells = 1.0F;
};

/// In cells of the coverage grid, `dims` of them, of a ray in cells of the volume's grid. Its end at a lamp is treated
/// as its begin.
ShadowRay marched(const ShadowRay& ray, const CoverageStart& start, const glm::ivec3& dims);

class GpuCoverage {
 public:
  explicit GpuCoverage(const CoverageGrid& grid);
  /// Sends the cells of a box again.
  void update(const CoverageGrid& grid, const CellBox& box);
  void bind() const;
  std::size_t bytes() const { return cells_.size(); }

 private:
  gpu::Buffer cells_;
  gpu::BufferTexture view_;
};

/// What gets through, with the number of cells.
RayProgram coverageProgram(CoverageBlend blend);

}  // namespace lpv::bench
