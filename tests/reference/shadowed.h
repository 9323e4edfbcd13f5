#pragma once
// Irradiance through what stands in the way: lights in small pieces, each seen or not (MATHS.md 3d).

#include <vector>

#include "reference/emitter.h"
#include "reference/occlusion.h"
#include "reference/receivers.h"
#include "scene/scene.h"

namespace lpv::reference {

/// Direct light of a scene with its surfaces in the way. A light blocks only its own light.
class ShadowedLights {
 public:
  /// `pieces` along each edge of a light's triangle: its square is how many pieces a triangle is cut into.
  ShadowedLights(const Scene& scene, int pieces);

  /// W/m^2. A piece counts where nothing lies between its middle and the receiver.
  glm::dvec3 irradiance(const Receiver& receiver) const;
  std::vector<glm::dvec3> irradiances(const std::vector<Receiver>& receivers) const;

 private:
  struct Piece {
    Emitter emitter;
    int light;
  };
  std::vector<Piece> pieces_;
  Occlusion occlusion_;
};

}  // namespace lpv::reference
