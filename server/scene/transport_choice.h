#pragma once
// The transport that a scene gets where its settings leave it to the server (AUTO): GATHER or DIRECT.

#include <string>

#include "scene/scene.h"

namespace lpv {

struct TransportChoice {
  Transport transport = Transport::kGather;
  std::string reason;  ///< a clause
};

/// A pure function of the scene, its grid and settings, whose own transport does not matter; the same on every device.
/// GATHER while it is predicted to have the wanted error, because it is the cheaper one; DIRECT where it is not, and
/// all lights together are no more to look at than kMostLookedAt (scene/small_lights.h). Where frames look at the
/// lights in any case, GATHER, whose volumes are grouped. Takes some milliseconds, as chooseGrid does.
TransportChoice chooseTransport(const Scene& scene);

}  // namespace lpv
