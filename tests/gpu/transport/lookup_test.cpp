// transport/lookup.glsl = irradianceAt of scene/volume.h, and its CAP in float = irradianceCap in double.

#include <cmath>
#include <glm/gtc/packing.hpp>
#include <limits>
#include <random>

#include "gpu/support/gl_test.h"
#include "gpu/texture.h"
#include "reference/random_volumes.h"
#include "scene/lookup.h"
#include "scene/volume.h"

namespace lpv {
namespace {

constexpr glm::ivec3 kDims(5, 4, 3);

glm::vec3 randomUnit(std::mt19937& random) {
  std::normal_distribution<float> normal;
  const float x = normal(random), y = normal(random);
  return glm::normalize(glm::vec3(x, y, normal(random)));
}

/// Random layers whose colours differ (channels 3) or are one field times (2, 1, 0.5) (channels 1); |D| / phi anywhere
/// from 0 to far above 1.
Volume randomVolume(int channels, int groups, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  Volume volume;
  volume.grid = {glm::dvec3(0.0), 1.0, kDims};
  volume.layers.resize(std::size_t(groups));
  for (VolumeLayer& layer : volume.layers) {
    for (std::size_t cell = 0; cell < volume.grid.cells(); ++cell) {
      glm::vec4 c(0.0F);
      for (int colour = 0; colour < 3; ++colour) {
        if (colour == 0 || channels == 3)
          c = {1.0F + uniform(random), uniform(random), uniform(random), uniform(random)};
        const float unit = channels == 3 ? 1.0F : std::array{2.0F, 1.0F, 0.5F}[std::size_t(colour)];
        for (int k = 0; k < 4; ++k) layer.coefficients.push_back(unit * c[k]);
      }
    }
  }
  return volume;
}

/// One colour of all layers, each above the one before.
gpu::Texture textureOf(const Volume& volume, int colour, float unit) {
  std::vector<glm::vec4> texels;
  for (const VolumeLayer& layer : volume.layers) {
    for (std::size_t cell = 0; cell < volume.grid.cells(); ++cell) {
      const float* c = layer.coefficients.data() + (cell * 3 + std::size_t(colour)) * 4;
      texels.emplace_back(glm::vec4(c[0], c[1], c[2], c[3]) / unit);
    }
  }
  const glm::ivec3& dims = volume.grid.dims;
  const glm::ivec3 size(dims.x, dims.y, dims.z * int(volume.layers.size()));
  gpu::Texture texture = gpu::Texture::make3d("test", size, GL_RGBA32F, gpu::Sampling::kLinearClamp);
  glTextureSubImage3D(texture.id(), 0, 0, 0, 0, size.x, size.y, size.z, GL_RGBA, GL_FLOAT, texels.data());
  return texture;
}

/// Positions inside, in the rim of half a cell outside, and beyond; each with a normal.
std::vector<glm::vec4> positionsAndNormals() {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  std::vector<glm::vec4> out;
  for (int i = 0; i < 500; ++i) {
    const float x = uniform(random), y = uniform(random), z = uniform(random);
    out.emplace_back(glm::vec3(kDims + 2) * glm::vec3(x, y, z) - 1.0F, 0.0F);
    out.emplace_back(randomUnit(random), 0.0F);
  }
  return out;
}

/// Every cell's centre, where all filters agree, with three normals.
std::vector<glm::vec4> centresAndNormals() {
  std::mt19937 random(4);
  std::vector<glm::vec4> out;
  for (int i = 0; i < 3 * kDims.x * kDims.y * kDims.z; ++i) {
    const int cell = i / 3;
    out.emplace_back(glm::vec3(cell % kDims.x, cell / kDims.x % kDims.y, cell / kDims.x / kDims.y) + 0.5F, 0.0F);
    out.emplace_back(randomUnit(random), 0.0F);
  }
  return out;
}

gpu::Defines definesOf(Lookup lookup, int channels, int groups) {
  gpu::Defines defines = {{"LPV_CHANNELS", std::to_string(channels)}, {"LPV_LOOKUP", std::to_string(int(lookup))}};
  if (groups != 1) defines.push_back({"LPV_GROUPS", std::to_string(groups)});
  return defines;
}

std::string text(const glm::ivec3& v) {
  return "ivec3(" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) + ")";
}

class LookupTest : public test::GlTest {
 protected:
  /// E in GLSL of pairs (position in the grid's space, normal), at every other one of what is returned.
  static std::vector<glm::vec4> looksUp(const Volume& volume, int channels, Lookup lookup,
                                        const std::vector<glm::vec4>& points) {
    std::vector<gpu::Texture> textures;
    for (int colour = 0; colour < channels; ++colour) {
      textures.push_back(textureOf(volume, colour, channels == 1 ? 2.0F : 1.0F));
      textures.back().bind(std::uint32_t(layout::kIncident + colour));
    }
    return test::evaluate("#include \"common/sh.glsl\"\n#include \"transport/lookup.glsl\"",
                          "if (i % 2u == 1u) return;\n"
                          "outputs[i] = vec4(irradianceAt(inputs[i].xyz, inputs[i + 1u].xyz, " +
                              text(volume.grid.dims) + ", vec3(2, 1, 0.5)), 0);",
                          points, 0, definesOf(lookup, channels, int(volume.layers.size())));
  }

  /// Largest difference between the two languages at the points.
  static double difference(const Volume& volume, int channels, Lookup lookup, const std::vector<glm::vec4>& points) {
    const auto out = looksUp(volume, channels, lookup, points);
    double largest = 0.0;
    for (std::size_t i = 0; i < points.size(); i += 2) {
      const Irradiance want = irradianceAt(volume, lookup, glm::dvec3(points[i]), glm::dvec3(points[i + 1]));
      for (int c = 0; c < 3; ++c) {
        const double d = std::abs(double(out[i][c]) - want.rgb[c]);
        largest = std::max(largest, std::isfinite(d) ? d : std::numeric_limits<double>::infinity());
      }
    }
    return largest;
  }

  static void compare(Lookup lookup) {
    for (const int channels : {1, 3}) {
      for (const int groups : {1, 3}) {
        SCOPED_TRACE(testing::Message() << channels << " channels, " << groups << " groups");
        const Volume volume = randomVolume(channels, groups, 7);
        // phi reaches 14 in a group; sums of floats.
        EXPECT_LE(difference(volume, channels, lookup, centresAndNormals()), 1e-4);
        // A GPU's filter weights have 8 bits: 1/256 of the largest difference between neighbours.
        EXPECT_LE(difference(volume, channels, lookup, positionsAndNormals()), 0.02 * groups);
      }
    }
  }

  /// irradianceCap in GLSL of pairs (coefficients, normal).
  static std::vector<double> capsOf(const std::vector<glm::vec4>& coefficientsAndNormals) {
    const auto out = test::evaluate("#include \"common/sh.glsl\"\n#include \"transport/lookup.glsl\"",
                                    "if (i % 2u == 0u) outputs[i] = vec4(irradianceCap(inputs[i], inputs[i + 1u].xyz), "
                                    "irradianceSh2(inputs[i], inputs[i + 1u].xyz), 0, 0);",
                                    coefficientsAndNormals, 0, definesOf(Lookup::kCap, 1, 1));
    std::vector<double> values;
    for (std::size_t i = 0; i < out.size(); i += 2) values.insert(values.end(), {out[i].x, out[i].y});
    return values;
  }
};

// Broken by: a group's z not clamped, texture coordinates or cells that know of one group only, CAP left at SH2, and
// earlier: texture coordinates without / dims, a rim of 0 or 1 cell, D with the wrong sign or order of components.
TEST_F(LookupTest, Sh2IsTheSameInGlslAndCpp) { compare(Lookup::kSh2); }
TEST_F(LookupTest, CapIsTheSameInGlslAndCpp) { compare(Lookup::kCap); }
TEST_F(LookupTest, NearestIsTheSameInGlslAndCpp) { compare(Lookup::kNearest); }

/// Largest difference over the larger of what is wanted and a hundredth of the largest there.
double differenceOf(const std::vector<glm::vec4>& got, const std::vector<glm::dvec3>& wanted) {
  double most = 0.0, largest = 0.0;
  for (const glm::dvec3& e : wanted) most = std::max({most, e.r, e.g, e.b});
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double off = std::abs(double(got[2 * i][c]) - wanted[i][c]) / std::max(wanted[i][c], 0.01 * most);
      largest = std::max(largest, std::isfinite(off) ? off : std::numeric_limits<double>::infinity());
    }
  }
  return largest;
}

// The volumes that the page looks up as well (tests/web/lookup_test.mjs). Broken by: a layer that reads the next one's
// cells.
TEST_F(LookupTest, CapOfVolumesOfClientsIsTheSameInGlslAndCpp) {
  for (const reference::RandomVolume& random : reference::randomVolumes()) {
    const Grid& grid = random.volume.grid;
    std::vector<glm::vec4> points;
    std::vector<glm::dvec3> wanted;
    for (const reference::LookupPoint& point : random.points) {
      points.emplace_back((glm::dvec3(point.position) - grid.origin) / grid.cell, 0.0);
      points.emplace_back(point.normal, 0.0F);
      wanted.push_back(
          irradianceAt(random.volume, Lookup::kCap, glm::dvec3(point.position), glm::dvec3(point.normal)).rgb);
    }
    EXPECT_LE(differenceOf(looksUp(random.volume, 3, Lookup::kCap, points), wanted), 1e-3) << text(grid.dims);
  }
}

/// Coefficients, as floats, of fluence 1 and |D| = rho about w.
glm::vec4 capAbout(const glm::dvec3& w, double rho) { return glm::vec4(sh::fromBands(sh::kY0, sh::kY1 * rho * w)); }

struct CapErrors {
  double absolute = 0.0;  ///< largest, as a share of phi
  double relative = 0.0;  ///< largest, of E or of 1 % of what the cap gives at the horizon, whichever is more
};

// Where the horizon cuts caps of half-angle a, at every height of the cut. Broken by: the built-in atan of llvmpipe
// (wrong by 2e-5).
TEST_F(LookupTest, CapInFloatKeepsItsDigits) {
  std::mt19937 random(9);
  for (const double a : {1.57, 1.5, 1.2, 0.9, 0.5, 0.2, 0.05, 0.01, 0.003}) {
    const double rho = 0.5 * (1.0 + std::cos(a));
    std::vector<glm::vec4> inputs;
    for (int step = -500; step <= 500; ++step) {
      const glm::dvec3 w = randomUnit(random);
      const glm::dvec3 across = glm::normalize(glm::cross(w, glm::dvec3(randomUnit(random))));
      const double cosine = std::sin(a) * step / 480.0;
      if (std::abs(cosine) > 1.0) continue;
      inputs.push_back(capAbout(w, rho));
      inputs.emplace_back(glm::vec3(cosine * w + std::sqrt(1.0 - cosine * cosine) * across), 0.0F);
    }
    const std::vector<double> got = capsOf(inputs);
    CapErrors errors;
    const double atHorizon = 0.2 * std::sin(a);
    for (std::size_t i = 0; i < got.size(); i += 2) {
      const double want = irradianceCap(sh::Coefficients(inputs[i]), glm::dvec3(inputs[i + 1]));
      ASSERT_TRUE(std::isfinite(got[i]));
      errors.absolute = std::max(errors.absolute, std::abs(got[i] - want));
      errors.relative = std::max(errors.relative, std::abs(got[i] - want) / std::max(want, 0.01 * atHorizon));
    }
    // phi - |D| is 1e-7 of phi uncertain in float; the half-angle, and with it E, that much over a.
    EXPECT_LE(errors.absolute, 2e-7 + 1e-7 / a) << "half-angle " << a;
    if (a < 0.2) continue;
    EXPECT_LE(errors.relative, 2e-4) << "half-angle " << a;
  }
}

// The same from exact sines: what is left of the formula's own digits. Broken by: the two terms of capSegment
// subtracted as they stand, which agree in all but a^2 of their digits.
TEST_F(LookupTest, ShareAcrossTheHorizonKeepsItsDigits) {
  for (const double a : {1.57, 1.2, 0.9, 0.5, 0.2, 0.05, 0.01, 0.003}) {
    const auto sine2 = float(std::sin(a) * std::sin(a));
    const double cosine = std::sqrt(1.0 - double(sine2)), rho = 0.5 * (1.0 + cosine);
    std::vector<glm::vec4> inputs;
    for (int step = -99; step <= 99; ++step) inputs.emplace_back(sine2, cosine, std::sin(a) * step / 100.0, 0.0);
    const auto out = test::evaluate("#include \"common/sh.glsl\"\n#include \"transport/lookup.glsl\"",
                                    "outputs[i].x = shareAcrossHorizon(inputs[i].x, inputs[i].y, inputs[i].z);", inputs,
                                    0, definesOf(Lookup::kCap, 1, 1));
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      const double along = inputs[i].z;
      const glm::dvec3 n(std::sqrt(1.0 - along * along), 0.0, along);
      const sh::Coefficients c = sh::fromBands(sh::kY0, sh::kY1 * rho * glm::dvec3(0, 0, 1));
      const double want = irradianceCap(c, n) / rho - std::max(0.0, along);
      ASSERT_NEAR(out[i].x, want, 1e-7 * std::sin(a)) << "half-angle " << a << ", cosine " << along;
    }
  }
}

// MATHS.md 6.4, the lookup's half: any moments, as floats and as half floats round them. Broken by: no test of phi; no
// SH2 below rho = 1/2.
TEST_F(LookupTest, Invariant4FiniteAndNotNegativeForAnyMoments) {
  std::mt19937 random(5);
  std::vector<glm::vec4> inputs;
  for (const double phi : {0.0, -1.0, 6e-8, 1e-3, 1.0, 1e4}) {
    for (int step = 0; step <= 400; ++step) {
      const glm::dvec3 w = step % 2 ? glm::dvec3(randomUnit(random)) : glm::dvec3(0, 0, 1);
      const glm::dvec3 across = glm::normalize(glm::cross(w, glm::dvec3(randomUnit(random))));
      for (const double d : {step / 320.0, phi * step / 320.0}) {
        const glm::vec4 c(sh::fromBands(sh::kY0 * phi, sh::kY1 * d * w));
        for (const glm::dvec3& n : {w, -w, across, glm::dvec3(randomUnit(random))}) {
          inputs.insert(inputs.end(), {c, glm::vec4(n, 0.0)});
          inputs.insert(inputs.end(), {glm::unpackHalf(glm::packHalf(c)), glm::vec4(n, 0.0)});
        }
      }
    }
  }
  const std::vector<double> got = capsOf(inputs);
  for (std::size_t i = 0; i < got.size(); ++i) {
    const glm::vec4& c = inputs[i / 2 * 2];
    const bool dark = i % 2 == 0 && c.x <= 0.0F;
    ASSERT_TRUE(std::isfinite(got[i]) && got[i] >= 0.0 && !(dark && got[i] > 0.0))
        << got[i] << " of " << c.x << " " << c.y << " " << c.z << " " << c.w;
  }
}

}  // namespace
}  // namespace lpv
