#include "stability/judge.h"

#include <cmath>

#include "reference/ground_truth.h"
#include "scene/lookup.h"

namespace lpv::stability {

VolumePtr lit(Engine& engine, const Scene& scene) {
  static SessionKey session = 0;
  TickRequest request = test::requestOf(scene, ++session);
  request.transported = request.probed = true;
  std::promise<Expected<TickResult>> answer;
  engine.submit(std::move(request), [&answer](Expected<TickResult> result) { answer.set_value(std::move(result)); });
  const Expected<TickResult> result = answer.get_future().get();
  EXPECT_TRUE(result.ok()) << result.status().message();
  engine.forget(session);
  return result.ok() ? result->transported : nullptr;
}

std::vector<reference::Receiver> receiversOf(const Scene& scene) {
  std::vector<reference::Receiver> out = reference::wallReceivers(scene.grid);
  const auto objects = reference::objectReceivers(scene.grid, reference::emittersOf(scene).triangles, 100);
  out.insert(out.end(), objects.begin(), objects.end());
  return out;
}

std::vector<glm::dvec3> truth(const Scene& scene, const std::vector<reference::Receiver>& receivers) {
  return reference::irradiances(reference::emittersOf(scene).triangles, receivers);
}

std::vector<glm::dvec3> seen(const Volume& volume, Lookup lookup, const std::vector<reference::Receiver>& receivers) {
  std::vector<glm::dvec3> out;
  for (const reference::Receiver& r : receivers)
    out.push_back(irradianceWithNearField(volume, lookup, r.position, r.normal).rgb);
  return out;
}

bool isSound(const Volume& volume) {
  for (const VolumeLayer& layer : volume.layers) {
    for (std::size_t i = 0; i < layer.coefficients.size(); ++i) {
      const float c = layer.coefficients[i];
      if (!std::isfinite(c) || (i % 4 == 0 && c < 0.0F)) return false;
    }
  }
  return true;
}

Scene emptyScene(Transport transport, int cells, double edge, const glm::dvec3& at) {
  Scene scene;
  scene.grid = {at, edge / cells, glm::ivec3(cells)};
  scene.options.transport = transport;
  scene.options.followTransport();
  scene.options.k = transport == Transport::kPropagate ? 0.0 : kAccurateOpeningRatio;
  scene.options.visibility = Visibility::kOff;
  scene.revision = 1;
  return scene;
}

Light& addLight(Scene& scene, const std::string& name, const MeshPtr& mesh, const Transform& transform) {
  auto light = std::make_shared<Light>();
  light->name = name;
  light->mesh = mesh;
  light->transform = transform;
  scene.lights[name] = light;
  return *light;
}

}  // namespace lpv::stability
