#pragma once
// What stands between two points, triangle by triangle in double precision, and segments that are hard to answer for.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/occluders.h"

namespace lpv::reference {

struct Segment {
  glm::dvec3 from{0.0}, to{0.0};
};

enum class Meeting { kNone, kSome, kUnclear };

/// The triangles of occluders in one space. Every question looks at all of them.
class Occlusion {
 public:
  /// `spaceFromWorld`: the space of the questions.
  explicit Occlusion(const std::vector<Occluder>& occluders, const glm::dmat4& spaceFromWorld = glm::dmat4(1.0));

  /// Whether a triangle lies strictly between, for light of `light`. kUnclear where that depends on less than `margin`
  /// of a triangle's barycentric coordinates or of the segment's length.
  Meeting meeting(const Segment& segment, int light, double margin) const;

 private:
  struct Triangle {
    glm::dvec3 corners[3];
    int blocks;
  };
  std::vector<Triangle> triangles_;
};

/// Random segments whose ends lie in a box, from `seed`.
std::vector<Segment> randomSegments(std::size_t count, const glm::dvec3& lower, const glm::dvec3& upper,
                                    std::uint32_t seed);

/// Segments from `from` through vertices, middles of edges and random points of edges of an occluder to twice as far:
/// they meet a closed mesh that `from` lies in, whichever of the triangles around the edge they are said to meet.
/// Numbers that floats hold.
std::vector<Segment> segmentsThroughEdges(const Occluder& occluder, const glm::dvec3& from, std::size_t count,
                                          const glm::dmat4& spaceFromWorld = glm::dmat4(1.0));

/// About an axis that is askew.
glm::dmat4 turn(double angle);
/// A mesh whose own vertices are turned.
MeshPtr turned(const MeshPtr& mesh, double angle);

}  // namespace lpv::reference
