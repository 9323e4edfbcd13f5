#pragma once
// Shadow rays for the benches: a device, rooms with something in the way, and rays through them.

#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/context.h"
#include "gpu/program.h"
#include "scene/scene.h"

namespace lpv::bench {

inline constexpr std::size_t kRays = 1 << 16;

/// A context on the first device; exits with a message when there is none.
gpu::Context& deviceContext();

/// reference::smallRoom with a mesh instead of its two boxes, standing in its middle.
Scene roomAround(const MeshPtr& mesh, int cells = 32);

/// Grid space.
struct ShadowRay {
  glm::vec3 from{0.0F};  ///< kShadowOffset above a surface
  glm::vec3 to{0.0F};
  glm::vec3 fromNormal{0.0F};  ///< unit: the surface's, and the lamp's where the ray goes there, else 0
  glm::vec3 toNormal{0.0F};
};

/// kRays rays from all over the surfaces, 32 from each cell beside one another, as a frame's blocks of pixels have
/// them: two cells long, or to the scene's light "lamp", a quad.
std::vector<ShadowRay> shadowRays(const Scene& scene, bool toLamp);

/// A dispatch of many rays: `head` has a function vec2 answer(vec3 from, vec3 to), what gets from one to the other and
/// a number to go with it.
class RayProgram {
 public:
  RayProgram(const std::string& name, const std::string& head, const gpu::Defines& defines = {});
  void dispatch(const gpu::Buffer& rays, const gpu::Buffer& answers);

 private:
  gpu::Program program_;
};

/// The product's rays: through visibility/occluders.glsl, with the rounds of loops.
RayProgram trianglesProgram();

/// vec4 (from, -), vec4 (to, -) per ray, and room for the answers.
gpu::Buffer rayBuffer(std::span<const ShadowRay> rays);
gpu::Buffer answerBuffer(std::size_t rays);
std::vector<glm::vec2> answersOf(const gpu::Buffer& answers);

}  // namespace lpv::bench
