#include "reference/propagate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "reference/ground_truth.h"
#include "reference/sh.h"

namespace lpv::reference {
namespace {

glm::ivec3 unit(int axis, int sign) {
  glm::ivec3 v(0);
  v[axis] = sign;
  return v;
}

/// Solid angle from the origin of the unit square about `centre`, spanned by unit u and v.
double squareSolidAngle(const glm::dvec3& centre, const glm::dvec3& u, const glm::dvec3& v) {
  const glm::dvec3 a = centre - 0.5 * u - 0.5 * v;
  const glm::dvec3 b = centre + 0.5 * u - 0.5 * v;
  const glm::dvec3 c = centre + 0.5 * u + 0.5 * v;
  const glm::dvec3 d = centre - 0.5 * u + 0.5 * v;
  return triangleSolidAngle(a, b, c) + triangleSolidAngle(a, c, d);
}

/// One of the five faces through which light travelling along m enters a cell and is sent on.
struct Face {
  Coefficients towards;  ///< basis in the direction from the neighbour's centre to the face's centre
  Coefficients sentOn;   ///< solid angle / pi times the lobe about the face's outward normal
};

/// The 5 faces for travel along the axis vector m.
std::array<Face, 5> facesFor(const glm::ivec3& m) {
  const FaceSolidAngles angles = faceSolidAngles();
  const glm::dvec3 along(m);
  std::array<Face, 5> faces;
  faces[0] = {basis(along), angles.front / pi() * lobe(along)};
  std::size_t next = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (m[axis] != 0) continue;
    for (int sign : {-1, 1}) {
      const glm::dvec3 t(unit(axis, sign));
      faces[next++] = {basis(glm::normalize(2.0 * along + t)), angles.side / pi() * lobe(t)};
    }
  }
  return faces;
}

template <typename Step>
Field accumulate(const Field& injected, int iterations, Step step) {
  Field sum = injected;
  Field u = injected;
  for (int i = 0; i < iterations; ++i) {
    u = step(u);
    for (std::size_t c = 0; c < sum.cells.size(); ++c) {
      for (std::size_t colour = 0; colour < 3; ++colour) sum.cells[c][colour] += u.cells[c][colour];
    }
  }
  return sum;
}

/// Band 1 along a world axis: coefficients are stored (L00, y, z, x).
double along(const Coefficients& c, int axis) { return c[axis == 0 ? 3 : axis]; }
double& along(Coefficients& c, int axis) { return c[axis == 0 ? 3 : axis]; }

}  // namespace

FaceSolidAngles faceSolidAngles() {
  const glm::dvec3 x(1, 0, 0);
  const glm::dvec3 y(0, 1, 0);
  const glm::dvec3 z(0, 0, 1);
  return {squareSolidAngle(1.5 * z, x, y), squareSolidAngle(z + 0.5 * x, y, z)};
}

Field stepFaces(const Field& u, bool clampFaces) {
  Field next(u.dims);
  for (int axis = 0; axis < 3; ++axis) {
    for (int sign : {-1, 1}) {
      const glm::ivec3 m = unit(axis, sign);
      const std::array<Face, 5> faces = facesFor(m);
      forEachCell(u.dims, [&](const glm::ivec3& cell) {
        const glm::ivec3 neighbour = cell - m;
        if (!u.contains(neighbour)) return;
        for (std::size_t colour = 0; colour < 3; ++colour) {
          for (const Face& face : faces) {
            const double intensity = glm::dot(u.at(neighbour)[colour], face.towards);
            next.at(cell)[colour] += (clampFaces ? std::max(0.0, intensity) : intensity) * face.sentOn;
          }
        }
      });
    }
  }
  return next;
}

Stencil stencil() {
  const auto [front, side] = faceSolidAngles();
  const double root3 = std::sqrt(3.0);
  const double root5 = std::sqrt(5.0);
  return {(front + 4.0 * side) / (4.0 * pi()), root3 / (4.0 * pi()) * (front + 8.0 * side / root5),
          front / (2.0 * pi() * root3), front / (2.0 * pi()), side / (pi() * root5)};
}

Field stepStencil(const Field& u) {
  const Stencil k = stencil();
  Field next(u.dims);
  forEachCell(u.dims, [&](const glm::ivec3& cell) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int sign : {-1, 1}) {
        const glm::ivec3 neighbour = cell - unit(axis, sign);
        if (!u.contains(neighbour)) continue;
        for (std::size_t colour = 0; colour < 3; ++colour) {
          const Coefficients& from = u.at(neighbour)[colour];
          Coefficients& to = next.at(cell)[colour];
          to.x += k.a00 * from.x + sign * k.a01 * along(from, axis);
          along(to, axis) += sign * k.a10 * from.x + k.a11 * along(from, axis);
          for (int other : {(axis + 1) % 3, (axis + 2) % 3}) along(to, other) += k.b * along(from, other);
        }
      }
    }
  });
  return next;
}

Field propagateFaces(const Field& injected, int iterations, bool clampFaces) {
  return accumulate(injected, iterations, [&](const Field& u) { return stepFaces(u, clampFaces); });
}

Field propagateStencil(const Field& injected, int iterations) {
  return accumulate(injected, iterations, [](const Field& u) { return stepStencil(u); });
}

}  // namespace lpv::reference
