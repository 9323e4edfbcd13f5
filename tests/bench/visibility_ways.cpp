#include "visibility_ways.h"

#include <algorithm>
#include <cmath>

#include "lpv/resources/occluders.h"
#include "shaders/layout.h"

namespace lpv::bench {

namespace {

/// From all receivers, in their order; where they begin and end on surfaces.
std::vector<ShadowRay> raysOf(const VisibilityTask& task, const Grid& grid, int n) {
  std::vector<ShadowRay> out;
  const glm::vec3 lamp(lampNormal(task.scene));
  std::uint32_t seed = 1;
  for (const reference::Receiver& r : task.receivers) {
    const glm::vec3 from(grid.gridFromWorld(r.position)), normal(r.normal);
    for (const glm::dvec3& p : lampPoints(task.scene, n, seed++))
      out.push_back({from, glm::vec3(grid.gridFromWorld(p)), normal, lamp});
  }
  return out;
}

/// As the product has them.
ShadowRay offTheSurface(ShadowRay ray) {
  ray.from += layout::kShadowOffset * ray.fromNormal;
  ray.to = glm::mix(ray.from, ray.to, layout::kShadowEnd);
  return ray;
}

/// Sums over receivers and places of the grid.
class ErrorSum {
 public:
  void add(const VisibilityTask& task, const std::vector<glm::vec2>& answers) {
    const std::size_t rays = answers.size() / task.receivers.size();
    for (std::size_t i = 0; i < task.receivers.size(); ++i) {
      double seen = 0.0;
      for (std::size_t k = 0; k < rays; ++k) seen += double(answers[i * rays + k].x) / double(rays);
      const double off = seen - task.truth[i];
      out_.mean += seen;
      out_.largestSeen = std::max(out_.largestSeen, seen);
      out_.worst = std::max(out_.worst, std::abs(off));
      squares_ += off * off;
      truths_ += task.truth[i] * task.truth[i];
      ++count_;
    }
  }

  VisibilityError result() const {
    VisibilityError out = out_;
    out.mean /= count_;
    out.rms = std::sqrt(squares_ / count_);
    out.l2 = truths_ == 0.0 ? 0.0 : std::sqrt(squares_ / truths_);
    return out;
  }

 private:
  VisibilityError out_;
  double squares_ = 0.0, truths_ = 0.0, count_ = 0.0;
};

std::vector<glm::vec2> trace(RayProgram& program, const std::vector<ShadowRay>& rays) {
  const gpu::Buffer in = rayBuffer(rays), out = answerBuffer(rays.size());
  program.dispatch(in, out);
  return answersOf(out);
}

}  // namespace

std::string nameOf(const CoverageVariant& variant) {
  const std::string blends[] = {"direction", "path", "middle", "power"};
  const std::string cells =
      std::to_string(int(variant.start.cells)) + (variant.start.cells == 1.0F ? " cell" : " cells");
  return blends[int(variant.blend)] + ", " + cells +
         (variant.start.way == CoverageStart::Way::kNormal ? " along the normal" : " from the plane");
}

std::vector<CoverageVariant> coverageVariants() {
  using enum CoverageBlend;
  using enum CoverageStart::Way;
  std::vector<CoverageVariant> out;
  for (const CoverageBlend blend : {kDirection, kPath, kMiddle, kPower})
    for (const CoverageStart& start : {CoverageStart{kNormal, 1.0F}, {kNormal, 2.0F}, {kPlane, 1.0F}})
      out.push_back({blend, start});
  return out;
}

VisibilityWays::VisibilityWays() : triangles_(trianglesProgram()) {
  using enum CoverageBlend;
  for (const CoverageBlend blend : {kDirection, kPath, kMiddle, kPower})
    coverage_.emplace(blend, coverageProgram(blend));
}

VisibilityError VisibilityWays::byTriangles(const VisibilityTask& task, int cells, int n) {
  ErrorSum sum;
  for (int place = 0; place < kGridPlaces; ++place) {
    const Grid grid = taskGrid(cells, place);
    GpuOccluders occluders;
    occluders.update(occludersOf(task.scene), grid).runToEnd();
    std::vector<ShadowRay> rays = raysOf(task, grid, n);
    std::ranges::transform(rays, rays.begin(), offTheSurface);
    occluders.bind();
    sum.add(task, trace(triangles_, rays));
  }
  return sum.result();
}

VisibilityError VisibilityWays::byCoverage(const VisibilityTask& task, int cells, int n,
                                           const CoverageVariant& variant) {
  ErrorSum sum;
  for (int place = 0; place < kGridPlaces; ++place) {
    const Grid grid = taskGrid(cells, place);
    const CoverageGrid coverage(occludersOf(task.scene), grid);
    std::vector<ShadowRay> rays = raysOf(task, grid, n);
    std::ranges::transform(rays, rays.begin(),
                           [&](const ShadowRay& ray) { return marched(ray, variant.start, coverage.dims()); });
    const GpuCoverage onGpu(coverage);
    onGpu.bind();
    sum.add(task, trace(coverage_.at(variant.blend), rays));
  }
  return sum.result();
}

}  // namespace lpv::bench
