#pragma once
// PROPAGATE (Kaplanyan & Dachsbacher 2010; MATHS.md 3a) in double, twice: face by face as published, and as the
// stencil of five constants that the unclamped form amounts to. Fields hold SH of intensity in directions of travel.

#include <glm/glm.hpp>

#include "reference/field.h"

namespace lpv::reference {

/// Solid angles of a cell's faces seen from a neighbour's centre at distance 1, sr.
struct FaceSolidAngles {
  double front = 0.0;  ///< Of: the face opposite the neighbour
  double side = 0.0;   ///< Os: each of the four others that light passing through the shared face can reach
};

/// From the faces' own corners: each square as two triangles (Van Oosterom & Strackee 1983), the side faces only.
FaceSolidAngles faceSolidAngles();

/// One step: every cell gathers from 6 neighbours through 5 faces each; nothing comes from outside the grid.
/// `clampFaces` cuts each face's intensity at 0 per colour as K&D's code does (and adds energy).
Field stepFaces(const Field& u, bool clampFaces = false);

/// The stencil's constants, derived from the solid angles.
struct Stencil {
  double a00, a01, a10, a11, b;
};
Stencil stencil();

/// One unclamped step by the stencil.
Field stepStencil(const Field& u);

/// The sum of the injected field and of its `iterations` steps.
Field propagateFaces(const Field& injected, int iterations, bool clampFaces = false);
Field propagateStencil(const Field& injected, int iterations);

}  // namespace lpv::reference
