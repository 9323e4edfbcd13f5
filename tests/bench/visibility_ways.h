#pragma once
// The tasks of visibility_tasks.h, answered by rays between triangles and by rays through a coverage grid.

#include <map>
#include <vector>

#include "coverage_rays.h"
#include "visibility_tasks.h"

namespace lpv::bench {

/// What is said of one task's receivers against the truth, over all places of the grid.
struct VisibilityError {
  double mean = 0.0;      ///< share that is seen
  double largestSeen = 0.0;
  double l2 = 0.0;        ///< ||a - b|| / ||b||; 0 where nothing is to be seen
  double rms = 0.0;       ///< sqrt(mean (a - b)^2)
  double worst = 0.0;     ///< largest |a - b|

  bool operator==(const VisibilityError&) const = default;
};

/// How the coverage grid is used.
struct CoverageVariant {
  CoverageBlend blend = CoverageBlend::kPower;
  CoverageStart start;
};
std::string nameOf(const CoverageVariant& variant);
std::vector<CoverageVariant> coverageVariants();

class VisibilityWays {
 public:
  VisibilityWays();

  /// n x n rays from each receiver.
  VisibilityError byTriangles(const VisibilityTask& task, int cells, int n);
  VisibilityError byCoverage(const VisibilityTask& task, int cells, int n, const CoverageVariant& variant);

  RayProgram& triangles() { return triangles_; }
  RayProgram& coverage(CoverageBlend blend) { return coverage_.at(blend); }

 private:
  RayProgram triangles_;
  std::map<CoverageBlend, RayProgram> coverage_;
};

}  // namespace lpv::bench
