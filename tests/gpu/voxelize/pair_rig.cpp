#include "gpu/voxelize/pair_rig.h"

#include <algorithm>
#include <thread>

#include "reference/pairs.h"

namespace lpv::test {

namespace {

constexpr std::size_t kMostPairs = std::size_t(1) << 22;  // of one piece
constexpr auto kPiece = std::size_t(layout::kMaxPieceTriangles);

gpu::Program programOf(const char* source, const char* pass) {
  return {{source},
          {{"LPV_FLUX", "0"}, {"LPV_TEXTURED", "0"}, {"LPV_DIRECTIONS", "0"}, {"LPV_RECORD_PAIRS", "1"}, {pass, "1"}}};
}

gpu::Buffer bufferOfWords(std::size_t words) {
  return {"pairs", words * sizeof(std::uint32_t), gpu::BufferUse::kDynamic};
}

std::vector<std::uint32_t> upTo(std::size_t count) {
  std::vector<std::uint32_t> out(count);
  for (std::size_t i = 0; i < count; ++i) out[i] = std::uint32_t(i);
  return out;
}

layout::VoxelizeParams paramsOf(const glm::ivec3& dims, std::size_t count, const glm::dmat4& gridFromObject) {
  layout::VoxelizeParams params{};
  params.gridFromObject = gridFromObject;
  params.areaFromObject = glm::dmat4(1.0);
  params.dims = dims;
  params.triangleCount = std::uint32_t(count);
  return params;
}

/// The GPU skips what has no area before the snap, so the oracle must too.
bool emits(const Triangle& t) {
  return glm::cross(glm::dvec3(t[1]) - glm::dvec3(t[0]), glm::dvec3(t[2]) - glm::dvec3(t[0])) != glm::dvec3(0.0);
}

reference::SnappedTriangle snapped(const Triangle& t, const glm::dmat4& gridFromObject) {
  reference::SnappedTriangle out;
  for (std::size_t k = 0; k < 3; ++k)
    out.corners[k] = reference::snap(glm::dvec3(gridFromObject * glm::dvec4(glm::dvec3(t[k]), 1.0)));
  return out;
}

std::int64_t floorCell(std::int64_t lattice) { return lattice >> 8; }
static_assert(reference::kUnitsPerCell == 256);

/// Cells of the grid that the closed box of the triangle reaches.
std::uint64_t cellsOfBox(const reference::SnappedTriangle& t, const glm::ivec3& dims) {
  std::uint64_t cells = 1;
  for (int k = 0; k < 3; ++k) {
    const auto [least, most] = std::minmax({t.corners[0][k], t.corners[1][k], t.corners[2][k]});
    const std::int64_t lower = std::max<std::int64_t>(floorCell(least), 0);
    const std::int64_t upper = std::min<std::int64_t>(floorCell(most), dims[k] - 1);
    cells *= std::uint64_t(std::max<std::int64_t>(upper - lower + 1, 0));
  }
  return cells;
}

/// The oracle's opinion on `triangles`, numbered from `first`, against the GPU's sorted pairs.
PairVerdict judged(std::span<const Triangle> triangles, std::size_t first, const glm::ivec3& dims,
                   const glm::dmat4& gridFromObject, std::span<const std::uint64_t> gpu) {
  PairVerdict verdict;
  auto next = std::lower_bound(gpu.begin(), gpu.end(), std::uint64_t(first) << 32);
  std::vector<std::uint64_t> want;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::uint64_t triangle = std::uint64_t(first + i) << 32;
    const auto begin = next;
    next = std::lower_bound(next, gpu.end(), triangle + (std::uint64_t(1) << 32));
    want.clear();
    if (emits(triangles[i])) {
      const reference::SnappedTriangle t = snapped(triangles[i], gridFromObject);
      verdict.decisions += cellsOfBox(t, dims);
      for (const glm::ivec3& c : reference::cellsOf(t, dims))  // in memory order
        want.push_back(triangle | std::uint64_t((c.z * dims.y + c.y) * dims.x + c.x));
    }
    verdict.pairs += want.size();
    if (std::equal(begin, next, want.begin(), want.end())) continue;
    std::vector<std::uint64_t> differing;
    std::set_difference(want.begin(), want.end(), begin, next, std::back_inserter(differing));
    verdict.missing += differing.size();
    differing.clear();
    std::set_difference(begin, next, want.begin(), want.end(), std::back_inserter(differing));
    verdict.extra += differing.size();
  }
  return verdict;
}

}  // namespace

PairVerdict& PairVerdict::operator+=(const PairVerdict& other) {
  decisions += other.decisions;
  pairs += other.pairs;
  missing += other.missing;
  extra += other.extra;
  return *this;
}

PairRig::PairRig()
    : small_(programOf("voxelize/voxelize.comp", "LPV_SMALL")),
      large_(programOf("voxelize/voxelize.comp", "LPV_LARGE")),
      thin_(programOf("voxelize/thin.comp", "LPV_THIN")),
      recorded_(bufferOfWords(2 + 2 * kMostPairs)),
      cells_(bufferOfWords(16)),
      positions_(bufferOfWords(9 * kPiece)),
      order_(bufferOf(upTo(3 * kPiece))),
      positionTexels_("positions", positions_, gpu::BufferTexel::kVec3),
      orderTexels_("triangles", order_, gpu::BufferTexel::kUvec3),
      items_(
          bufferOfWords(sizeof(layout::ListHeader) / sizeof(std::uint32_t) + kPiece * std::size_t(layout::kMaxSlices))),
      segments_(bufferOfWords(sizeof(layout::ListHeader) / sizeof(std::uint32_t) + kPiece)),
      params_("params", sizeof(layout::VoxelizeParams), gpu::BufferUse::kDynamic) {}

std::vector<PairRig::Pair> PairRig::gpuPairs(std::span<const Triangle> triangles, const glm::ivec3& dims,
                                             const glm::dmat4& gridFromObject) {
  const layout::VoxelizeParams params = paramsOf(dims, triangles.size(), gridFromObject);
  positions_.update(0, std::as_bytes(triangles));
  params_.update(0, gpu::bytesOfValue(params));
  items_.update(0, gpu::bytesOfValue(layout::kEmptyListHeader));
  segments_.update(0, gpu::bytesOfValue(layout::kEmptyListHeader));
  recorded_.update(0, gpu::bytesOfValue(glm::uvec2(0)));
  positionTexels_.bind(layout::kPositions);
  orderTexels_.bind(layout::kTriangles);
  recorded_.bindStorage(layout::kRecordedPairs);
  cells_.bindStorage(layout::kVoxelCells);
  items_.bindStorage(layout::kLargeTriangles);
  segments_.bindStorage(layout::kThinTriangles);
  params_.bindUniform(layout::kParams);
  items_.bindAsDispatchArguments();
  small_.dispatch(std::uint32_t(triangles.size() + 63) / 64);
  gpu::memoryBarrier();
  large_.dispatchIndirect(0);
  gpu::memoryBarrier();
  segments_.bindAsDispatchArguments();
  thin_.dispatchIndirect(0);
  gpu::memoryBarrier();
  glFinish();
  std::uint32_t count = 0;
  glGetNamedBufferSubData(recorded_.id(), 0, sizeof count, &count);
  EXPECT_LE(count, kMostPairs);
  std::vector<glm::uvec2> pairs(std::min<std::size_t>(count, kMostPairs));
  glGetNamedBufferSubData(recorded_.id(), 8, GLsizeiptr(pairs.size() * sizeof(glm::uvec2)), pairs.data());
  std::vector<Pair> out;
  out.reserve(pairs.size());
  for (const glm::uvec2& p : pairs) out.push_back(Pair(p.x) << 32 | p.y);
  std::sort(out.begin(), out.end());
  return out;
}

PairVerdict PairRig::compare(std::span<const Triangle> triangles, const glm::ivec3& dims,
                             const glm::dmat4& gridFromObject) {
  PairVerdict total;
  for (std::size_t first = 0; first < triangles.size(); first += kPiece) {
    const auto piece = triangles.subspan(first, std::min(kPiece, triangles.size() - first));
    const std::vector<Pair> gpu = gpuPairs(piece, dims, gridFromObject);
    const std::size_t share = piece.size() / std::max(1U, std::thread::hardware_concurrency()) + 1;
    std::vector<PairVerdict> verdicts((piece.size() + share - 1) / share);
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < verdicts.size(); ++i) {
      threads.emplace_back([&, i] {
        const auto part = piece.subspan(i * share, std::min(share, piece.size() - i * share));
        verdicts[i] = judged(part, i * share, dims, gridFromObject, gpu);
      });
    }
    threads.clear();  // joins
    for (const PairVerdict& verdict : verdicts) total += verdict;
  }
  return total;
}

}  // namespace lpv::test
