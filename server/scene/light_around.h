#pragma once
// All the light at a point that is on no surface, by looking at the lights themselves: for what stands there and is
// shaded by a client.

#include <array>
#include <glm/glm.hpp>

#include "scene/emitter_list.h"
#include "scene/lookup.h"
#include "scene/options.h"
#include "scene/patches.h"
#include "scene/volume.h"

namespace lpv {

/// Real, orthonormal spherical harmonics up to band 2 without the Condon-Shortley sign, in the order of WebXR Lighting
/// Estimation: (00, 1-1, 10, 11, 2-2, 2-1, 20, 21, 22); with w = (x, y, z)
///   1/(2 sqrt pi); sqrt(3/4pi) (y, z, x); sqrt(15/4pi) (xy, yz), sqrt(5/16pi) (3z^2 - 1), sqrt(15/4pi) xz,
///   sqrt(15/16pi) (x^2 - y^2).
using Harmonics = std::array<double, 9>;
Harmonics harmonicsOf(const glm::dvec3& w);

/// The directional light that is most like all the light: in the direction of vector irradiance, with the irradiance
/// per colour that makes the squared difference of the nine coefficients least.
struct MainLight {
  glm::dvec3 direction{0.0, 1.0, 0.0};  ///< unit, towards it; up where there is none
  glm::dvec3 irradiance{0.0};           ///< W/m^2, on a surface that faces it; at least 0
};

struct LightAround {
  std::array<glm::dvec3, 9> radiance{};  ///< per colour, harmonics of incident radiance, W/(sr m^2), towards the light

  /// A light of small or round solid angle. Bands 0 and 1 are exact; band 2 is that of the cap with the same two.
  void add(const Arriving& light, const glm::dvec3& radiance);
  /// Fluence, W/m^2, from one direction.
  void addFrom(const glm::dvec3& direction, const glm::dvec3& fluence);
  /// Counter-clockwise seen from its front, relative to the receiver; in pieces where it fills much of the sky.
  /// `turn`: a rotation from the corners' space.
  void addTriangle(const glm::dvec3 (&corners)[3], int sides, const glm::dvec3& radiance, const glm::dmat3& turn);
  /// A patch of a surface, seen from `at`.
  void addPatch(const Patch& patch, const glm::dvec3& at, const glm::dvec3& radiance);
  void add(const LightAround& other);

  MainLight mainLight() const;
};

/// From the lights of Volume::direct with what is in their way and what surfaces reflect; without it, or with
/// `volumeOnly`, from the volume, which has no band 2. `valid` is false where that has no answer.
struct LightAnswer {
  LightAround light;
  bool valid = true;
};
LightAnswer lightAround(const Volume& volume, Lookup lookup, const glm::dvec3& at, bool volumeOnly);

/// The k-th of so many directions spread evenly over the sphere: a spiral (Vogel 1979).
glm::dvec3 directionAround(int k, int count);
/// The same over the half sphere about a normal, by their cosine.
glm::dvec3 directionAbout(const glm::dvec3& n, int k, int count);

/// Of kRaysAround fixed rays, those that first meet the back of a surface: a point inside of something solid has many.
inline constexpr int kRaysAround = 64;
/// From so many on a point counts as inside: a quarter.
inline constexpr int kBackFacesInside = 16;
/// None with Volume::direct or its visibility missing: then nothing is in the way of light.
int backFacesAround(const Volume& volume, const glm::dvec3& at);

}  // namespace lpv
