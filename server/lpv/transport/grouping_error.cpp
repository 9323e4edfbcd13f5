#include "lpv/transport/grouping_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "scene/lookup.h"

namespace lpv {

namespace {

constexpr std::size_t kNormals = 4;  ///< per point
constexpr std::size_t kLeastPoints = 16, kMostPoints = 256;
constexpr std::size_t kDealingPoints = 64;  ///< a choice by all points would make its own error look small
/// Lights times points, and triangles of all lights, that one measure looks at, about.
constexpr std::size_t kEvaluations = 8192, kTriangles = 16384;
constexpr std::size_t kLeastTriangles = 16;
constexpr double kNear = 2.0;   ///< cells from a light: nearer ones are the near field
constexpr double kWorst = 4.0;  ///< a receiver may change by a quarter of what the mean may

/// Points spread evenly over the grid: the additive recurrence of the plastic number's sibling (Roberts 2018).
glm::dvec3 pointOf(std::size_t i, const CellBox& cells) {
  constexpr double g = 1.2207440846057594754;
  const glm::dvec3 alpha(1.0 / g, 1.0 / (g * g), 1.0 / (g * g * g));
  return glm::dvec3(cells.lower) + glm::dvec3(cells.upper - cells.lower) * glm::fract(0.5 + alpha * double(i + 1));
}

/// Directions spread evenly over the sphere: the same in two dimensions, area for area.
glm::dvec3 normalOf(std::size_t i) {
  constexpr double g = 1.32471795724474602596;
  const glm::dvec2 u = glm::fract(0.5 + glm::dvec2(1.0 / g, 1.0 / (g * g)) * double(i + 1));
  const double z = 1.0 - 2.0 * u.x, r = std::sqrt(std::max(0.0, 1.0 - z * z)), angle = 2.0 * sh::kPi * u.y;
  return {r * std::cos(angle), r * std::sin(angle), z};
}

/// Up to a third of the grid away from a light, where lights that are near one another are on two sides.
glm::dvec3 pointNear(const Outline& light, std::size_t i, const CellBox& cells) {
  const glm::dvec3 dims(cells.upper - cells.lower);
  const double share = glm::fract(0.618033988749894848 * double(i + 1));
  const double far = kNear + share * share * std::max({dims.x, dims.y, dims.z}) / 3.0;
  return glm::clamp(light.centre + (light.radius + far) * normalOf(i), glm::dvec3(cells.lower),
                    glm::dvec3(cells.upper));
}

void add(std::vector<double>& to, const std::vector<double>& from, double factor = 1.0) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * from[i];
}

double norm(const std::vector<double>& e) { return std::sqrt(std::inner_product(e.begin(), e.end(), e.begin(), 0.0)); }

/// 1 up to the median, its share of the value above.
std::vector<double> weightsOf(const std::vector<double>& values) {
  std::vector<double> sorted = values;
  const auto middle = sorted.begin() + std::ptrdiff_t(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  std::vector<double> out;
  for (const double value : values) out.push_back(value > *middle ? *middle / value : 1.0);
  return out;
}

}  // namespace

GroupingError::GroupingError(const std::vector<EmittingLight>& lights, const CellBox& cells) {
  const std::size_t count = std::max<std::size_t>(1, lights.size());
  std::vector<Outline> outlines;
  for (const EmittingLight& light : lights)
    outlines.push_back(outlineOf(light, std::max(kLeastTriangles, kTriangles / count)));
  for (std::size_t i = 0; i < std::clamp(kEvaluations / count, kLeastPoints, kMostPoints); ++i) {
    const bool near = i % 2 == 1 && !lights.empty();
    points_.push_back(near ? pointNear(outlines[i / 2 % count], i / 2, cells) : pointOf(i / 2, cells));
    for (std::size_t n = 0; n < kNormals; ++n) normals_.push_back(normalOf(i * kNormals + n));
  }
  std::vector<double> fluences(points_.size(), 0.0);
  for (const Outline& outline : outlines) {
    centres_.push_back(outline.centre);
    Field& field = fields_.emplace_back();
    for (std::size_t p = 0; p < points_.size(); ++p) {
      field.push_back(incidentAt(outline, points_[p]));
      fluences[p] += sh::fluence(field.back());
    }
  }
  weights_ = weightsOf(fluences);
  truth_.assign(normals_.size(), 0.0);
  for (const Field& field : fields_) add(truth_, lookedUp(field));
}

GroupingError::Irradiances GroupingError::lookedUp(const Field& field) const {
  Irradiances out;
  out.reserve(field.size() * kNormals);
  for (std::size_t i = 0; i < field.size() * kNormals; ++i)
    out.push_back(weights_[i / kNormals] * irradianceCap(field[i / kNormals], normals_[i]));
  return out;
}

GroupingError::Irradiances GroupingError::differences(const std::vector<Field>& layers) const {
  Irradiances e(normals_.size(), 0.0);
  for (const Field& layer : layers) add(e, lookedUp(layer));
  add(e, truth_, -1.0);
  return e;
}

double GroupingError::relative(const Irradiances& differences) const {
  const double whole = norm(truth_);
  return whole > 0.0 ? norm(differences) / whole : 0.0;
}

double GroupingError::of(const std::vector<int>& groups, int count) const {
  std::vector<Field> layers(std::size_t(count), Field(points_.size(), sh::Coefficients{}));
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (std::size_t p = 0; p < points_.size(); ++p) layers[std::size_t(groups[i])][p] += fields_[i][p];
  }
  const Irradiances apart = differences(layers);
  double worst = 0.0, brightest = 0.0;
  for (std::size_t i = 0; i < apart.size(); ++i) {
    worst = std::max(worst, std::abs(apart[i]) / weights_[i / kNormals]);
    brightest = std::max(brightest, truth_[i] / weights_[i / kNormals]);
  }
  return brightest > 0.0 ? std::max(relative(apart), kWorst * worst / brightest) : 0.0;
}

double GroupingError::of(Sectors sectors) const {
  std::vector<Field> layers(kSectors, Field(points_.size(), sh::Coefficients{}));
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const auto shares = sectorShares(sectors, centres_[i] - points_[p]);
      for (std::size_t s = 0; s < shares.size(); ++s) {
        if (shares[s] > 0.0) layers[s][p] += shares[s] * fields_[i][p];
      }
    }
  }
  return relative(differences(layers));
}

std::vector<int> GroupingError::dealt(int count) const {
  const std::size_t points = std::min(kDealingPoints, points_.size());
  const auto plus = [points](const Field& a, const Field& b) {
    Field sum(a.begin(), a.begin() + std::ptrdiff_t(points));
    for (std::size_t p = 0; p < points; ++p) sum[p] += b[p];
    return sum;
  };
  const Field dark(points, sh::Coefficients{});
  std::vector<Irradiances> own;
  std::vector<double> brightness;
  for (const Field& field : fields_) brightness.push_back(norm(own.emplace_back(lookedUp(plus(field, dark)))));
  std::vector<std::size_t> order(fields_.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return brightness[a] > brightness[b]; });
  std::vector<int> groups(fields_.size(), 0);
  std::vector<Field> sums(std::size_t(count), dark);
  std::vector<Irradiances> alone(std::size_t(count), lookedUp(dark));
  for (const std::size_t light : order) {
    double least = 0.0;
    int best = -1;
    for (int g = 0; g < count; ++g) {
      Irradiances harm = lookedUp(plus(fields_[light], sums[std::size_t(g)]));
      add(harm, alone[std::size_t(g)], -1.0);
      add(harm, own[light], -1.0);
      const double size = norm(harm);
      if (best < 0 || size < least) {
        best = g;
        least = size;
      }
    }
    groups[light] = best;
    sums[std::size_t(best)] = plus(fields_[light], sums[std::size_t(best)]);
    alone[std::size_t(best)] = lookedUp(sums[std::size_t(best)]);
  }
  return groups;
}

}  // namespace lpv
