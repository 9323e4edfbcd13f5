#pragma once
// What a surface reflects like a mirror, sharply or not: a GGX lobe with Schlick's Fresnel term, and energy for what
// bounces between its facets (MATHS.md 3e; Walter et al. 2007; Heitz 2014; Turquin 2019). The GLSL twin is
// shaders/frame/gloss.glsl.

#include <glm/glm.hpp>
#include <vector>

#include "scene/scene.h"

namespace lpv {

/// Reflectance of dielectrics straight on.
inline constexpr double kDielectricReflectance = 0.04;
/// Of GGX, at least: a mirror for all that a picture shows.
inline constexpr double kLeastAlpha = 1e-4;

/// Whether a surface has a lobe; others are matte: they reflect in all directions alike.
bool isGlossy(const Surface& surface);
/// Whether frames of the scene show some that have.
bool showsGloss(const Scene& scene);

/// A surface's lobe where it is seen from one direction. Directions are unit vectors away from the surface.
struct GlossLobe {
  glm::dvec3 straight{0.04};  ///< reflectance straight on, per colour
  double alpha = 1.0;         ///< of GGX

  static GlossLobe of(const glm::dvec3& albedo, double roughness, double metalness);
  /// Without what bounces between facets, 1/sr.
  glm::dvec3 single(const glm::dvec3& n, const glm::dvec3& v, const glm::dvec3& l) const;
  /// A direction of the lobe, by facets that are seen from v (Dupuy and Benyoub 2023); it may go below the surface. u
  /// in [0, 1)^2.
  glm::dvec3 direction(const glm::dvec3& n, const glm::dvec3& v, const glm::dvec2& u) const;
  /// Of direction(), per sr.
  double density(const glm::dvec3& n, const glm::dvec3& v, const glm::dvec3& l) const;
};

/// What a lobe reflects in all of light that comes evenly from everywhere: the share of each reflectance straight on,
/// and what comes to it at the edge.
struct GlossShare {
  double straight = 0.0;
  double edge = 0.0;

  /// Of facets that reflect all.
  double all() const { return straight + edge; }
  /// By how much a lobe is brighter by what bounces between facets.
  glm::dvec3 gain(const glm::dvec3& reflectance) const;
  /// With the gain; at most 1.
  glm::dvec3 of(const glm::dvec3& reflectance) const;
};

/// Seen under the cosine `mu` with the normal, above 0. By so many directions: around the view, and away from it.
GlossShare glossShare(double mu, double alpha, const glm::ivec2& samples = {16, 128});

/// Of roughness in rows and cosine in columns, kGlossTable each, at ((i + .5) / kGlossTable).
inline constexpr int kGlossTable = 32;
const std::vector<glm::vec2>& glossTable();

}  // namespace lpv
