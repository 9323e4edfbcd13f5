#include "scene/haze.h"

#include <algorithm>
#include <cmath>

#include "scene/scene.h"

namespace lpv {

double Haze::transmittance(const glm::dvec3& from, const glm::dvec3& to) const {
  if (!any()) return 1.0;
  const glm::dvec3 way = to - from;
  double begin = 0.0, end = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (way[axis] == 0.0) {
      if (from[axis] < box.min[axis] || from[axis] > box.max[axis]) return 1.0;
      continue;
    }
    const double a = (box.min[axis] - from[axis]) / way[axis], b = (box.max[axis] - from[axis]) / way[axis];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  return end > begin ? std::exp(-extinction * (end - begin) * glm::length(way)) : 1.0;
}

Haze hazeOf(const Scene& scene) {
  if (scene.options.haze == 0.0) return {};
  return {scene.grid.bounds(), scene.options.haze};
}

}  // namespace lpv
