// visibility/occluders.glsl with LPV_TRANSPARENT = Occluders of scene/occluders.h, through panes and masks.
#include <gmock/gmock.h>

#include "gpu/support/gl_test.h"
#include "gpu/support/stage_rig.h"
#include "lpv/resources/occluders.h"
#include "reference/meshes.h"
#include "reference/occlusion.h"
#include "reference/textures.h"

namespace lpv {
namespace {

using reference::Segment;

class TransparencyTest : public test::GlTest {
 protected:
  static std::vector<glm::dvec3> onGpu(const GpuOccluders& occluders, const std::vector<Segment>& segments) {
    std::vector<glm::vec4> inputs;
    for (const Segment& s : segments) {
      inputs.emplace_back(glm::vec3(s.from), 0.0F);
      inputs.emplace_back(glm::vec3(s.to), 0.0F);
    }
    occluders.bind();
    const auto out = test::evaluate(
        "#define LPV_TRANSPARENT 1\n#include \"visibility/occluders.glsl\"",
        "if (i % 2u == 0u) outputs[i / 2u] = vec4(transmitted(inputs[i].xyz, inputs[i + 1u].xyz, -1), 0.0);", inputs,
        segments.size());
    std::vector<glm::dvec3> shares;
    for (const glm::vec4& o : out) shares.emplace_back(o);
    return shares;
  }
  static std::vector<glm::dvec3> onGpu(const Scene& scene, const std::vector<Segment>& segments) {
    GpuOccluders occluders;
    test::finish(occluders.update(occludersOf(scene), scene.grid));
    EXPECT_TRUE(occluders.transparent());
    return onGpu(occluders, segments);
  }
};

Surface& putSurface(Scene& scene, const MeshPtr& mesh, const Transform& transform) {
  auto surface = std::make_shared<Surface>();
  surface->name = "surface " + std::to_string(scene.surfaces.size());
  surface->mesh = mesh;
  surface->transform = transform;
  scene.surfaces[surface->name] = surface;
  return *surface;
}

Transform scaledAt(const glm::dvec3& at, double scale, double angle) {
  return {at, glm::angleAxis(angle, glm::normalize(glm::dvec3(1, 2, 3))), glm::dvec3(scale)};
}

/// 16 m of panes, glass boxes, masks of two textures and stones, in cells of .5 m.
Scene fullScene() {
  Scene scene;
  scene.grid = {glm::dvec3(-8), 0.5, glm::ivec3(32)};
  const TexturePtr bars = reference::alphaTextureOf(16, 8, [](int x, int) { return std::uint8_t(x % 2 * 255); });
  const TexturePtr leaf = reference::alphaTextureOf(
      512, 512, [](int x, int y) { return std::uint8_t(std::hypot(x - 256, y - 256) < 200 ? 255 : y / 4); });
  for (int i = 0; i < 12; ++i) {
    const glm::dvec3 at = 5.0 * glm::dvec3(std::cos(i), std::sin(1.7 * i), std::cos(2.3 * i));
    Surface& surface =
        putSurface(scene, i % 3 == 0 ? reference::box(glm::dvec3(-0.5), glm::dvec3(0.5)) : reference::quadOf(3),
                   scaledAt(at, 4.0 + i % 4, 0.8 * i));
    surface.opacity = 0.1 + 0.05 * i;
    surface.transmission = {1.0, 0.9 - 0.05 * i, 0.5};
    surface.alphaMode = AlphaMode::kBlend;
    if (i % 3 != 1) continue;
    surface.albedoTexture = i % 2 == 0 ? bars : leaf;
    surface.alphaMode = i % 4 < 2 ? AlphaMode::kMask : AlphaMode::kBlend;
    surface.alphaCutoff = 0.25;
    surface.opacity = 0.9;
  }
  for (int i = 0; i < 4; ++i)
    putSurface(scene, reference::bumpySphere(200), scaledAt(glm::dvec3(3 * i - 5, i, -i), 0.8, i));
  return scene;
}

// Red with another texel of coordinates or of a map, with the weights of other corners, or without transmission.
TEST_F(TransparencyTest, IsTheSameInGlslAndCpp) {
  const Scene scene = fullScene();
  const Occluders cpu(scene);
  const auto segments = reference::randomSegments(8000, glm::dvec3(0), glm::dvec3(32), 7);
  const std::vector<glm::dvec3> shares = onGpu(scene, segments);
  std::size_t different = 0, partly = 0, blocked = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const glm::dvec3 want = cpu.transmitted(scene.grid.worldFromGrid(segments[i].from),
                                            scene.grid.worldFromGrid(segments[i].to), kAllLights);
    different += std::size_t(glm::any(glm::greaterThan(glm::abs(shares[i] - want), glm::dvec3(1e-5))));
    blocked += std::size_t(want == glm::dvec3(0.0));
    partly += std::size_t(want != glm::dvec3(0.0) && want != glm::dvec3(1.0));
  }
  EXPECT_LE(different, segments.size() / 500) << "beside edges, of triangles and of texels";
  EXPECT_GE(partly, segments.size() / 5);
  EXPECT_GE(blocked, segments.size() / 20);
}

// Red where both triangles of an edge count, or none.
TEST_F(TransparencyTest, APaneIsOnePaneWhereItsTrianglesMeet) {
  constexpr int kCuts = 16;
  Scene scene;
  scene.grid = test::unitGrid(glm::ivec3(16));
  Surface& pane = putSurface(scene, reference::quadOf(kCuts), {glm::dvec3(8), {1, 0, 0, 0}, glm::dvec3(kCuts)});
  pane.alphaMode = AlphaMode::kBlend;
  pane.opacity = 0.5;
  std::vector<Segment> segments;
  for (int i = 1; i < 2 * kCuts; ++i) {
    for (int k = 1; k < 2 * kCuts; ++k) {
      segments.push_back({{0.5 * i, 0.5 * k, 1}, {0.5 * i, 0.5 * k, 15}});
      segments.push_back({{0.5 * i, 0.5 * k, 15}, {0.5 * i, 0.5 * k, 1}});
    }
  }
  EXPECT_THAT(onGpu(scene, segments), testing::Each(glm::dvec3(0.5)));
}

// Red where what stands in the buffer is taken for what the scene has now.
TEST_F(TransparencyTest, FollowsTheScene) {
  Scene scene;
  scene.grid = test::unitGrid(glm::ivec3(16));
  putSurface(scene, reference::quadOf(1), scaledAt(glm::dvec3(8), 10, 0));
  GpuOccluders occluders;
  const std::vector<Segment> through = {{{5.1, 8, 2}, {5.2, 8, 14}}};
  const auto changed = [&](const auto& change) {
    auto surface = std::make_shared<Surface>(*scene.surfaces.begin()->second);
    change(*surface);
    scene.surfaces.begin()->second = surface;
    test::finish(occluders.update(occludersOf(scene), scene.grid));
    return onGpu(occluders, through)[0].x;
  };
  EXPECT_EQ(changed([](Surface&) {}), 0.0);
  EXPECT_FALSE(occluders.transparent());
  EXPECT_EQ(changed([](Surface& s) { s.alphaMode = AlphaMode::kBlend, s.opacity = 0.25; }), 0.75);
  EXPECT_TRUE(occluders.transparent());
  const auto half = [](bool left) {
    return reference::alphaTextureOf(2, 1, [left](int x, int) { return std::uint8_t((x == 0) == left ? 255 : 0); });
  };
  EXPECT_EQ(changed([&](Surface& s) { s.albedoTexture = half(true); }), 0.75);
  EXPECT_EQ(changed([&](Surface& s) { s.albedoTexture = half(false); }), 1.0);
  EXPECT_EQ(changed([](Surface& s) { s.castsShadow = false; }), 1.0);
  EXPECT_FALSE(occluders.transparent());
}

}  // namespace
}  // namespace lpv
