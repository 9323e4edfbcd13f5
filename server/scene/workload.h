#pragma once
// Amount of work in a tick of a session, computed from its scene. Admission turns it into a predicted duration before
// anything runs.

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace lpv {

/// Work of a tick without any cached result: everything is uploaded, voxelized, transported to every cell and read
/// back. Frames are not included. Sizes of lights are bounds or estimates (VPLs), right to a factor of a few.
class Workload {
 public:
  Workload() = default;
  /// `options`: resolved settings (scene/error_goal.h).
  Workload(const LightingSettings& options, const Grid& grid);
  void add(const Light& light);
  void add(const Surface& surface);

  Transport transport = Transport::kGather;
  int iterations = 0;          ///< PROPAGATE
  double cells = 0.0;
  double lights = 0.0;            ///< enabled lights
  double lightTriangles = 0.0;
  double columns = 0.0;           ///< columns of cells that lights' triangles meet, summed over triangles
  double litCells = 0.0;          ///< cells that lights' surfaces pass through, summed over lights
  double rootsOfEntries = 0.0;    ///< sum over lights of the square root of its tree's size
  double bytes = 0.0;             ///< bytes of meshes and textures

  bool operator==(const Workload&) const = default;

  /// Channels of the field, 1..3.
  int channels() const { return std::max(1, int(colours_.size())); }
  /// Layers of the field: the scene's groups; where it names none and the server groups, one per light while they are
  /// few, which may be more than are needed, else the sectors' of directions.
  int groups() const;
  /// Whether layers are by the direction that light comes from.
  bool byDirection() const { return automatic() && lights > kMaxGroups; }

 private:
  void addDistant();
  bool automatic() const;
  void countColour(const glm::dvec3& radiance);
  void countMesh(const Mesh& mesh);

  double gridFromWorld_ = 1.0;  ///< cells per metre
  double face_ = 1.0;  ///< cells of the grid's longest edge, squared
  std::vector<glm::dvec3> colours_;
  std::set<std::string> groups_;
  bool groupsItself_ = false;
};

}  // namespace lpv
