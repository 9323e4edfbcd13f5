#pragma once
// Two-band real spherical harmonics, from their definition (MATHS.md 1). Constants are computed, not typed.

#include <functional>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "reference/field.h"

namespace lpv::reference {

double pi();

/// The orthonormal basis in unit direction w: (Y00, Y1-1, Y10, Y11) = (1/sqrt(4 pi), sqrt(3/(4 pi)) (y, z, x)).
Coefficients basis(const glm::dvec3& w);

/// Clamped cosine lobe about unit n on two bands: zonal factors A0 = pi and A1 = 2 pi / 3 times the basis in n
/// (Ramamoorthi & Hanrahan 2001).
Coefficients lobe(const glm::dvec3& n);

/// The function value that 4 coefficients stand for, in unit direction w.
double evaluate(const Coefficients& c, const glm::dvec3& w);

/// Integral of f over the sphere by Gauss-Legendre quadrature in the cosine about `axis`, each hemisphere on its own
/// (exact for polynomials, and for polynomials clamped at the horizon of `axis`).
double integrate(const std::function<double(const glm::dvec3&)>& f, const glm::dvec3& axis = {0, 0, 1});

/// Projection of f on the basis by `integrate`.
Coefficients project(const std::function<double(const glm::dvec3&)>& f, const glm::dvec3& axis = {0, 0, 1});

/// Nodes and weights of n-point Gauss-Legendre quadrature on [0, 1].
std::vector<std::pair<double, double>> gaussLegendre(int n);

}  // namespace lpv::reference
