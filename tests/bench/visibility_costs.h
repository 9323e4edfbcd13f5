#pragma once
// What shadow rays cost between triangles and through a coverage grid: per ray, in memory, to make, and when something
// moves. Both ways are measured in turns, so that what else runs on the machine is on both.

#include <string>
#include <vector>

#include "visibility_ways.h"

namespace lpv::bench {

/// Seconds, medians: of the CPU in all threads where the device is software, so that what else runs on the machine does
/// not count; else of the wall.
struct Compared {
  double triangles = 0.0, coverage = 0.0;
};

struct CostScene {
  std::string name;
  Scene scene;
  std::size_t triangles = 0;
};
/// Boxes in a room, meshes of 1,000 and 33,446 triangles in it (bench::statue), and a living room of 180,000
/// (LPV_BENCH_ROOM names its glTF binary; a bumpy sphere of as many triangles takes its place).
std::vector<CostScene> costScenes(int cells);
/// Triangles of the surface that has the most.
std::size_t largestOf(const Scene& scene);

class VisibilityCosts {
 public:
  VisibilityCosts(VisibilityWays& ways, const CoverageVariant& variant, int repeats)
      : ways_(ways), variant_(variant), repeats_(repeats) {}

  /// Per ray.
  Compared ray(const Scene& scene, bool toLamp);
  /// From meshes to what rays read.
  Compared make(const Scene& scene);
  /// The surface with the most triangles is 1 cm further.
  Compared move(const Scene& scene);

 private:
  VisibilityWays& ways_;
  CoverageVariant variant_;
  int repeats_;
};

struct VisibilityBytes {
  std::size_t triangles = 0;  ///< of the GPU
  std::size_t coverage = 0;  ///< of the GPU
  std::size_t lines = 0;  ///< of the CPU: what each occluder covers, which moves need
};
VisibilityBytes bytesOf(const Scene& scene);

}  // namespace lpv::bench
