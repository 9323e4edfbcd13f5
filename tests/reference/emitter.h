#pragma once
// Lights taken apart into world triangles, ready for injection and for ground truth.

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "reference/snap.h"
#include "scene/grid.h"
#include "scene/scene.h"

namespace lpv::reference {

/// One triangle that emits constant radiance from its front (both sides when twoSided).
struct Emitter {
  SnappedTriangle snapped;            ///< decides pairs and area fractions, nothing else
  std::array<glm::dvec3, 3> corners;  ///< world, metres, unsnapped; counter-clockwise seen from the front
  glm::dvec3 radiance{0.0};           ///< W/(sr m^2)
  bool twoSided = false;

  /// Area times outward unit normal, m^2.
  glm::dvec3 areaNormal() const { return 0.5 * glm::cross(corners[1] - corners[0], corners[2] - corners[0]); }
  double area() const { return glm::length(areaNormal()); }
};

struct Emitters {
  std::vector<Emitter> triangles;
  std::size_t degenerate = 0;  ///< triangles of no area in world space: skipped
};

/// World from object out of translation, rotation and scale, composed from the definitions: p -> t + q (s p) q*.
glm::dmat4 worldFromObject(const Transform& transform);

/// A mesh under `worldFromObject`, in mesh order without the triangles of no area. A mirrored transform keeps the
/// object-space outer side: the winding is turned back.
Emitters emittersOf(const Grid& grid, const Mesh& mesh, const glm::dmat4& worldFromObject, const glm::dvec3& radiance,
                    bool twoSided);

/// A light without texture and directions; nothing when it is disabled. Uses Transform::worldFromObject(), so that
/// snapping starts from the same bits as the product; unit tests hold that matrix against the one above.
Emitters emittersOf(const Grid& grid, const Light& light);

/// Every light of a scene.
Emitters emittersOf(const Scene& scene);

/// Radiance of a light's front: as given, or power / (pi area sides), 0 for a light without area.
glm::dvec3 radianceOf(const Light& light);

/// Emitted power per colour, W: pi radiance area sides, summed.
glm::dvec3 powerOf(const std::vector<Emitter>& emitters);

}  // namespace lpv::reference
