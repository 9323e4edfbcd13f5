// The rays of visibility_bench through its coverage grid: the same in GLSL as from where they cross the cells' faces.
#include "bench/coverage_rays.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "gpu/support/gl_test.h"
#include "reference/meshes.h"
#include "reference/occlusion.h"

namespace lpv::bench {
namespace {

constexpr int kCells = 16;
constexpr double kShortest = 1e-5;  // of a way: floats may not see such a stretch within a cell
const glm::dvec3 kClosed(1e-30);  // what the shader takes for 0, which has no logarithm

/// A ball, and a sheet that it goes through.
CoverageGrid fullGrid() {
  const auto place = [](const glm::dvec3& at, double size) {
    return glm::scale(glm::translate(glm::dmat4(1.0), at), glm::dvec3(size)) * reference::turn(0.6);
  };
  return CoverageGrid(
      {{.mesh = reference::bumpySphere(400), .worldFromObject = place({8.3, 7.9, 8.1}, 9.0), .coverage = {}},
       {.mesh = reference::quad(), .worldFromObject = place({7.0, 8.0, 6.0}, 11.0), .coverage = {}}},
      glm::dmat4(1.0), glm::ivec3(kCells));
}

/// Where a segment crosses planes i + `offset` across an axis, 0..1.
std::vector<double> crossings(const reference::Segment& s, int axis, double offset) {
  std::vector<double> out;
  for (int i = 0; i < kCells; ++i) {
    const double at = (i + offset - s.from[axis]) / (s.to[axis] - s.from[axis]);
    if (at > 0.0 && at < 1.0) out.push_back(at);
  }
  return out;
}

glm::dvec3 sharesAt(const CoverageGrid& grid, const reference::Segment& s, double at) {
  return glm::dvec3(glm::u8vec3(grid.at(glm::ivec3(glm::mix(s.from, s.to, at))))) / 255.0;
}

/// The ends of the stretches that lie in one cell each.
std::vector<double> stretches(const reference::Segment& s) {
  std::vector<double> out = {0.0, 1.0};
  for (int axis = 0; axis < 3; ++axis) std::ranges::copy(crossings(s, axis, 0.0), std::back_inserter(out));
  std::ranges::sort(out);
  return out;
}

double inStretch(CoverageBlend blend, const glm::dvec3& shares, const glm::dvec3& way, double part) {
  if (blend == CoverageBlend::kDirection) return 1.0 - glm::dot(shares, way) / (way.x + way.y + way.z);
  if (blend == CoverageBlend::kPath) return std::max(1.0 - part * glm::dot(shares, way), 0.0);
  const glm::dvec3 powers = glm::pow(glm::max(1.0 - shares, kClosed), part * way);
  return powers.x * powers.y * powers.z;
}

double throughOf(const CoverageGrid& grid, const reference::Segment& s, CoverageBlend blend) {
  double out = 1.0;
  if (blend == CoverageBlend::kMiddle) {
    for (int axis = 0; axis < 3; ++axis)
      for (const double at : crossings(s, axis, 0.5)) out *= 1.0 - sharesAt(grid, s, at)[axis];
    return out;
  }
  const std::vector<double> ends = stretches(s);
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const glm::dvec3 shares = sharesAt(grid, s, 0.5 * (ends[i] + ends[i + 1]));
    out *= inStretch(blend, shares, glm::abs(s.to - s.from), ends[i + 1] - ends[i]);
  }
  return out;
}

bool isClear(const reference::Segment& s) {
  std::vector<double> all = stretches(s);
  for (int axis = 0; axis < 3; ++axis) std::ranges::copy(crossings(s, axis, 0.5), std::back_inserter(all));
  std::ranges::sort(all);
  for (std::size_t i = 0; i + 1 < all.size(); ++i)
    if (all[i + 1] - all[i] < kShortest) return false;
  return true;
}

using CoverageRaysTest = test::GlTest;

// Red with a cell that is left out, with the layers of another axis, and with middles that count twice.
TEST_F(CoverageRaysTest, GetThroughWhatTheCellsLeaveOpen) {
  const CoverageGrid grid = fullGrid();
  const GpuCoverage onGpu(grid);
  std::vector<reference::Segment> segments =
      reference::randomSegments(2000, glm::dvec3(0.01), glm::dvec3(kCells - 0.01), 9);
  std::erase_if(segments, [](const reference::Segment& s) { return !isClear(s); });
  ASSERT_GT(segments.size(), 1000U);
  std::vector<ShadowRay> rays;
  for (const reference::Segment& s : segments) rays.push_back({glm::vec3(s.from), glm::vec3(s.to), {}, {}});
  const gpu::Buffer in = rayBuffer(rays), out = answerBuffer(rays.size());
  using enum CoverageBlend;
  for (const CoverageBlend blend : {kDirection, kPath, kMiddle, kPower}) {
    RayProgram program = coverageProgram(blend);
    onGpu.bind();
    program.dispatch(in, out);
    const std::vector<glm::vec2> answers = answersOf(out);
    double sum = 0.0;
    for (std::size_t i = 0; i < segments.size(); ++i) {
      EXPECT_NEAR(answers[i].x, throughOf(grid, segments[i], blend), 3e-3) << int(blend) << ", " << i;
      sum += double(answers[i].x);
    }
    EXPECT_GT(sum, 0.1 * double(segments.size()));
    EXPECT_LT(sum, 0.9 * double(segments.size()));
  }
}

// The part of a grid that an occluder has left and come to is all that has to be sent.
// Red where the box that a move returns is the new place's alone.
TEST_F(CoverageRaysTest, AMoveSendsWhatHasChanged) {
  const Occluder before = {.mesh = reference::quad(),
                           .worldFromObject = glm::translate(glm::dmat4(1.0), glm::dvec3(3.2, 4.1, 5.3)),
                           .coverage = {}};
  Occluder after = before;
  after.worldFromObject = glm::translate(glm::dmat4(1.0), glm::dvec3(9.7, 10.2, 11.4));
  CoverageGrid grid({before}, glm::dmat4(1.0), glm::ivec3(kCells));
  GpuCoverage onGpu(grid);
  onGpu.update(grid, grid.move(0, after));
  const std::vector<ShadowRay> rays = {{{3.2F, 4.1F, 4.0F}, {3.2F, 4.1F, 7.0F}, {}, {}},
                                       {{9.7F, 10.2F, 10.0F}, {9.7F, 10.2F, 13.0F}, {}, {}}};
  const gpu::Buffer in = rayBuffer(rays), out = answerBuffer(rays.size());
  RayProgram program = coverageProgram(CoverageBlend::kPower);
  onGpu.bind();
  program.dispatch(in, out);
  const std::vector<glm::vec2> answers = answersOf(out);
  EXPECT_EQ(answers[0].x, 1.0F);
  EXPECT_LT(answers[1].x, 0.7F);
}

}  // namespace
}  // namespace lpv::bench
