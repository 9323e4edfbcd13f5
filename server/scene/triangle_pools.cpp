#include "scene/triangle_pools.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <queue>

namespace lpv {

namespace {

using Place = std::array<double, 6>;  // of a triangle's middle, and of its normal

struct Pool {
  std::size_t begin = 0, end = 0;  // of the order
  Place mean{};
  std::size_t axis = 0;  // along which it is widest
  double spread = 0.0;   // in all

  bool operator<(const Pool& other) const { return spread < other.spread; }
};

class Halving {
 public:
  Halving(std::span<const PooledTriangle> triangles, double turned) : triangles_(triangles), order_(triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    places_.reserve(triangles.size());
    for (const PooledTriangle& t : triangles) {
      const glm::dvec3 p(t.middle), n = turned * glm::dvec3(t.normal);
      places_.push_back({p.x, p.y, p.z, n.x, n.y, n.z});
    }
  }

  Pool pool(std::size_t begin, std::size_t end) const {
    Place mean{}, squares{};
    double area = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      const double a = triangles_[order_[i]].area;
      area += a;
      for (std::size_t k = 0; k < mean.size(); ++k) mean[k] += a * places_[order_[i]][k];
    }
    for (double& m : mean) m /= area;
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t k = 0; k < mean.size(); ++k) {
        const double off = places_[order_[i]][k] - mean[k];
        squares[k] += triangles_[order_[i]].area * off * off;
      }
    }
    const auto axis = std::size_t(std::max_element(squares.begin(), squares.end()) - squares.begin());
    return {begin, end, mean, axis, std::accumulate(squares.begin(), squares.end(), 0.0)};
  }

  /// Where its second half begins; its begin or end: it has none.
  std::size_t halve(const Pool& pool) {
    const auto first = order_.begin() + std::ptrdiff_t(pool.begin), last = order_.begin() + std::ptrdiff_t(pool.end);
    const auto isBefore = [&](std::uint32_t i) { return places_[i][pool.axis] < pool.mean[pool.axis]; };
    return std::size_t(std::stable_partition(first, last, isBefore) - order_.begin());
  }

  std::span<const std::uint32_t> trianglesOf(const Pool& pool) const {
    return std::span(order_).subspan(pool.begin, pool.end - pool.begin);
  }

  std::uint32_t central(const Pool& pool) const {
    const auto distance2 = [&](std::uint32_t i) {
      double sum = 0.0;
      for (std::size_t k = 0; k < pool.mean.size(); ++k) {
        const double off = places_[i][k] - pool.mean[k];
        sum += off * off;
      }
      return sum;
    };
    return std::ranges::min(trianglesOf(pool), {}, distance2);
  }

 private:
  std::span<const PooledTriangle> triangles_;
  std::vector<Place> places_;
  std::vector<std::uint32_t> order_;
};

}  // namespace

TrianglePools poolsOf(std::span<const PooledTriangle> triangles, std::size_t count, double turned) {
  TrianglePools out{std::vector<std::uint32_t>(triangles.size()), {}};
  if (triangles.empty()) return out;
  Halving halving(triangles, turned);
  std::priority_queue<Pool> open;
  std::vector<Pool> pools;
  open.push(halving.pool(0, triangles.size()));
  while (!open.empty() && open.size() + pools.size() < count) {
    const Pool pool = open.top();
    open.pop();
    const std::size_t middle = halving.halve(pool);
    if (middle == pool.begin || middle == pool.end) {
      pools.push_back(pool);
      continue;
    }
    open.push(halving.pool(pool.begin, middle));
    open.push(halving.pool(middle, pool.end));
  }
  for (; !open.empty(); open.pop()) pools.push_back(open.top());
  std::ranges::sort(pools, {}, &Pool::begin);
  for (const Pool& pool : pools) {
    for (const std::uint32_t i : halving.trianglesOf(pool)) out.poolOf[i] = std::uint32_t(out.central.size());
    out.central.push_back(halving.central(pool));
  }
  return out;
}

}  // namespace lpv
