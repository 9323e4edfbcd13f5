#pragma once
// Pictures in double: one ray through each pixel centre against every triangle, irradiance from a volume.

#include <glm/glm.hpp>
#include <vector>

#include "scene/camera.h"
#include "scene/options.h"
#include "scene/scene.h"
#include "scene/volume.h"

namespace lpv::reference {

/// What a pixel shows; a picture's edges are where neighbours differ in it.
struct Seen {
  int object = -1;         ///< index among the lights, then the surfaces, in name order; -1 is background
  double depth = 0.0;      ///< along the view direction, metres
  glm::dvec3 normal{0.0};  ///< unit shading normal towards the viewer (two-sided) or of the front
};

/// Linear radiance of the scene from a camera, W/(sr m^2), rows from the top.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<glm::dvec3> radiance;
  std::vector<Seen> seen;

  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
};

struct RenderOptions {
  int width = 192;
  int height = 108;
  Lookup lookup = Lookup::kSh2;
  /// A one-sided light seen from behind: true shows it black, as Pick finds it there; false lets the ray pass.
  bool lightBacksAreOpaque = true;
};

/// Nearest hit of every pixel between the camera's near and far planes. A light shows radiance x texture, from its
/// front only unless two-sided. A surface shows albedo x texture x E / pi, E the sum over the volume's layers of the
/// lookup at the hit, 0 where the volume cannot tell. A one-sided surface is not seen from behind. Normals: vertex
/// normals interpolated and normalised where the mesh has them, else the triangle's; turned over when the viewer sees
/// the back of a two-sided surface's triangle. Background is 0. Textures: bilinear, level 0, repeat.
Picture render(const Scene& scene, const Volume& volume, const Camera& camera, const RenderOptions& options = {});

/// True for pixels whose 3x3 neighbourhood is one object without a jump in depth or a crease: where coverage rules
/// cannot make two renderers differ.
std::vector<bool> interiorOf(const Picture& picture);

}  // namespace lpv::reference
