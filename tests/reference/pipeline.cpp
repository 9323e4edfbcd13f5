#include "reference/pipeline.h"

#include <algorithm>
#include <cstdint>

#include "reference/dense.h"
#include "reference/inject.h"
#include "reference/propagate.h"
#include "reference/volume.h"

namespace lpv::reference {

Field injectedField(const Scene& scene) {
  const Emitters emitters = emittersOf(scene);
  if (scene.options.method == InjectionMethod::kDense) {
    return injectDense(scene.grid, emitters.triangles, std::uint32_t(scene.options.denseSamples)).intensity;
  }
  if (scene.options.injection == Injection::kFlux) return injectFlux(scene.grid, emitters.triangles);
  return injectCount(scene.grid, emitters.triangles).intensity;
}

Field transportedField(const Scene& scene) {
  const int longest = std::max({scene.grid.dims.x, scene.grid.dims.y, scene.grid.dims.z});
  const int iterations = scene.options.iterations > 0 ? scene.options.iterations : longest;
  const Field injected = injectedField(scene);
  const Field sum =
      scene.options.clampFaces ? propagateFaces(injected, iterations, true) : propagateStencil(injected, iterations);
  return productOf(sum, scene.grid.cell).incident;
}

Volume transportedVolume(const Scene& scene) { return toVolume(scene.grid, transportedField(scene)); }

}  // namespace lpv::reference
