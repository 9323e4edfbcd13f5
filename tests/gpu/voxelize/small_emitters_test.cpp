// Where small, thin and textured emitters send from, beside closed forms: vector irradiance of a light's VPLs at points
// some cells away (MATHS.md 2, 3b.1, 5).

#include <cmath>
#include <random>

#include "gpu/transport/gather_rig.h"
#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "reference/mipmap.h"
#include "reference/receivers.h"
#include "reference/textures.h"
#include "scene/emitter_list.h"

namespace lpv {
namespace {

const Grid kGrid = test::unitGrid({14, 14, 14});
const glm::dvec3 kWhite(1.0);

/// Sum over a light's VPLs of what arrives at x, a colour each.
glm::dvec3 arrivingAt(const test::VplMap& vpls, const glm::dvec3& x, double scale) {
  glm::dvec3 sum(0.0);
  for (const auto& [place, v] : vpls) {
    const glm::dmat3& c = v.positionCovariance;
    const glm::vec4 entry[4] = {glm::vec4(v.position, v.area), glm::vec4(v.direction, v.spread),
                                glm::vec4(c[0][0], c[1][1], c[2][2], c[0][0] + c[1][1] + c[2][2]),
                                glm::vec4(c[0][1], c[0][2], c[1][2], 0.0)};
    sum += scale * v.colour.r * lightFromVpl(entry, x, 1).vectorIrradiance;
  }
  return sum;
}

using Corners = std::array<glm::dvec3, 3>;

/// Vector irradiance of the red of a light at x: triangles in n^2 parts, each as bright as at its centroid.
glm::dvec3 truthAt(const std::vector<reference::Emitter>& emitters, const glm::dvec3& x, int n) {
  glm::dvec3 sum(0.0);
  for (const reference::Emitter& e : emitters) {
    const glm::dvec3 p = e.corners[0], ab = (e.corners[1] - p) / double(n), ac = (e.corners[2] - p) / double(n);
    for (int row = 0; row < n; ++row) {
      for (int i = 0; i <= 2 * row; ++i) {
        // Rows grow away from corner 0: lattice points (a, b), a + b = row or row + 1.
        const auto point = [&](int a, int b) { return p + double(a) * ab + double(b) * ac; };
        const bool up = i % 2 == 0;
        const int b = i / 2, a = row - b;
        const Corners part = up ? Corners{point(a, b), point(a + 1, b), point(a, b + 1)}
                                : Corners{point(a, b), point(a, b + 1), point(a - 1, b + 1)};
        const double third = up ? 1.0 / 3.0 : 0.0;
        const double ca = up ? a + third : a - 1.0 / 3.0, cb = up ? b + third : b + 2.0 / 3.0;
        const glm::dvec3 bary(1.0 - (ca + cb) / n, ca / n, cb / n);
        double bright = e.radiance.r;
        if (e.texture) bright *= reference::trilinear(*e.texture, e.uvAt(bary), 0.0).r;
        sum += bright * reference::triangleMoments(part, x).vectorIrradiance;
      }
    }
  }
  return sum;
}

/// Points of the grid at this distance from the light, before it or behind.
std::vector<glm::dvec3> pointsAt(const std::vector<reference::Emitter>& emitters, double distance, int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<glm::dvec3> out;
  for (int tries = 0; tries < 4000000 && int(out.size()) < count; ++tries) {
    const double px = uniform(random), py = uniform(random), pz = uniform(random);
    const glm::dvec3 x = (glm::dvec3(kGrid.dims) + 10.0) * glm::dvec3(px, py, pz) - 5.0;
    double nearest = 1e30;
    for (const reference::Emitter& e : emitters)
      nearest = std::min(nearest, reference::distanceToTriangle(x, e.corners));
    if (std::abs(nearest - distance) < 0.02 * distance) out.push_back(x);
  }
  return out;
}

class SmallEmittersTest : public test::GatherTest {
 protected:
  struct Error {
    double mean = 0.0, worst = 0.0;  ///< |got - truth|, as a share of the largest truth
  };
  static Error errorAt(const EmittingLight& light, double distance, int n, int count = 60) {
    const LightVoxels& voxels = *planted(kGrid, {light}).voxels[0];
    const test::VplMap vpls = test::vplsOf(voxels);
    const auto emitters = test::emittersOf(kGrid, {light});
    Error e;
    double largest = 0.0, sum = 0.0;
    for (const glm::dvec3& x : pointsAt(emitters, distance, count)) {
      const glm::dvec3 want = truthAt(emitters, x, n),
                       got = arrivingAt(vpls, x, light.radiance.r * voxels.radianceScale);
      largest = std::max(largest, glm::length(want));
      e.worst = std::max(e.worst, glm::length(got - want));
      sum += glm::length(got - want);
    }
    e.mean = sum / count / largest;
    e.worst /= largest;
    return e;
  }
};

TEST_F(SmallEmittersTest, Explore) {
  const auto tell = [&](const char* name, const EmittingLight& light, int n) {
    for (const double d : {1.0, 2.0, 3.0}) {
      const Error e = errorAt(light, d, n);
      printf("%-24s %g cells: mean %.3f %% worst %.3f %%\n", name, d, 100 * e.mean, 100 * e.worst);
    }
  };
  const double m = 1.0 / 1.3;
  tell("tube", test::placed(reference::tube(), test::poseOf({7.1, 6.9, 7.2}, {5.0 * m, 0.02 * m, 0.02 * m}), kWhite),
       1);
  tell("tube along x",
       test::placed(reference::tube(), test::poseOf({7.1, 6.9, 7.2}, {5.0 * m, 0.02 * m, 0.02 * m}, 0.0), kWhite), 1);
  tell("sliver 1e-6", test::placed(reference::slivers(1, 1e-6), test::poseOf({7.1, 6.9, 7.2}, glm::dvec3(6.0)), kWhite),
       1);
  tell("slivers 1e-2",
       test::placed(reference::slivers(8, 1e-2), test::poseOf({7.1, 6.9, 7.2}, glm::dvec3(6.0)), kWhite), 1);
  const TexturePtr step = reference::textureOf(16, 16, [](int x, int) { return glm::dvec3(x < 8 ? 1.0 : 0.0); });
  const TexturePtr spot = reference::textureOf(16, 16, [](int x, int y) {
    return glm::dvec3(0.05 + std::exp(-0.5 * ((x - 11) * (x - 11) + (y - 4) * (y - 4)) / 2.0));
  });
  for (const double size : {0.7, 1.5, 3.0}) {
    const glm::dmat4 pose = test::poseOf({7.31, 6.62, 7.2}, glm::dvec3(size));
    printf("size %g\n", size);
    tell("even", test::placed(reference::quad(), pose, kWhite), 1);
    tell("step", test::placed(reference::quad(), pose, kWhite, false, step), 48);
    tell("spot", test::placed(reference::quad(), pose, kWhite, false, spot), 48);
  }
}

TEST_F(SmallEmittersTest, ExploreTessellations) {
  for (const double size : {0.9, 2.3, 5.0}) {
    for (const double angle : {0.0, 0.7, 1.3}) {
      const glm::dmat4 pose = test::poseOf({7.31, 6.62, 7.2}, glm::dvec3(size), angle);
      for (const double k : {1.5, 3.0}) {
        reference::Field first(kGrid.dims);
        for (const int n : {1, 10, 100}) {
          const EmittingLight light = test::placed(reference::quadOf(n), pose, kWhite);
          const reference::Field f = gathered(kGrid, {light}, k);
          if (n == 1) first = f;
          double worst = 0.0, largest = 0.0, sum = 0.0, sum2 = 0.0, local = 0.0;
          for (std::size_t i = 0; i < f.cells.size(); ++i) largest = std::max(largest, glm::length(first.cells[i][0]));
          for (std::size_t i = 0; i < f.cells.size(); ++i) {
            const double d = glm::length(f.cells[i][0] - first.cells[i][0]);
            worst = std::max(worst, d);
            sum += d * d;
            sum2 += glm::dot(first.cells[i][0], first.cells[i][0]);
            if (glm::length(first.cells[i][0]) > 0.01 * largest) local = std::max(local, d / glm::length(first.cells[i][0]));
          }
          printf("size %g angle %g k %g n %d: vpls %u L2 %.4f %% worst %.4f %% local %.4f %%\n", size, angle, k, n, rig().voxels[0]->tree->vplCount,
                 100 * std::sqrt(sum / sum2), 100 * worst / largest, 100 * local);
        }
      }
    }
  }
}

}  // namespace
}  // namespace lpv
