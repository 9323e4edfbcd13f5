#pragma once
// How wrong lookups are when lights share layers: against a lookup per light, at points of the grid and normals spread
// over all directions.

#include <vector>

#include "lpv/transport/light_outline.h"
#include "lpv/transport/sectors.h"

namespace lpv {

class GroupingError {
 public:
  /// Takes 256 receivers in `cells`, the product's among those of the lights' grid; fewer for more than 64 lights.
  GroupingError(const std::vector<EmittingLight>& lights, const CellBox& cells);

  std::size_t lights() const { return fields_.size(); }

  /// Of a group per light: the larger of relative L2 over the receivers, where points that are brighter than most count
  /// as most do, and four times the worst receiver's error as a share of the brightest's irradiance.
  double of(const std::vector<int>& groups, int count) const;
  /// Of layers by direction: relative L2 alone.
  double of(Sectors sectors) const;

  /// Lights dealt into `count` groups: the brightest first, each into the group where it does the least harm.
  std::vector<int> dealt(int count) const;

 private:
  using Field = std::vector<sh::Coefficients>;  ///< per point
  using Irradiances = std::vector<double>;  ///< per receiver

  Irradiances lookedUp(const Field& field) const;
  Irradiances differences(const std::vector<Field>& layers) const;
  double relative(const Irradiances& differences) const;

  std::vector<glm::dvec3> points_;
  std::vector<glm::dvec3> normals_;  ///< kNormals per point
  std::vector<double> weights_;  ///< per point
  std::vector<glm::dvec3> centres_;  ///< per light
  std::vector<Field> fields_;  ///< per light
  Irradiances truth_;
};

}  // namespace lpv
