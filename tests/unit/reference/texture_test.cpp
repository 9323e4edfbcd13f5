// Textured lights in FLUX: the area integral of the bilinear level-0 texture over each pair's part, exactly
// (MATHS.md 2; 6.1, 6.5, 6.7, 6.10).
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reference/compare.h"
#include "reference/display.h"
#include "reference/inject.h"
#include "reference/meshes.h"
#include "reference/texel.h"
#include "reference/textures.h"
#include "scene/transform.h"
#include "unit/reference/fixtures.h"

namespace lpv::reference {
namespace {

Light lightOf(const MeshPtr& mesh, const TexturePtr& texture) {
  Light light;
  light.mesh = mesh;
  light.texture = texture;
  light.radiance = {5.0, 2.0, 0.5};
  light.transform.rotation = rotationFromEulerDegrees({23, 41, 67});
  light.transform.translation = {0.03, -0.11, 0.07};
  return light;
}

/// A mesh with each uv replaced.
template <typename Change>
MeshPtr withUvs(const MeshPtr& mesh, Change change) {
  Mesh out = *mesh;
  for (glm::vec2& uv : out.uvs) uv = change(uv);
  return std::make_shared<const Mesh>(out);
}

/// n triangles within the grid, wherever and with uvs wherever.
MeshPtr randomTriangles(int n, double uvSize, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-0.9F, 0.9F);
  std::uniform_real_distribution<double> uv(-uvSize, uvSize);
  Mesh mesh;
  for (std::uint32_t i = 0; i < std::uint32_t(3 * n); ++i) {
    const float x = place(random);
    const float y = place(random);
    mesh.positions.emplace_back(x, y, place(random));
    const double u = uv(random);
    mesh.uvs.emplace_back(u, uv(random));
    if (i % 3 == 0) mesh.triangles.emplace_back(i, i + 1, i + 2);
  }
  return std::make_shared<const Mesh>(mesh);
}

glm::dvec3 sumOf(const std::vector<FluxPair>& pairs) {
  glm::dvec3 sum(0.0);
  for (const FluxPair& pair : pairs) sum += pair.areaRadiance;
  return sum;
}

glm::dvec3 meanOf(const Texture& texture) {
  glm::dvec3 sum(0.0);
  for (int y = 0; y < texture.height; ++y) {
    for (int x = 0; x < texture.width; ++x) sum += texel(texture, x, y);
  }
  return sum / double(texture.width * texture.height);
}

void expectSame(const glm::dvec3& a, const glm::dvec3& b, double tolerance, const std::string& about = {}) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c] / b[c], 1.0, tolerance) << about << " colour " << c;
}

// Red with texel centres at i / W, or with the last column not wrapped to the first.
TEST(TexturedFlux, AWholePictureEmitsItsMean) {
  const Grid grid = gridOf(9, 0.25);
  for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(2, 3), glm::ivec2(7, 5), glm::ivec2(64, 32)}) {
    const TexturePtr texture = noise(size.x, size.y);
    for (const float repeats : {1.0F, 3.0F}) {
      const MeshPtr mesh = withUvs(quad(), [&](const glm::vec2& uv) { return repeats * uv; });
      const Light light = lightOf(mesh, texture);
      const glm::dvec3 sum = sumOf(fluxPairs(grid, emittersOf(grid, light).triangles));
      expectSame(sum, light.radiance * meanOf(*texture), 1e-12, std::to_string(size.x) + " texels");
    }
  }
}

// 6.1 closure. Red when a strip is left out at the end of a row.
TEST(TexturedFlux, PairsAddUpToTheTriangle) {
  const Grid grid = gridOf(11, 0.3);  // holds the mesh in any pose
  for (const double uvSize : {0.1, 2.0, 20.0}) {
    const Light light = lightOf(randomTriangles(12, uvSize, 5), noise(13, 6));
    for (const Emitter& e : emittersOf(grid, light).triangles) {
      const std::vector<FluxPair> pairs = fluxPairs(grid, {e});
      double fractions = 0.0;
      for (const FluxPair& pair : pairs) fractions += pair.fraction;
      EXPECT_NEAR(fractions, 1.0, 1e-12);
      expectSame(sumOf(pairs), radianceIntegral(e, wholeTriangle()), 1e-12);
    }
  }
}

// Against sums of samples, which share nothing with the pieces but the definition of the bilinear texture.
TEST(TexturedFlux, APartsIntegralIsTheSumOfItsSamples) {
  const TexturePtr texture = noise(9, 4, 3);
  const Grid grid = gridOf(5, 0.5);
  const Light light = lightOf(randomTriangles(3, 1.5, 8), texture);
  for (const Emitter& e : emittersOf(grid, light).triangles) {
    glm::dvec3 sum(0.0);
    const Polygon part = partInCell(e.snapped, fluxPairs(grid, {e}).front().cell);
    for (const auto& t : fanOf(part)) {
      constexpr int kSteps = 300;
      for (int i = 0; i < kSteps; ++i) {
        for (int j = 0; j < kSteps; ++j) {
          const double s = (i + 0.5) / kSteps;
          const double r = (j + 0.5) / kSteps;
          const glm::dvec3 b = (1.0 - s) * t[0] + s * ((1.0 - r) * t[1] + r * t[2]);
          const double area = 2.0 * s * fractionOf(t) * e.area() / (kSteps * kSteps);
          sum += area * e.radiance * bilinear(*texture, e.uvAt(b));
        }
      }
    }
    expectSame(radianceIntegral(e, part), sum, 2e-5);
  }
}

TEST(TexturedFlux, AConstantTextureIsAFactor) {
  const Grid grid = gridOf(9, 0.25);
  Light light = lightOf(quadOf(3), textureOf(8, 8, [](int, int) { return glm::dvec3(0.5, 0.25, 2.0); }));
  const Field textured = injectFlux(grid, emittersOf(grid, light).triangles);
  light.texture = nullptr;
  light.radiance *= glm::dvec3(0.5, 0.25, 2.0);
  EXPECT_LE(relativeL2(textured, injectFlux(grid, emittersOf(grid, light).triangles)), 1e-14);
}

TEST(TexturedFlux, ATextureWithoutUvsIsNoTexture) {
  const Grid grid = gridOf(9, 0.25);
  const Light light = lightOf(pyramid(), noise(4, 4));
  EXPECT_TRUE(light.mesh->uvs.empty());
  EXPECT_EQ(emittersOf(grid, light).triangles[0].texture, nullptr);
}

TEST(TexturedFlux, AMirroredPictureOnMirroredUvsIsTheSameLight) {
  const Grid grid = gridOf(9, 0.25);
  const TexturePtr picture = noise(16, 8, 2);
  const TexturePtr mirrored = textureOf(16, 8, [&](int x, int y) { return texel(*picture, 15 - x, y); });
  const MeshPtr turned = withUvs(quad(), [](const glm::vec2& uv) { return glm::vec2(1.0F - uv.x, uv.y); });
  const Field a = injectFlux(grid, emittersOf(grid, lightOf(quad(), picture)).triangles);
  const Field b = injectFlux(grid, emittersOf(grid, lightOf(turned, mirrored)).triangles);
  EXPECT_LE(relativeL2(b, a), 1e-13);
  const Field c = injectFlux(grid, emittersOf(grid, lightOf(quad(), mirrored)).triangles);
  EXPECT_GT(relativeL2(c, a), 0.01);
}

// The first row is at v = 0. Red with rows turned over.
TEST(TexturedFlux, TheFirstRowIsAtTheTopOfTheQuad) {
  const Grid grid = gridOf(8, 0.5);
  const TexturePtr top = textureOf(1, 64, [](int, int y) { return glm::dvec3(y < 32 ? 1.0 : 0.0); });
  Light light = lightOf(quad(), top);
  light.transform = Transform();
  double upper = 0.0;
  double all = 0.0;
  for (const FluxPair& pair : fluxPairs(grid, emittersOf(grid, light).triangles)) {
    all += pair.areaRadiance.x;
    if ((pair.areaCentroid / pair.area).y > 0.0) upper += pair.areaRadiance.x;
  }
  EXPECT_NEAR(all, 2.5, 1e-12);
  EXPECT_GT(upper, 0.75 * all);
}

// Multiples of 1/64 stay exact floats with 4096 added. Red with wrap by truncation for negative coordinates.
TEST(TexturedFlux, WrapsHoweverFarUvsLie) {
  const Grid grid = gridOf(9, 0.25);
  const TexturePtr texture = noise(10, 6);
  const auto moved = [&](float offset) {
    const auto change = [offset](const glm::vec2& uv) { return glm::vec2(0.296875F, 0.828125F) + 0.75F * uv + offset; };
    return injectFlux(grid, emittersOf(grid, lightOf(withUvs(quad(), change), texture)).triangles);
  };
  const Field here = moved(0.0F);
  for (const float offset : {1.0F, -1.0F, 4096.0F, -4096.0F})
    EXPECT_LE(relativeL2(moved(offset), here), 1e-9) << offset;
}

TEST(TexturedFlux, UvsOfOnePointOrOneLineAreIntegratedToo) {
  const Grid grid = gridOf(9, 0.25);
  const TexturePtr texture = noise(8, 8);
  const glm::vec2 at(0.3125F, 0.671875F);
  const Light point = lightOf(withUvs(quad(), [&](const glm::vec2&) { return at; }), texture);
  const glm::dvec3 expected = point.radiance * bilinear(*texture, glm::dvec2(at));
  expectSame(sumOf(fluxPairs(grid, emittersOf(grid, point).triangles)), expected, 1e-12);
  // v in the middle of the rows 4 and 5, and u over the whole width: the mean of the two rows.
  const Light line = lightOf(withUvs(quad(), [](const glm::vec2& uv) { return glm::vec2(uv.x, 0.625F); }), texture);
  glm::dvec3 rows(0.0);
  for (int x = 0; x < 8; ++x) rows += (texel(*texture, x, 4) + texel(*texture, x, 5)) / 16.0;
  expectSame(sumOf(fluxPairs(grid, emittersOf(grid, line).triangles)), line.radiance * rows, 1e-12);
}

// 6.10. Red when the texture is sampled at the part's centroid, or from a mip level.
TEST(TexturedFlux, AHotSpotKeepsItsPowerAndItsCell) {
  const Grid grid = gridOf(16, 0.1);
  const auto hot = [](int x, int y) { return (x == 301 || x == 302) && (y == 77 || y == 78); };
  const TexturePtr texture =
      textureOf(512, 512, [&](int x, int y) { return glm::dvec3(hot(x, y) ? 1e6 : 1.0 / 64.0); });
  const Light light = lightOf(quad(), texture);
  const std::vector<FluxPair> pairs = fluxPairs(grid, emittersOf(grid, light).triangles);
  expectSame(sumOf(pairs), light.radiance * meanOf(*texture), 1e-11);
  const glm::dmat4 world = light.transform.worldFromObject();
  const glm::dvec3 spot(world * glm::dvec4(302.0 / 512 - 0.5, 0.5 - 78.0 / 512, 0.0, 1.0));
  const glm::ivec3 cell(glm::floor(grid.gridFromWorld(spot)));
  for (const FluxPair& pair : pairs) {
    if (pair.cell == cell) continue;
    EXPECT_NEAR(pair.areaRadiance.x, 5.0 / 64.0 * pair.area, 1e-12);
  }
}

// Red without decoding, and when filtering comes before it.
TEST(TexturedFlux, SrgbIsDecodedBeforeFiltering) {
  const Grid grid = gridOf(9, 0.25);
  const TexturePtr stripes = srgbTextureOf(4, 2, [](int x, int) { return glm::u8vec3(x % 2 ? 200 : 40); });
  const Light light = lightOf(quad(), stripes);
  const double mean = 0.5 * (decodeSrgb(200 / 255.0) + decodeSrgb(40 / 255.0));
  EXPECT_NEAR(mean, 0.29938, 1e-4);
  expectSame(sumOf(fluxPairs(grid, emittersOf(grid, light).triangles)), mean * light.radiance, 1e-12);
}

// 6.5 with a picture. Float positions and uvs of the fine quad differ from the coarse one's in the last digits.
TEST(TexturedFlux, TessellationDoesNotMatter) {
  const Grid grid = gridOf(9, 0.25);
  const TexturePtr texture = noise(32, 32);
  const Light fine = lightOf(quadOf(64), texture);
  const Light coarse = lightOf(quad(), texture);
  const auto power = [&](const Light& light) { return sumOf(fluxPairs(grid, emittersOf(grid, light).triangles)); };
  expectSame(power(fine), power(coarse), 1e-11);
}

// A mirrored transform turns the winding back: uvs, snapped corners and centroids must go with the vertices.
TEST(TexturedFlux, AMirrorTakesThePictureAlong) {
  const Grid grid = gridOf(8, 0.5);
  Light light = lightOf(quad(), noise(4, 4));
  light.transform = Transform();
  light.transform.translation.z = 0.3;
  const auto whole = [&](const Light& l) { return injectFlux(grid, emittersOf(grid, l).triangles); };
  const Field plain = whole(light);
  light.transform.scale.x = -1.0;
  const std::vector<Emitter> emitters = emittersOf(grid, light).triangles;
  const Field mirrored = injectFlux(grid, emitters);
  forEachCell(grid.dims, [&](const glm::ivec3& cell) {
    const glm::ivec3 other(grid.dims.x - 1 - cell.x, cell.y, cell.z);
    EXPECT_NEAR(mirrored.at(cell)[0].x, plain.at(other)[0].x, 1e-13);
  });
  for (const FluxPair& pair : fluxPairs(grid, emitters)) {
    const glm::dvec3 g = grid.gridFromWorld(pair.areaCentroid / pair.area) - glm::dvec3(pair.cell);
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(g[k] > -1e-9 && g[k] < 1.0 + 1e-9) << g[k];
  }
}

TEST(TexturedFlux, PowerOfALightIsThatOfItsTexture) {
  const Grid grid = gridOf(9, 0.25);
  Light light = lightOf(quad(), noise(16, 16));
  light.twoSided = true;
  const std::vector<Emitter> emitters = emittersOf(grid, light).triangles;
  expectSame(injectedPower(injectFlux(grid, emitters)), powerOf(emitters), 1e-12);
}

}  // namespace
}  // namespace lpv::reference
