// The volume product (MATHS.md 3a) against the reference: signs, factors, the clamp of moments, colours of channels.

#include "lpv/transport/volume.h"

#include <random>

#include "gpu/support/stage_rig.h"
#include "reference/compare.h"
#include "reference/volume.h"

namespace lpv {
namespace {

class VolumeTest : public test::GlTest {};

Palette paletteOf(int channels) {
  Palette palette;
  palette.channels = channels;
  palette.radiance = {glm::dvec3(4, 2, 1), glm::dvec3(0.5, 3, 1), glm::dvec3(0, 1, 7)};
  return palette;
}

/// Random coefficients, a third of them beyond what real light has.
std::vector<glm::vec4> randomHalo(const glm::ivec3& dims, int channels) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
  std::vector<glm::vec4> out(std::size_t(channels * (dims.x + 2) * (dims.y + 2) * (dims.z + 2)));
  for (glm::vec4& c : out) c = {0.8F + uniform(random), uniform(random), uniform(random), uniform(random)};
  return out;
}

struct VolumeRig {
  VolumeRig(const Grid& grid, int channels) : field(grid, channels), palette(paletteOf(channels)) {
    const gpu::Buffer upload = test::bufferOf(randomHalo(grid.dims, channels));
    for (const FieldBuffer* target : {&field.injected, &field.pingPong[0]})
      glCopyNamedBufferSubData(upload.id(), target->buffer.id(), 0, 0, GLsizeiptr(upload.size()));
    field.result = 0;
  }
  reference::Field make(VolumeTarget target) {
    StageClock clock;
    VolumeMaker maker;
    const bool injected = target == VolumeTarget::kInjected;
    test::finish(maker.run(field, injected ? field.injected : field.transported(), palette, target, {&clock}));
    Volume volume;
    volume.grid = field.grid;
    volume.layers = {{"", test::read<float>(field.incidentVolume)}};
    return reference::fieldOf(volume);
  }
  std::vector<glm::vec4> makeTexture(int colour) {
    StageClock clock;
    VolumeMaker maker;
    test::finish(maker.run(field, field.transported(), palette, VolumeTarget::kTextures, {&clock}));
    std::vector<glm::vec4> texels(field.grid.cells());
    glGetTextureImage(field.textures->colours[std::size_t(colour)].id(), 0, GL_RGBA, GL_FLOAT,
                      GLsizei(texels.size() * 16), texels.data());
    return texels;
  }
  LightField field;
  Palette palette;
};

Grid grid() { return {glm::dvec3(-1.0), 0.25, {9, 5, 7}}; }

// Broken by: no minus on band 1; 1.5 s for 1.5 s^2; D cut at phi Y00; clamping before the palette's colours are mixed.
TEST_F(VolumeTest, ProductIsTheReferences) {
  for (int channels = 1; channels <= 3; ++channels) {
    VolumeRig rig(grid(), channels);
    const reference::Product want =
        reference::productOf(test::fieldOf(rig.field.pingPong[0], rig.field, rig.palette), rig.field.grid.cell);
    EXPECT_LE(reference::relativeL2(rig.make(VolumeTarget::kTransported), want.incident), 1e-6) << channels;
    EXPECT_EQ(test::read<layout::Counters>(rig.field.counters)[0].clamped, want.clampedCells) << channels;
    EXPECT_GT(want.clampedCells, 20U);
  }
}

TEST_F(VolumeTest, InjectedIsTheFieldWithItsColours) {
  for (int channels = 1; channels <= 3; ++channels) {
    VolumeRig rig(grid(), channels);
    const reference::Field want = test::fieldOf(rig.field.injected, rig.field, rig.palette);
    EXPECT_LE(reference::relativeL2(rig.make(VolumeTarget::kInjected), want), 1e-6) << channels;
  }
}

// What frames read is what clients read. Broken by: colours exchanged between textures.
TEST_F(VolumeTest, TexturesHoldTheProduct) {
  for (int channels = 1; channels <= 3; ++channels) {
    VolumeRig rig(grid(), channels);
    const reference::Field product = rig.make(VolumeTarget::kTransported);
    const int colours = channels == 1 ? 1 : 3;
    for (int colour = 0; colour < colours; ++colour) {
      const double unit = channels == 1 ? rig.palette.radiance[0][colour] : 1.0;
      const std::vector<glm::vec4> texels = rig.makeTexture(colour);
      for (std::size_t cell = 0; cell < texels.size(); ++cell) {
        for (int k = 0; k < 4; ++k)
          ASSERT_NEAR(unit * double(texels[cell][k]), product.cells[cell][std::size_t(colour)][k], 1e-4);
      }
    }
  }
}

}  // namespace
}  // namespace lpv
