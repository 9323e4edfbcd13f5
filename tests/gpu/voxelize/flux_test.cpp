// FLUX injection against the double reference (MATHS.md 2): the polygon clipped to each cell, its area and normal.

#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "gpu/support/light_rig.h"
#include "reference/inject.h"
#include "reference/meshes.h"

namespace lpv {
namespace {

class FluxTest : public test::LightTest {
 protected:
  /// Largest difference as a share of the radianceScale cell's zeroth coefficient.
  static double error(const Grid& grid, const EmittingLight& light) {
    const test::InjectRig& rig = injected(grid, {light}, test::kFluxMethod);
    return test::relativeError(test::injectedOf(rig), reference::injectFlux(grid, test::emittersOf(grid, rig.lights)));
  }
};

std::vector<MeshPtr> meshes() {
  return {reference::quad(), reference::pyramid(), reference::tube(), reference::sphere(),
          reference::bumpySphere(4000)};
}

TEST_F(FluxTest, SumsAreTheReferences) {
  const Grid grid = test::unitGrid({16, 12, 14});
  for (const MeshPtr& mesh : meshes()) {
    const EmittingLight light = test::placed(mesh, test::poseOf({7.1, 6.3, 6.9}, glm::dvec3(5.0)), {3.0, 2.0, 1.0});
    EXPECT_LE(error(grid, light), 1e-6) << mesh->triangles.size() << " triangles";
  }
}

// Axis-aligned planes, edges along cell edges, planes through cell edges (x = z and the like): every tie of
// voxelize/clip.glsl.
TEST_F(FluxTest, TiesAreClippedOnce) {
  const Grid grid = test::unitGrid({8, 8, 8});
  for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}) {
    for (int eighths = 0; eighths < 8; ++eighths) {
      for (const double size : {4.0, 3.0, 5.656854249492381}) {
        EmittingLight light = test::lightOf(reference::quad(), glm::dvec3(1.0));
        light.gridFromObject = glm::translate(glm::dmat4(1.0), glm::dvec3(4.0)) *
                               glm::rotate(glm::dmat4(1.0), eighths * 0.78539816339744831, axis) *
                               glm::scale(glm::dmat4(1.0), glm::dvec3(size));
        EXPECT_LE(error(grid, light), 1e-6) << axis.x << axis.y << axis.z << " turned " << eighths << ", size " << size;
      }
    }
  }
}

/// Triangles with corners on coarse lattices: most of what can coincide does.
TEST_F(FluxTest, RandomTrianglesOnLattices) {
  std::mt19937 random(3);
  for (const double lattice : {1.0, 0.5, 0.25, 1.0 / 256.0}) {
    std::vector<std::array<glm::vec3, 3>> triangles;
    for (int i = 0; i < 400; ++i) {
      std::array<glm::vec3, 3> t;
      for (glm::vec3& p : t) {
        for (int k = 0; k < 3; ++k)
          p[k] = float(std::round(std::uniform_real_distribution<double>(-1.0, 9.0)(random) / lattice) * lattice);
      }
      triangles.push_back(t);
    }
    const Grid grid = test::unitGrid({8, 7, 9});
    for (std::size_t first = 0; first < triangles.size(); first += 10) {
      const std::vector<std::array<glm::vec3, 3>> some(triangles.begin() + std::ptrdiff_t(first),
                                                       triangles.begin() + std::ptrdiff_t(first + 10));
      EXPECT_LE(error(grid, test::lightOf(test::meshOf(some), glm::dvec3(1.0))), 1e-6)
          << "lattice " << lattice << ", from triangle " << first;
    }
  }
}

}  // namespace
}  // namespace lpv
