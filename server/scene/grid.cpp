#include "scene/grid.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <string>

namespace lpv {
namespace {

/// A quotient this little above a whole number is rounded down: bounds are rarely exact multiples in binary.
constexpr double kRoundingSlack = 1e-9;

Status checkCells(const std::string& field, int cells) {
  if (cells >= 1 && cells <= kMaxCellsPerAxis) return {};
  return invalid(field, "grid." + field + " is " + std::to_string(cells) + ", allowed are 1.." +
                            std::to_string(kMaxCellsPerAxis) + " cells along an axis");
}

Status checkSize(const GridOptions& options) {
  if (options.dims != glm::ivec3(0)) {
    for (int axis = 0; axis < 3; ++axis) {
      const Status status = checkCells(std::string("dims.") + "xyz"[axis], options.dims[axis]);
      if (!status.ok()) return status;
    }
    return {};
  }
  return options.longest == 0 ? Status() : checkCells("longest", options.longest);
}

Status checkBounds(const Bounds& b) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    if (!std::isfinite(b.min[axis]) || !std::isfinite(b.max[axis])) {
      return invalid("bounds", "grid.bounds must be finite, its " + name + " is not");
    }
    if (b.min[axis] > b.max[axis]) {
      return invalid("bounds", "grid.bounds is inside out: min." + name + " = " + std::to_string(b.min[axis]) +
                                   " is above max." + name + " = " + std::to_string(b.max[axis]));
    }
    if (std::abs(b.min[axis]) > 1e9 || std::abs(b.max[axis]) > 1e9) {
      return invalid("bounds", "grid.bounds reaches beyond 1e9 m along " + name + "; move the scene to the origin");
    }
  }
  const glm::dvec3 extent = b.extent();
  if (std::max({extent.x, extent.y, extent.z}) < 1e-6) {
    return invalid("bounds", "grid.bounds is smaller than 1e-6 m along every axis");
  }
  return {};
}

/// Cells along each axis for cubic cells of edge `cell`, never above the limit: rounding alone could pass it.
glm::ivec3 cellsFor(const glm::dvec3& extent, double cell) {
  const glm::dvec3 exact = extent / cell;
  return glm::clamp(glm::ivec3(glm::ceil(exact - kRoundingSlack * glm::max(exact, glm::dvec3(1.0)))), glm::ivec3(1),
                    glm::ivec3(kMaxCellsPerAxis));
}

/// A grid over `bounds` that leaves `margin` cells free on each side.
Grid gridAround(const GridOptions& options, const Bounds& bounds, int margin) {
  const glm::dvec3 extent = bounds.extent();
  Grid grid;
  if (options.dims != glm::ivec3(0)) {
    const glm::dvec3 usable = glm::max(glm::dvec3(options.dims - 2 * margin), glm::dvec3(0.5));
    const glm::dvec3 cells = extent / usable;
    grid.cell = std::max({cells.x, cells.y, cells.z});
    grid.dims = options.dims;
    if (margin == 0) {
      grid.origin = bounds.min;
    } else {
      grid.origin = bounds.centre() - glm::dvec3(grid.dims) * (grid.cell * 0.5);
    }
    return grid;
  }
  const int longest = options.longest == 0 ? kDefaultCellsOfLongestEdge : options.longest;
  const double usable = std::max(longest - 2 * margin, 1);
  grid.cell = std::max({extent.x, extent.y, extent.z}) / usable;
  grid.dims = glm::min(cellsFor(extent, grid.cell) + 2 * margin, glm::ivec3(longest));
  grid.origin = bounds.min - glm::dvec3(margin) * grid.cell;
  return grid;
}

}  // namespace

glm::dmat4 Grid::gridFromWorldMatrix() const {
  return glm::translate(glm::scale(glm::dmat4(1.0), glm::dvec3(1.0 / cell)), -origin);
}

Expected<Grid> makeGrid(const GridOptions& options, const Bounds& bounds) {
  if (Status status = checkSize(options); !status.ok()) return status;
  if (Status status = checkBounds(bounds); !status.ok()) return status;
  return gridAround(options, bounds, 0);
}

Expected<Grid> fitGrid(const GridOptions& options, const Bounds& content) {
  if (Status status = checkSize(options); !status.ok()) return status;
  Bounds box = content;
  if (box.empty()) box = {glm::dvec3(-0.5), glm::dvec3(0.5)};
  const glm::dvec3 extent = box.extent();
  if (std::max({extent.x, extent.y, extent.z}) < 1e-6) box = {box.centre() - 0.5, box.centre() + 0.5};
  if (Status status = checkBounds(box); !status.ok()) return status;
  const glm::ivec3 d = options.dims;
  const int smallest = d != glm::ivec3(0) ? std::min({d.x, d.y, d.z})
                                          : (options.longest == 0 ? kDefaultCellsOfLongestEdge : options.longest);
  // A grid too coarse for the whole margin keeps at least one cell for the content.
  return gridAround(options, box, std::min(kFitMarginCells, (smallest - 1) / 2));
}

}  // namespace lpv
