#pragma once
// Patches that something parts, such as those of a floor below the wall between two rooms, or below a pane: one for
// each side, since each side sends its own light to its own room (MATHS.md 3d.4).

#include <cstdint>
#include <glm/glm.hpp>

#include "scene/patches.h"

namespace lpv {

/// The k-th of layout::kPatchPlaces places that are spread evenly over a triangle; as placeAt() of
/// shaders/visibility/patches.glsl.
glm::dvec3 placeOfTriangle(const Patch& patch, int k);
/// A place that a patch stands for, u in [0, 1)^2: any of its triangle, or where that is parted one of `places`.
glm::dvec3 ownPlace(const Patch& patch, glm::dvec2 u);
/// How much of its triangle a patch stands for; and of what the whole would send to a point with unit normal n.
double ownShare(const Patch& patch);
double ownShare(const Patch& patch, const glm::dvec3& at, const glm::dvec3& n);
/// What a place on a patch sends to a point with unit normal n, beside others.
double sentFrom(const Patch& patch, const glm::dvec3& place, const glm::dvec3& at, const glm::dvec3& n);

/// The scene's patches, each triangle once for each of the sides to which surfaces part it: places are on one side if
/// one can be reached from the other along the surface or over what stands on it, such as a ledge. A side of one place
/// is left out, and one that sees nothing but what is close, as below a leg; with one side left the triangle stays one
/// patch. A quarter more patches are the most: of triangles after that the largest side alone is kept. Those before
/// stay where they are.
PatchedScene parted(const PatchedScene& patched, const Scene& scene);

}  // namespace lpv
