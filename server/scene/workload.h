#pragma once
// How much there is to be done for a tick of a session, as far as it follows from its scene: what admission is decided
// by, before anything runs.

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace lpv {

/// Of a tick that starts from nothing: everything uploaded, voxelized, transported to every cell and read back. Frames
/// come on top, and go by their own size. Sizes of lights are bounds or estimates (VPLs), good to a factor of a few.
class Workload {
 public:
  Workload() = default;
  /// `options` as they are carried out (scene/error_goal.h).
  Workload(const LightingSettings& options, const Grid& grid);
  void add(const Light& light);
  void add(const Surface& surface);

  Transport transport = Transport::kGather;
  int iterations = 0;          ///< PROPAGATE
  double cells = 0.0;
  double lights = 0.0;            ///< that are switched on
  double lightTriangles = 0.0;
  double columns = 0.0;           ///< of cells that lights' triangles meet, each triangle by itself
  double litCells = 0.0;          ///< that hold a light's part, each light by itself
  double rootsOfRecords = 0.0;    ///< square roots of the sizes of the lights' trees
  double bytes = 0.0;             ///< of meshes and textures

  bool operator==(const Workload&) const = default;

  /// Chromaticities that are kept apart, 1..3.
  int channels() const { return std::max(1, int(colours_.size())); }
  int groups() const { return std::max(1, int(groups_.size())); }

 private:
  void countColour(const glm::dvec3& radiance);
  void countMesh(const Mesh& mesh);

  double gridFromWorld_ = 1.0;  ///< cells per metre
  double face_ = 1.0;           ///< cells of the grid's longest edge, squared
  std::vector<glm::dvec3> colours_;
  std::set<std::string> groups_;
};

}  // namespace lpv
