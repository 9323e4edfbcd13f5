#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scene/mesh.h"

namespace lpv {

/// The triangles of a mesh with its flat patches in fewer of them: neighbours in one plane whose common outline is
/// convex become a fan over its corners. The plane and the outline may be off by 1e-5 of the mesh's extent. Empty where
/// nothing would become much fewer. For what is the same all over a patch: uvs and directions are not looked at.
std::vector<glm::uvec3> flatPatchesMerged(const Mesh& mesh);

}  // namespace lpv
