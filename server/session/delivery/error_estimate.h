#pragma once
// A relative error over a surface from a few points, and how well they determine it.

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

namespace lpv {

/// One point: what was looked up, what is true, and how many square metres it stands for (times any common factor).
struct Compared {
  glm::dvec3 got{0.0};
  glm::dvec3 truth{0.0};
  double weight = 1.0;
};

/// Raw relative L2, sqrt(integral |got - truth|^2 / integral |truth|^2), and the interval that holds it with 95 %.
struct ErrorEstimate {
  double error = 0.0;
  double low = 0.0;
  double high = 0.0;
};

/// Groups are points that were drawn alike: the interval is the percentile bootstrap's (Efron 1979), which draws again
/// within each. Null where no point is lit. `seed` chooses what it draws.
std::optional<ErrorEstimate> estimateError(const std::vector<std::vector<Compared>>& groups, std::uint32_t seed);

}  // namespace lpv
