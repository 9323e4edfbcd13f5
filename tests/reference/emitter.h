#pragma once
// Lights taken apart into world triangles, ready for injection and for ground truth.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "reference/mipmap.h"
#include "reference/snap.h"
#include "scene/grid.h"
#include "scene/scene.h"

namespace lpv::reference {

/// Shorter than this, a direction mixed from unit directions points nowhere: the geometric normal stands in for it.
inline constexpr double kZeroDirection = 1e-6;

/// v at unit length, or `fallback` where v is no longer than kZeroDirection.
glm::dvec3 unitOr(const glm::dvec3& v, const glm::dvec3& fallback);

/// A light whose mesh's box, cells, is narrower than this along two of its axes is thin.
inline constexpr double kThinLight = 2.0;

/// One triangle that emits radiance (times the texture's, where it has one) from its front (both sides when twoSided),
/// about its normal or about the directions given at its corners. All per-corner members have one order.
struct Emitter {
  SnappedTriangle snapped;            ///< decides pairs and area fractions, nothing else
  std::array<glm::dvec3, 3> corners;  ///< world, metres, unsnapped; counter-clockwise seen from the front
  glm::dvec3 radiance{0.0};           ///< W/(sr m^2)
  bool twoSided = false;
  std::uint32_t triangle = 0;         ///< index in the mesh, those of no area included
  bool swapped = false;               ///< corners 1 and 2 are the mesh's 2 and 1: a mirrored transform
  bool thin = false;                  ///< of a thin light: within a cell no flat square
  std::array<glm::dvec2, 3> uvs{};    ///< (0,0) is the outer corner of the texture's first texel; any size, repeat
  MipChainPtr texture;                ///< multiplies radiance, or null
  std::optional<std::array<glm::dvec3, 3>> directions;  ///< emission directions, world, unit length

  /// Area times outward unit normal, m^2.
  glm::dvec3 areaNormal() const { return 0.5 * glm::cross(corners[1] - corners[0], corners[2] - corners[0]); }
  double area() const { return glm::length(areaNormal()); }
  glm::dvec3 normal() const { return areaNormal() / area(); }

  // At barycentric coordinates b, which may lie outside the triangle.
  glm::dvec3 positionAt(const glm::dvec3& b) const;
  glm::dvec2 uvAt(const glm::dvec3& b) const;
  /// Unit: the corners' directions mixed and normalised; the normal where there are none or where they cancel.
  glm::dvec3 directionAt(const glm::dvec3& b) const;
};

struct Emitters {
  std::vector<Emitter> triangles;
  std::size_t degenerate = 0;  ///< triangles of no area in world space: skipped
};

/// World from object out of translation, rotation and scale, composed from the definitions: p -> t + q (s p) q*.
glm::dmat4 worldFromObject(const Transform& transform);

/// A mesh under `worldFromObject`, in mesh order without the triangles of no area. A mirrored transform keeps the
/// object-space outer side: the winding is turned back. The mesh's directions are transformed by the linear part (never
/// by its inverse transpose) and normalised at each corner; a corner whose direction is zero there has the triangle's
/// normal. A texture counts only on a mesh with uvs.
Emitters emittersOf(const Grid& grid, const Mesh& mesh, const glm::dmat4& worldFromObject, const glm::dvec3& radiance,
                    bool twoSided, const MipChainPtr& texture = nullptr);

/// A light; nothing when it is disabled. Uses Transform::worldFromObject(), so that
/// snapping starts from the same bits as the product; unit tests hold that matrix against the one above.
Emitters emittersOf(const Grid& grid, const Light& light);

/// Every light of a scene.
Emitters emittersOf(const Scene& scene);

/// Radiance of a light's front before its texture: as given, or power / (pi area sides), 0 for a light without area.
glm::dvec3 radianceOf(const Light& light);

/// Emitted power per colour, W: pi sides times the area integral of radiance x texture, summed.
glm::dvec3 powerOf(const std::vector<Emitter>& emitters);

}  // namespace lpv::reference
