// Random volumes, and what the server's lookup says of them, as JSON for the page's lookup (lookup_test.mjs).

#include <cstdio>
#include <nlohmann/json.hpp>

#include "reference/random_volumes.h"
#include "scene/lookup.h"

namespace lpv {
namespace {

nlohmann::json listOf(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

nlohmann::json caseOf(const reference::RandomVolume& random) {
  const Grid& grid = random.volume.grid;
  nlohmann::json points = nlohmann::json::array(), wanted = nlohmann::json::array();
  for (const reference::LookupPoint& point : random.points) {
    const glm::dvec3 p(point.position), n(point.normal);
    points.push_back({p.x, p.y, p.z, n.x, n.y, n.z});
    wanted.push_back(listOf(irradianceAt(random.volume, Lookup::kCap, p, n).rgb));
  }
  return {{"dims", {grid.dims.x, grid.dims.y, grid.dims.z}},
          {"origin", listOf(grid.origin)},
          {"cellSize", grid.cell},
          {"scales", random.scales},
          {"halves", random.halves},
          {"points", points},
          {"wanted", wanted}};
}

}  // namespace
}  // namespace lpv

int main() {
  nlohmann::json cases = nlohmann::json::array();
  for (const lpv::reference::RandomVolume& random : lpv::reference::randomVolumes())
    cases.push_back(lpv::caseOf(random));
  std::puts(cases.dump().c_str());
}
