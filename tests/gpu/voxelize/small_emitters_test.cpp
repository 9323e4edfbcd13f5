// Where small, thin and textured emitters send from, beside closed forms: vector irradiance of a light's VPLs at points
// some cells away (MATHS.md 2, 3b.1, 5).

#include <cmath>
#include <random>

#include "gpu/transport/gather_rig.h"
#include "lpv/transport/emitter_list.h"
#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "reference/mipmap.h"
#include "reference/receivers.h"
#include "reference/textures.h"
#include "scene/emitter_list.h"
#include "scene/error_goal.h"

namespace lpv {
namespace {

const Grid kGrid = test::unitGrid({14, 14, 14});
const glm::dvec3 kWhite(1.0);

/// Vector irradiance of red at x: the sum over a light's VPLs.
glm::dvec3 arrivingAt(const test::VplMap& vpls, const glm::dvec3& x, double scale) {
  glm::dvec3 sum(0.0);
  for (const auto& [place, v] : vpls) {
    const glm::dmat3& c = v.positionCovariance;
    const glm::vec4 entry[4] = {glm::vec4(v.position, v.area), glm::vec4(v.direction, v.spread),
                                glm::vec4(c[0][0], c[1][1], c[2][2], c[0][0] + c[1][1] + c[2][2]),
                                glm::vec4(c[0][1], c[0][2], c[1][2], 2.0)};
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

/// What is asked of one distance.
struct Error {
  double mean = 0.0, worst = 0.0;  ///< |got - truth|, as a share of the largest truth
};

/// A direction; any one where there is none.
glm::dvec3 unitAt(const glm::dvec3& v) { return v == glm::dvec3(0.0) ? glm::dvec3(0, 0, 1) : glm::normalize(v); }

class SmallEmittersTest : public test::GatherTest {
 protected:
  /// Vector irradiance of a light's VPLs, each by itself. `parts`: of a triangle's side, for the truth.
  static Error errorAt(const EmittingLight& light, double distance, int parts) {
    const LightVoxels& voxels = *planted(kGrid, {light}).voxels[0];
    const test::VplMap vpls = test::vplsOf(voxels);
    const auto emitters = test::emittersOf(kGrid, {light});
    const double scale = light.radiance.r * voxels.radianceScale;
    return compare(emitters, distance, parts, [&](const glm::dvec3& x) { return arrivingAt(vpls, x, scale); });
  }

  /// Irradiance of surfaces that face the light, as DIRECT has it from the light's tree.
  static Error directErrorAt(const EmittingLight& light, double distance, int parts, double k) {
    const LightVoxels& voxels = *planted(kGrid, {light}).voxels[0];
    EmitterList list;
    list.grid = kGrid;
    list.always = true;
    const float stride = voxels.momentsPerCell > 1 ? layout::kTexturedEntryTexels : layout::kPlainEntryTexels;
    list.texels = {{1.0F, float(k), 0.0F, 0.0F},
                   glm::vec4(light.radiance * voxels.radianceScale, 1.0),
                   {3.0F, float(voxels.tree->entryCount), 1.0F, stride}};
    const std::vector<glm::vec4> entries = test::read<glm::vec4>(voxels.tree->entries);
    list.texels.insert(list.texels.end(), entries.begin(),
                       entries.begin() + std::ptrdiff_t(voxels.tree->entryCount) * std::ptrdiff_t(stride));
    const auto emitters = test::emittersOf(kGrid, {light});
    return compare(emitters, distance, parts, [&](const glm::dvec3& x) {
      const glm::dvec3 n = unitAt(truthAt(emitters, x, parts));
      return list.irradiance(x, n).r * n;
    });
  }

 private:
  template <typename Got>
  static Error compare(const std::vector<reference::Emitter>& emitters, double distance, int parts, const Got& got) {
    Error e;
    double largest = 0.0;
    const std::vector<glm::dvec3> points = pointsAt(emitters, distance, 60);
    for (const glm::dvec3& x : points) {
      const glm::dvec3 want = truthAt(emitters, x, parts);
      const double error = glm::length(got(x) - want);
      largest = std::max(largest, glm::length(want));
      e.worst = std::max(e.worst, error);
      e.mean += error / double(points.size());
    }
    return {e.mean / largest, e.worst / largest};
  }
};

const glm::dvec3 kMiddle(7.31, 6.62, 7.2);

// A tube of 10 m and 4 mm in cells of 1.3 m, and strips and slivers far thinner than 1/256 cell: asked is 2 % from two
// cells on. Seen, worst of the largest: .22 % (tube), .94 % (sliver of 1:10^6, whose mesh's box is no thin one). Broken
// by: the whole of a segment in one cell; what is thin taken for flat squares (1 to 2 %, the tube and the strips).
TEST_F(SmallEmittersTest, ThinEmittersKeepLengthAreaAndDirection) {
  const double metre = 1.0 / 1.3;
  const glm::dvec3 tube(5.0 * metre, 0.02 * metre, 0.02 * metre);
  const std::vector<std::pair<std::string, EmittingLight>> lights = {
      {"tube", test::placed(reference::tube(), test::poseOf(kMiddle, tube), kWhite)},
      {"tube along x", test::placed(reference::tube(), test::poseOf(kMiddle, tube, 0.0), kWhite)},
      {"strip", test::placed(reference::quad(), test::poseOf(kMiddle, {9.0, 1e-4, 1.0}), kWhite)},
      {"cut up strip", test::placed(reference::quadOf(3), test::poseOf(kMiddle, {9.0, 1e-4, 1.0}), kWhite)},
      {"sliver", test::placed(reference::slivers(1, 1e-6), test::poseOf(kMiddle, glm::dvec3(6.0)), kWhite)},
      {"slivers", test::placed(reference::slivers(8, 1e-2), test::poseOf(kMiddle, glm::dvec3(6.0)), kWhite)}};
  for (const auto& [name, light] : lights) {
    for (const double distance : {2.0, 3.0, 5.0}) {
      const bool measured = name.find("sliver") == std::string::npos;
      EXPECT_LE(errorAt(light, distance, 1).worst, measured ? 0.005 : 0.02) << name << " from " << distance << " cells";
    }
  }
}

/// Half bright, and a spot of 1.4 texels on a twentieth of its brightness.
std::vector<std::pair<std::string, TexturePtr>> unevenTextures() {
  const auto step = [](int x, int) { return glm::dvec3(x < 8 ? 1.0 : 0.0); };
  const auto spot = [](int x, int y) {
    return glm::dvec3(0.05 + std::exp(-0.25 * ((x - 11) * (x - 11) + (y - 4) * (y - 4))));
  };
  return {{"half", reference::textureOf(16, 16, step)}, {"spot", reference::textureOf(16, 16, spot)}};
}

// Asked is .5 % from one cell on, .2 % of what is looked at directly. Seen, mean of the largest: .18 % at one cell, .03
// % at two; DIRECT .14 and .02 %, with k = 1.5 .11 % at four. The worst point at one cell is 3.4 % off (1.6 % for an
// even square): what a cell emits is expanded to second order only. Broken by: places weighted by area (1.4 % at three
// cells); what is textured taken for flat squares.
TEST_F(SmallEmittersTest, TexturedEmittersSendFromWhereTheyGlow) {
  for (const auto& [name, texture] : unevenTextures()) {
    for (const double size : {0.7, 1.5, 3.0, 6.0}) {
      SCOPED_TRACE(testing::Message() << name << ", " << size << " cells");
      const EmittingLight light =
          test::placed(reference::quad(), test::poseOf(kMiddle, glm::dvec3(size)), kWhite, false, texture);
      EXPECT_LE(errorAt(light, 1.0, 48).mean, 0.005);
      for (const double distance : {2.0, 4.0}) {
        EXPECT_LE(errorAt(light, distance, 48).worst, 0.005) << distance;
        EXPECT_LE(errorAt(light, distance, 48).mean, 0.0005) << distance;
      }
      for (const double distance : {1.0, 2.0, 4.0}) {
        EXPECT_LE(directErrorAt(light, distance, 48, 3.0).mean, 0.002) << distance;
        EXPECT_LE(directErrorAt(light, distance, 48, 1.5).mean, 0.002) << distance;
      }
    }
  }
}

/// The largest difference of two fields, as a share of the largest value.
double apart(const reference::Field& a, const reference::Field& b) {
  double largest = 0.0, apart = 0.0;
  for (std::size_t i = 0; i < a.cells.size(); ++i) {
    largest = std::max(largest, glm::length(a.cells[i][0]));
    apart = std::max(apart, glm::length(a.cells[i][0] - b.cells[i][0]));
  }
  return apart / largest;
}

// Asked is .1 % (MATHS.md 6.5); it is the same triangles. Broken by: triangles voxelized as they come (up to 1.8 %).
TEST_F(SmallEmittersTest, AQuadOfManyTrianglesIsAQuad) {
  for (const double size : {0.9, 2.3, 5.0}) {
    for (const double angle : {0.0, 0.7, 1.3}) {
      const glm::dmat4 pose = test::poseOf(kMiddle, glm::dvec3(size), angle);
      const reference::Field want = gathered(kGrid, {test::placed(reference::quad(), pose, kWhite)}, kFastOpeningRatio);
      for (const int n : {10, 100}) {
        const EmittingLight light = test::placed(reference::quadOf(n), pose, kWhite);
        EXPECT_LE(apart(want, gathered(kGrid, {light}, kFastOpeningRatio)), 1e-5) << n << ", size " << size;
        std::vector<EmittingLight> lights = {light};
        chooseTriangles(lights, Transport::kGather, kFastOpeningRatio);
        EXPECT_TRUE(lights[0].polygons) << "looked at as a tree, from near";
      }
    }
  }
}

}  // namespace
}  // namespace lpv
