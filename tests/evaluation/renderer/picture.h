#pragma once
// Reference pictures: linear radiance and what it is made of.

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "base/status.h"
#include "renderer/estimate.h"
#include "renderer/traced_scene.h"
#include "scene/camera.h"

namespace lpv::evaluation {

/// Which part of a pixel its radiance is the mean over.
enum class PixelFilter {
  kCentre,  ///< the ray through the centre, as the server renders
  kBox,     ///< the whole pixel, evenly
};

/// Rows from the top. Everything but radiance and its error is that of the ray through the pixel's centre, and 0 where
/// that meets no surface.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<int> levels;                        ///< numbers of bounces
  std::vector<std::vector<glm::vec3>> radiance;   ///< W/(sr m^2), per level
  std::vector<std::vector<glm::vec3>> radianceError;    ///< standard error
  std::vector<std::vector<glm::vec3>> irradiance;       ///< W/m^2 at the first hit, per level
  std::vector<std::vector<glm::vec3>> irradianceError;  ///< standard error
  std::vector<glm::vec3> direct;      ///< irradiance without bounces
  std::vector<glm::vec3> unoccluded;  ///< ... and nothing in the light's way
  std::vector<glm::vec3> unoccludedError;  ///< its standard error
  std::vector<glm::vec3> position;    ///< of the first hit, metres
  std::vector<glm::vec3> normal;      ///< unit, interpolated, towards the viewer
  std::vector<glm::vec3> flatNormal;  ///< unit, of the triangle, towards the viewer
  std::vector<glm::vec3> albedo;      ///< 0 for lights
  std::vector<glm::vec3> material;    ///< roughness, metalness, and 1 where a surface is glossy, if that is shown
  std::vector<float> object;          ///< 1 and up: lights, then surfaces, in the order of the scene; 0: nothing

  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
};

/// `exact`: as in estimateIrradiance(), for rays through pixel centres. `gloss`: surfaces that the camera sees have
/// lobes (renderer/gloss.h); else all are matte.
Picture renderPicture(const TracedScene& scene, const PathTracer& tracer, const Camera& camera, const glm::ivec2& size,
                      PixelFilter filter, const Sampling& sampling, const ClosedForm* exact = nullptr,
                      bool gloss = false);

/// Writes the picture at one level as OpenEXR, float, with named channels: R G B radiance, se radiance's standard
/// error, E irradiance, Ese its standard error, D direct, U unoccluded, Use its standard
/// error, P position, N normal, G flat normal, A albedo,
/// M roughness, metalness and gloss, object.
Status writeExr(const std::string& path, const Picture& picture, std::size_t level);

}  // namespace lpv::evaluation
