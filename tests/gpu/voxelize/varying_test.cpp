// Lights that vary over their triangles, by texture and by emission directions per vertex (MATHS.md 2; paper 3.2, 3.3),
// against the double reference.
//
// Seen to fail when broken: row integrals in the texture's own unit beside texels in shares of the radianceScale; the
// normal left in the sum of spread lobes; mean direction times mean colour for the mean of their product; directions
// mixed in float; a thread with more rounds of loops than llvmpipe allows (laborious() false).

#include <random>
#include <sstream>
#include <string>

#include "gpu/support/light_rig.h"
#include "reference/dense.h"
#include "reference/inject.h"
#include "reference/meshes.h"
#include "reference/sh.h"
#include "reference/textures.h"

namespace lpv {
namespace {

const Grid kGrid = test::unitGrid({13, 11, 12});
const glm::dvec3 kCentre(6.3, 5.6, 6.1);
const glm::dvec3 kRadiance(3.0, 2.0, 1.0);

/// Turned, upright, mirrored and unevenly scaled, within one cell, larger than the grid.
const std::vector<glm::dmat4> kPoses = {
    test::poseOf(kCentre, glm::dvec3(6.0)), test::poseOf(kCentre, glm::dvec3(6.0), 0.0),
    test::poseOf(kCentre, {-7.0, 3.0, 5.0}, 1.9, {2, -1, 1}), test::poseOf(kCentre, glm::dvec3(0.3), 2.6),
    test::poseOf(kCentre - 3.0, glm::dvec3(16.0), 0.9, {-1, 1, 3})};

/// A bowl of directions over the xy plane; their angles grow with `spread`: 5 turns quad()'s corners 74 degrees out.
MeshPtr directed(const MeshPtr& mesh, float spread) {
  return test::withAttributes(mesh, {},
                              [=](const glm::vec3& p) { return glm::vec3(spread * p.x, spread * p.y, 1.0F); });
}

/// Any unit direction at every vertex.
MeshPtr scattered(const MeshPtr& mesh, std::uint32_t seed) {
  auto random = std::make_shared<std::mt19937>(seed);
  return test::withAttributes(mesh, {}, [=](const glm::vec3&) {
    std::normal_distribution<float> normal;
    const float x = normal(*random), y = normal(*random);
    return glm::vec3(x, y, normal(*random));
  });
}

MeshPtr withUvs(const MeshPtr& mesh, const test::UvOf& uvOf) { return test::withAttributes(mesh, uvOf, {}); }

/// One triangle with one direction per corner.
MeshPtr triangleWith(const std::array<glm::vec3, 3>& directions) {
  auto mesh = std::make_shared<Mesh>(*test::meshOf({{{{-0.5F, -0.4F, 0}, {0.5F, -0.3F, 0}, {-0.1F, 0.5F, 0}}}}));
  mesh->directions.assign(directions.begin(), directions.end());
  return mesh;
}

class VaryingTest : public test::LightTest {
 protected:
  static double errorOf(const test::InjectRig& rig) {
    const auto emitters = test::emittersOf(kGrid, rig.lights);
    const bool flux = rig.method.injection == Injection::kFlux;
    return test::relativeError(test::injectedOf(rig), flux ? reference::injectFlux(kGrid, emitters)
                                                           : reference::injectCount(kGrid, emitters).intensity);
  }

  /// The largest error over poses, one-sided and, in the first pose, two-sided.
  static double worst(const MeshPtr& mesh, const TexturePtr& texture, const VoxelMethod& method) {
    double error = 0.0;
    for (std::size_t i = 0; i <= kPoses.size(); ++i) {
      const bool twoSided = i == kPoses.size();
      const EmittingLight light = test::placed(mesh, kPoses[i % kPoses.size()], kRadiance, twoSided, texture);
      error = std::max(error, errorOf(injected(kGrid, {light}, method)));
    }
    return error;
  }

  static void expectWithin(const std::string& name, const MeshPtr& mesh, const TexturePtr& texture, double flux,
                           double count) {
    const double fluxError = worst(mesh, texture, test::kFluxMethod),
                 countError = worst(mesh, texture, test::kCountMethod);
    std::ostringstream seen;
    seen << fluxError << ", COUNT " << countError;
    RecordProperty(name, seen.str());
    EXPECT_LE(fluxError, flux) << name << ", FLUX";
    EXPECT_LE(countError, count) << name << ", COUNT";
  }
};

// FLUX is exact up to its rounding (2e-7 seen; 1e-4 asked); COUNT up to the sampler's filter.
// Broken by: the last piece forgotten in pieceAt().
TEST_F(VaryingTest, TexturesAreIntegrated) {
  const TexturePtr texture = reference::noise(16, 16);
  expectWithin("quad", reference::quad(), texture, 1e-6, 3e-3);
  expectWithin("two by eight texels", reference::quad(), reference::noise(2, 8), 1e-6, 3e-3);
  expectWithin("one texel", reference::quad(), reference::noise(1, 1), 1e-6, 3e-3);
  expectWithin("seven by thirteen texels", reference::quad(), reference::noise(7, 13), 1e-6, 3e-3);
  expectWithin("ball",
               withUvs(reference::sphereOf(6, 4), [](auto& p, auto&) { return glm::vec2(p.x + 0.3F * p.z, p.y); }),
               texture, 1e-6, 3e-3);
  expectWithin("far uvs", withUvs(reference::quad(), [](auto&, auto& uv) { return 2.3F * uv - 1000.25F; }), texture,
               1e-6, 3e-3);
  expectWithin(
      "mirrored uvs",
      withUvs(reference::quadOf(2), [](auto&, auto& uv) { return glm::vec2(-1.7F * uv.x + 9.0F, uv.y + uv.x); }),
      texture, 1e-6, 3e-3);
}

// Lines and points of the texture, for which there is no area to integrate over.
TEST_F(VaryingTest, UvsWithoutArea) {
  const TexturePtr texture = reference::noise(16, 16);
  expectWithin("point", withUvs(reference::quad(), [](auto&, auto&) { return glm::vec2(3.3F, -0.4F); }), texture, 1e-6,
               3e-3);
  expectWithin("row", withUvs(reference::quad(), [](auto&, auto& uv) { return glm::vec2(uv.x, 0.37F); }), texture, 1e-4,
               3e-3);
  expectWithin("diagonal", withUvs(reference::quad(), [](auto&, auto& uv) { return glm::vec2(uv.x + uv.y); }), texture,
               1e-4, 3e-3);
}

// Up to 120 degrees between corners FLUX is exact up to rounding, beyond up to its quadrature (2e-3).
// Broken by: `>=` for `>` in cutWithin() (a cut along a face counts on both its sides).
TEST_F(VaryingTest, DirectionsAreAveraged) {
  for (const float spread : {0.5F, 2.0F, 20.0F}) {
    const std::string name = "bowl " + std::to_string(spread);
    expectWithin(name, directed(reference::quad(), spread), nullptr, 1e-5, 1e-6);
  }
  expectWithin("ball", directed(reference::sphereOf(8, 6), 3.0F), nullptr, 1e-5, 1e-6);
  expectWithin("scattered", scattered(reference::sphereOf(8, 6), 3), nullptr, 2e-3, 1e-6);
}

TEST_F(VaryingTest, DirectionsAndTexturesTogether) {
  expectWithin("bowl", directed(reference::quad(), 0.5F), reference::noise(16, 16), 1e-4, 3e-3);
  expectWithin("wide bowl", directed(reference::quad(), 5.0F), reference::noise(16, 16), 2e-3, 3e-3);
  expectWithin("scattered", scattered(reference::quadOf(2), 4), reference::noise(8, 8), 2e-3, 3e-3);
}

// Where directions cancel the normal stands in; the power does not see directions at all (MATHS.md 6.9).
TEST_F(VaryingTest, AntipodalAndZeroDirectionsKeepThePower) {
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), none(0.0F);
  for (const std::array<glm::vec3, 3>& d :
       {std::array{x, -x, y}, std::array{x, -x, -x}, std::array{x, -x, none}, std::array{none, none, none},
        std::array{x, none, y}, std::array{1e-30F * x, 1e30F * y, -1e30F * y}}) {
    const MeshPtr mesh = triangleWith(d);
    const std::string name =
        "directions " + std::to_string(d[0].x) + " " + std::to_string(d[1].x) + " " + std::to_string(d[2].x);
    expectWithin(name, mesh, nullptr, 2e-3, 1e-6);
    const test::InjectRig& rig = injected(kGrid, {test::placed(mesh, kPoses[0], kRadiance)}, test::kFluxMethod);
    const reference::Field field = test::injectedOf(rig);
    for (const auto& cell : field.cells) {
      for (int k = 0; k < 4; ++k) ASSERT_TRUE(std::isfinite(cell[0][k])) << name;
    }
    const double power = reference::powerOf(test::emittersOf(kGrid, rig.lights)).x;
    EXPECT_NEAR(reference::injectedPower(field).x / power, 1.0, 1e-6) << name;
  }
}

// A texture repeated 64 times each way over few cells, with directions that need the finest quadrature: a whole number
// of repeats emits the texture's mean, if no thread gives up before it is done.
TEST_F(VaryingTest, LongWorkIsSharedOut) {
  const TexturePtr chequered =
      reference::textureOf(64, 64, [](int x, int y) { return glm::dvec3((x / 3 + y / 5) % 2); });
  double mean = 0.0;
  for (int i = 0; i < 64 * 64; ++i) mean += (i % 64 / 3 + i / 64 / 5) % 2 / 4096.0;
  const MeshPtr repeated = withUvs(reference::quad(), [](auto&, auto& uv) { return 64.0F * uv; });
  for (const MeshPtr& mesh : {repeated, scattered(repeated, 7)}) {
    const EmittingLight light =
        test::placed(mesh, test::poseOf(kCentre, glm::dvec3(3.3), 0.3), kRadiance, false, chequered);
    const reference::Field field = test::injectedOf(injected(kGrid, {light}, test::kFluxMethod));
    EXPECT_NEAR(reference::injectedPower(field).x / (reference::pi() * kRadiance.x * mean * 3.3 * 3.3), 1.0, 1e-6);
  }
}

// Textures and directions through the paper's pipeline too.
TEST_F(VaryingTest, RasterAndComputeGiveTheSameBits) {
  const std::vector<MeshPtr> meshes = {directed(reference::quad(), 5.0F), scattered(reference::sphereOf(8, 6), 5),
                                       directed(reference::quadOf(8), 1.0F)};
  for (const MeshPtr& mesh : meshes) {
    for (const TexturePtr& texture : {TexturePtr(), reference::noise(16, 16)}) {
      for (const glm::dmat4& pose : kPoses) {
        for (const Injection injection : {Injection::kCount, Injection::kFlux}) {
          const EmittingLight light = test::placed(mesh, pose, kRadiance, false, texture);
          const auto bits = [&](InjectionMethod method) {
            return test::voxelsOf(*injected(kGrid, {light}, {injection, method, 0}).voxels[0]);
          };
          EXPECT_TRUE(bits(InjectionMethod::kCompute) == bits(InjectionMethod::kRaster));
        }
      }
    }
  }
}

// The same random numbers on both sides: the same lobes in every cell (none of 600,000 samples is so near a face that
// rounding decides). The sums differ by COUNT's fixed point. Broken by: another hash.
TEST_F(VaryingTest, DenseSamplesFallIntoTheReferencesCells) {
  constexpr int kSamples = 200;
  std::size_t moved = 0, samples = 0;
  for (const glm::dmat4& pose : kPoses) {
    const EmittingLight light = test::placed(directed(reference::sphere(), 1.0F), pose, kRadiance);
    const test::InjectRig& rig = injected(kGrid, {light}, {Injection::kCount, InjectionMethod::kDense, kSamples});
    const reference::Counted want = reference::injectDense(kGrid, test::emittersOf(kGrid, {light}), kSamples);
    std::vector<std::uint32_t> got(kGrid.cells(), 0);
    for (const auto& [cell, voxel] : test::voxelsOf(*rig.voxels[0])) got[cell] = voxel.first;
    for (std::size_t i = 0; i < got.size(); ++i) {
      moved += std::max(got[i], want.lobes[i]) - std::min(got[i], want.lobes[i]);
      samples += want.lobes[i];
    }
    EXPECT_LE(test::relativeError(test::injectedOf(rig), want.intensity), 1e-3);
  }
  EXPECT_EQ(moved, 0U) << "of " << samples;
}

}  // namespace
}  // namespace lpv
