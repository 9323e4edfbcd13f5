// lookup.glsl = irradianceAt of scene/volume.h.

#include <random>

#include "gpu/gl_test.h"
#include "gpu/texture.h"
#include "scene/volume.h"

namespace lpv {
namespace {

class LookupTest : public test::GlTest {};

constexpr glm::ivec3 kDims(5, 4, 3);

/// A volume whose colours differ (channels 3) or are one field times (2, 1, 0.5) (channels 1).
Volume randomVolume(int channels, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  Volume volume;
  volume.grid = {glm::dvec3(0.0), 1.0, kDims};
  volume.layers.resize(1);
  for (std::size_t cell = 0; cell < volume.grid.cells(); ++cell) {
    glm::vec4 c(0.0F);
    for (int colour = 0; colour < 3; ++colour) {
      if (colour == 0 || channels == 3) c = {1.0F + uniform(random), uniform(random), uniform(random), uniform(random)};
      const float unit = channels == 3 ? 1.0F : std::array{2.0F, 1.0F, 0.5F}[std::size_t(colour)];
      for (int k = 0; k < 4; ++k) volume.layers[0].coefficients.push_back(unit * c[k]);
    }
  }
  return volume;
}

gpu::Texture textureOf(const Volume& volume, int colour, float unit) {
  std::vector<glm::vec4> texels;
  for (std::size_t cell = 0; cell < volume.grid.cells(); ++cell) {
    const float* c = volume.layers[0].coefficients.data() + (cell * 3 + std::size_t(colour)) * 4;
    texels.emplace_back(glm::vec4(c[0], c[1], c[2], c[3]) / unit);
  }
  gpu::Texture texture = gpu::Texture::make3d("test", kDims, GL_RGBA32F, gpu::Sampling::kLinearClamp);
  glTextureSubImage3D(texture.id(), 0, 0, 0, 0, kDims.x, kDims.y, kDims.z, GL_RGBA, GL_FLOAT, texels.data());
  return texture;
}

/// Positions inside, in the rim of half a cell outside, and beyond; on cell faces and centres; each with a normal.
std::vector<glm::vec4> positionsAndNormals() {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  std::vector<glm::vec4> out;
  for (int i = 0; i < 500; ++i) {
    out.emplace_back(glm::vec3(kDims + 2) * glm::vec3(uniform(random), uniform(random), uniform(random)) - 1.0F, 0.0F);
    out.emplace_back(glm::normalize(glm::vec3(uniform(random), uniform(random), uniform(random)) - 0.5F), 0.0F);
  }
  return out;
}

void compare(int channels, Lookup lookup) {
  const Volume volume = randomVolume(channels, 7);
  std::vector<gpu::Texture> textures;
  for (int colour = 0; colour < channels; ++colour) {
    textures.push_back(textureOf(volume, colour, channels == 1 ? 2.0F : 1.0F));
    textures.back().bind(std::uint32_t(layout::kIncident + colour));
  }
  const std::vector<glm::vec4> points = positionsAndNormals();
  const auto out = test::evaluate(
      "#include \"sh.glsl\"\n#include \"lookup.glsl\"",
      "if (i % 2u == 1u) return;\n"
      "outputs[i] = vec4(irradianceAt(inputs[i].xyz, inputs[i + 1u].xyz, ivec3(5, 4, 3), vec3(2, 1, 0.5)), 0);",
      points, 0, {{"LPV_CHANNELS", std::to_string(channels)}, {"LPV_NEAREST", lookup == Lookup::kNearest ? "1" : "0"}});
  for (std::size_t i = 0; i < points.size(); i += 2) {
    const Irradiance want = irradianceAt(volume, lookup, glm::dvec3(points[i]), glm::dvec3(points[i + 1]));
    // A GPU's filter weights have 8 bits: 1/256 of the largest difference between neighbours.
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(out[i][c], want.rgb[c], 0.02) << points[i].x << " " << points[i].y << " " << points[i].z;
  }
}

// Broken by: texture coordinates without / dims, a rim of 0 or 1 cell, D with the wrong sign or order of components.
TEST_F(LookupTest, TrilinearIsTheSameInGlslAndCpp) { compare(3, Lookup::kSh2); }
TEST_F(LookupTest, MonochromeIsTheSameTimesItsColour) { compare(1, Lookup::kSh2); }
TEST_F(LookupTest, NearestIsTheSameInGlslAndCpp) { compare(3, Lookup::kNearest); }

}  // namespace
}  // namespace lpv
