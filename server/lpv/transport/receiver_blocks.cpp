#include "lpv/transport/receiver_blocks.h"

#include <algorithm>
#include <cmath>

#include "shaders/layout.h"

namespace lpv {

namespace {

const glm::dvec3 kBlock(layout::kBlockX, layout::kBlockY, layout::kBlockZ);

glm::ivec3 blocksAcross(const glm::ivec3& dims) { return (dims + glm::ivec3(kBlock) - 1) / glm::ivec3(kBlock); }

std::uint32_t packed(const glm::uvec3& block) { return layout::packedBlock(block.x, block.y, block.z); }

/// Trilinear lookup reads the centres of the cells around a point: up to half a cell away from those it lies between.
constexpr double kReach = 1.0;
/// Blocks and triangles looked at between two pauses: about a millisecond.
constexpr std::size_t kLooksAtOnce = 100'000;

/// Marks what lies within kReach of a triangle, block by block: its box, and how far its plane passes the block's
/// centre.
class BlockMarks {
 public:
  explicit BlockMarks(const glm::ivec3& dims)
      : across_(blocksAcross(dims)),
        marks_(std::size_t(across_.x) * std::size_t(across_.y) * std::size_t(across_.z), false) {}

  void add(const glm::dvec3 (&v)[3]) {
    const glm::dvec3 least = (glm::min(v[0], glm::min(v[1], v[2])) - kReach) / kBlock;
    const glm::dvec3 most = (glm::max(v[0], glm::max(v[1], v[2])) + kReach) / kBlock;
    const glm::dvec3 last(across_ - 1);
    const glm::ivec3 from(glm::clamp(glm::floor(least), glm::dvec3(0.0), last));
    const glm::ivec3 to(glm::clamp(glm::floor(most), glm::dvec3(0.0), last));
    const glm::dvec3 normal = glm::cross(v[1] - v[0], v[2] - v[0]);
    const glm::dvec3 size = glm::abs(normal);
    const double width = glm::dot(size, 0.5 * kBlock + kReach);
    const glm::ivec3 span = to - from + 1;
    looked_ += 8 + std::size_t(span.x) * std::size_t(span.y) * std::size_t(span.z);
    for (int z = from.z; z <= to.z; ++z) {
      for (int y = from.y; y <= to.y; ++y) {
        for (int x = from.x; x <= to.x; ++x) {
          const glm::dvec3 centre = (glm::dvec3(x, y, z) + 0.5) * kBlock;
          if (std::abs(glm::dot(normal, centre - v[0])) <= width) marks_[index(x, y, z)] = true;
        }
      }
    }
  }

  std::size_t looked() const { return looked_; }
  void lookAfresh() { looked_ = 0; }

  ReceiverBlocks blocks() const {
    ReceiverBlocks out;
    for (int z = 0; z < across_.z; ++z) {
      for (int y = 0; y < across_.y; ++y) {
        for (int x = 0; x < across_.x; ++x) {
          if (marks_[index(x, y, z)]) out.push_back(packed(glm::ivec3(x, y, z)));
        }
      }
    }
    return out;
  }

 private:
  std::size_t index(int x, int y, int z) const {
    return (std::size_t(z) * std::size_t(across_.y) + std::size_t(y)) * std::size_t(across_.x) + std::size_t(x);
  }

  glm::ivec3 across_;
  std::vector<bool> marks_;
  std::size_t looked_ = 0;  ///< at blocks, and some for each triangle, since the last pause
};

}  // namespace

ReceiverBlocks allBlocks(const glm::ivec3& dims) {
  ReceiverBlocks blocks;
  const glm::ivec3 across = blocksAcross(dims);
  for (int z = 0; z < across.z; ++z) {
    for (int y = 0; y < across.y; ++y) {
      for (int x = 0; x < across.x; ++x) blocks.push_back(packed(glm::ivec3(x, y, z)));
    }
  }
  return blocks;
}

SurfaceBlocksInputs surfaceBlocksInputs(const Scene& scene, const Grid& grid) {
  SurfaceBlocksInputs inputs{grid, {}};
  for (const auto& [name, surface] : scene.surfaces) inputs.surfaces.push_back(surface);
  return inputs;
}

GpuTask blocksOfSurfaces(const SurfaceBlocksInputs& inputs, ReceiverBlocks& out) {
  BlockMarks marks(inputs.grid.dims);
  const glm::dmat4 gridFromWorld = inputs.grid.gridFromWorldMatrix();
  for (const SurfacePtr& surface : inputs.surfaces) {
    const glm::dmat4 gridFromObject = gridFromWorld * surface->transform.worldFromObject();
    for (const glm::uvec3& t : surface->mesh->triangles) {
      glm::dvec3 corners[3];
      for (int i = 0; i < 3; ++i)
        corners[i] = glm::dvec3(gridFromObject * glm::dvec4(glm::dvec3(surface->mesh->positions[t[i]]), 1.0));
      marks.add(corners);
      if (marks.looked() < kLooksAtOnce) continue;
      marks.lookAfresh();
      co_yield yield();
    }
  }
  out = marks.blocks();
}

}  // namespace lpv
