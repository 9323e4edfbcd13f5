#include "session/delivery/error_estimate.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace lpv {

namespace {

constexpr int kResamples = 400;
constexpr double kOutside = 0.025;  ///< share of the resamples below, and above, the interval

/// A point's part of the two integrals.
struct Terms {
  double apart = 0.0;
  double whole = 0.0;

  explicit Terms(const Compared& c)
      : apart(c.weight * glm::dot(c.got - c.truth, c.got - c.truth)), whole(c.weight * glm::dot(c.truth, c.truth)) {}
  Terms() = default;
  void add(const Terms& other) {
    apart += other.apart;
    whole += other.whole;
  }
  double error() const { return std::sqrt(apart / whole); }
};

Terms drawnAgain(const std::vector<std::vector<Terms>>& groups, std::mt19937& random) {
  Terms sum;
  for (const std::vector<Terms>& group : groups) {
    if (group.empty()) continue;
    std::uniform_int_distribution<std::size_t> any(0, group.size() - 1);
    for (std::size_t i = 0; i < group.size(); ++i) sum.add(group[any(random)]);
  }
  return sum;
}

}  // namespace

std::optional<ErrorEstimate> estimateError(const std::vector<std::vector<Compared>>& groups, std::uint32_t seed) {
  std::vector<std::vector<Terms>> terms;
  Terms all;
  for (const std::vector<Compared>& group : groups) {
    std::vector<Terms>& mine = terms.emplace_back();
    for (const Compared& each : group) all.add(mine.emplace_back(each));
  }
  if (!(all.whole > 0.0)) return std::nullopt;
  std::mt19937 random(seed);
  std::vector<double> errors;
  for (int i = 0; i < kResamples; ++i) {
    const Terms again = drawnAgain(terms, random);
    if (again.whole > 0.0) errors.push_back(again.error());
  }
  std::sort(errors.begin(), errors.end());
  const double error = all.error();
  if (errors.empty()) return ErrorEstimate{error, 0.0, error};
  const auto at = [&](double share) { return errors[std::size_t(share * double(errors.size() - 1))]; };
  return ErrorEstimate{error, std::min(error, at(kOutside)), std::max(error, at(1.0 - kOutside))};
}

}  // namespace lpv
