#pragma once
// How a scene of lights alone is judged: what receivers get from the engine against the closed form.

#include <optional>
#include <string>
#include <vector>

#include "gpu/engine/engine_rig.h"
#include "reference/receivers.h"
#include "scene/scene.h"

namespace lpv::stability {

/// A session of its own each time.
VolumePtr lit(Engine& engine, const Scene& scene);

/// Walls of a room within the grid, and points two cells and more from the lights.
std::vector<reference::Receiver> receiversOf(const Scene& scene);
std::vector<glm::dvec3> truth(const Scene& scene, const std::vector<reference::Receiver>& receivers);
std::vector<glm::dvec3> seen(const Volume& volume, Lookup lookup, const std::vector<reference::Receiver>& receivers);

/// Whether all its numbers are, and fluence is nowhere below 0.
bool isSound(const Volume& volume);

/// An empty grid of `cells`^3 over a cube with its corner at `at`.
Scene emptyScene(Transport transport, int cells = 32, double edge = 1.0, const glm::dvec3& at = glm::dvec3(0.0));
/// A white light of radiance 1.
Light& addLight(Scene& scene, const std::string& name, const MeshPtr& mesh, const Transform& transform);

}  // namespace lpv::stability
