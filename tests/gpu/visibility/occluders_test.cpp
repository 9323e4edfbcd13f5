// visibility/occluders.glsl = Occluders of scene/occluders.h.
#include "lpv/resources/occluders.h"

#include <random>

#include "gpu/support/gl_test.h"
#include "gpu/support/stage_rig.h"
#include "reference/meshes.h"
#include "reference/occlusion.h"
#include "scene/placed_trees.h"
#include "scene/transform.h"

namespace lpv {
namespace {

using reference::Meeting;
using reference::Segment;

Transform pose(const glm::dvec3& at, const glm::dvec3& scale, double angle) {
  return {at, glm::angleAxis(angle, glm::normalize(glm::dvec3(1, 2, 3))), scale};
}

void addSurface(Scene& scene, const MeshPtr& mesh, const Transform& transform = {}) {
  auto surface = std::make_shared<Surface>();
  surface->name = "surface " + std::to_string(scene.surfaces.size());
  surface->mesh = mesh;
  surface->transform = transform;
  scene.surfaces[surface->name] = surface;
}

void addLight(Scene& scene, const std::string& name, const MeshPtr& mesh, const Transform& transform) {
  auto light = std::make_shared<Light>();
  light->name = name;
  light->mesh = mesh;
  light->transform = transform;
  scene.lights[name] = light;
}

/// A box of 4 m seen from inside with what stands in it: meshes that are shared, scaled, mirrored; lights with their
/// own shadows. 32 cells.
Scene fullRoom() {
  Scene scene;
  scene.grid = {glm::dvec3(9, -2, 1), 0.125, glm::ivec3(32)};
  const glm::dvec3 middle = scene.grid.worldFromGrid(glm::dvec3(16));
  addSurface(scene, reference::box(middle - 2.0, middle + 2.0, true));
  const MeshPtr rock = reference::bumpySphere(800), pyramid = reference::pyramid();
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 at = middle + 1.3 * glm::dvec3(std::cos(i), std::sin(i), std::cos(2.0 * i));
    addSurface(scene, i % 2 == 0 ? rock : pyramid, pose(at, {i % 3 == 0 ? -0.5 : 0.6, 0.3 + 0.1 * i, 0.5}, 0.7 * i));
  }
  addLight(scene, "flat", reference::quad(), pose(middle + glm::dvec3(0, 1, 0), glm::dvec3(1), 0.3));
  addLight(scene, "rock", rock, pose(middle, glm::dvec3(0.8, 1.2, 0.8), 1.0));
  return scene;
}

class OccludersTest : public test::GlTest {
 protected:
  /// Whether each segment, grid space, is open for light of `light`.
  static std::vector<bool> openOnGpu(const GpuOccluders& occluders, const std::vector<Segment>& segments, int light) {
    std::vector<glm::vec4> inputs;
    for (const Segment& s : segments) {
      inputs.emplace_back(glm::vec3(s.from), float(light));
      inputs.emplace_back(glm::vec3(s.to), 0.0F);
    }
    occluders.bind();
    const auto out = test::evaluate("#define LPV_TRANSPARENT 0\n#include \"visibility/occluders.glsl\"",
                                    "if (i % 2u == 0u) outputs[i / 2u] = vec4(transmitted(inputs[i].xyz, inputs[i + "
                                    "1u].xyz, int(inputs[i].w)), 0.0);",
                                    inputs, segments.size());
    std::vector<bool> open;
    for (const glm::vec4& o : out) open.push_back(o.x != 0.0F);
    return open;
  }

  static std::vector<bool> openOnGpu(const Scene& scene, const std::vector<Segment>& segments, int light) {
    GpuOccluders occluders;
    test::finish(occluders.update(occludersOf(scene), scene.grid));
    return openOnGpu(occluders, segments, light);
  }

  /// Compares with the CPU and with a look at all triangles. A float cannot tell what is unclear by 1e-3 of a triangle.
  static void compare(const Scene& scene, const GpuOccluders& occluders, int light, std::size_t count = 5000) {
    const reference::Occlusion truth(occludersOf(scene), scene.grid.gridFromWorldMatrix());
    const Occluders cpu(scene);
    const auto segments = reference::randomSegments(count, glm::dvec3(0), glm::dvec3(scene.grid.dims), 5);
    const std::vector<bool> open = openOnGpu(occluders, segments, light);
    std::size_t different = 0, onCpu = 0, unclear = 0, blocked = 0;
    for (std::size_t i = 0; i < segments.size(); ++i) {
      const Meeting want = truth.meeting(segments[i], light, 1e-3);
      unclear += std::size_t(want == Meeting::kUnclear);
      blocked += std::size_t(want == Meeting::kSome);
      if (want == Meeting::kUnclear) continue;
      const Grid& grid = scene.grid;
      different += std::size_t(open[i] != (want == Meeting::kNone));
      onCpu += std::size_t(
          open[i] == cpu.blocked(grid.worldFromGrid(segments[i].from), grid.worldFromGrid(segments[i].to), light));
    }
    EXPECT_EQ(different, 0U) << light;
    EXPECT_EQ(onCpu, 0U) << light;
    EXPECT_LE(unclear, segments.size() / 50);
    EXPECT_GE(blocked, segments.size() / 10);
    EXPECT_LE(blocked, segments.size() - segments.size() / 10);
  }

  static void expectBlocked(const Scene& scene, const std::vector<Segment>& segments, const std::string& what) {
    const std::vector<bool> open = openOnGpu(scene, segments, kAllLights);
    EXPECT_EQ(std::ranges::count(open, true), 0) << what << ", of " << segments.size();
  }
};

// Red with the wrong skip, first triangle or row of a matrix.
TEST_F(OccludersTest, AreTheSameInGlslAndCpp) {
  const Scene scene = fullRoom();
  GpuOccluders occluders;
  test::finish(occluders.update(occludersOf(scene), scene.grid));
  for (const int light : {kAllLights, 0, 1, 2}) compare(scene, occluders, light);
}

// What a ray sees first, and of which side. A float cannot tell which of two triangles has an edge.
// Red with the last hit instead of the first, and with sides that turn with mirrored objects.
TEST_F(OccludersTest, FirstHitsAreTheSameInGlslAndCpp) {
  const Scene scene = fullRoom();
  GpuOccluders occluders;
  test::finish(occluders.update(occludersOf(scene), scene.grid));
  const Occluders cpu(scene);
  const Grid& grid = scene.grid;
  const auto segments = reference::randomSegments(4000, glm::dvec3(0), glm::dvec3(grid.dims), 6);
  std::vector<glm::vec4> inputs;
  for (const Segment& s : segments) {
    inputs.emplace_back(glm::vec3(s.from), 0.0F);
    inputs.emplace_back(glm::vec3(s.to), 0.0F);
  }
  occluders.bind();
  const auto out = test::evaluate(
      "#define LPV_TRANSPARENT 0\n#include \"visibility/occluders.glsl\"\n#include \"visibility/first_hit.glsl\"",
      "if (i % 2u == 0u) { int rounds = 0; const Sight s = firstHit(inputs[i].xyz, inputs[i + 1u].xyz, rounds); "
      "outputs[i "
      "/ 2u] = vec4(s.at, float(texelFetch(occluders, s.instance + 6).x), float(s.triangle), s.front ? 1.0 : 0.0); }",
      inputs, segments.size());
  std::size_t different = 0, hits = 0, backs = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const auto want = cpu.firstHit(grid.worldFromGrid(segments[i].from), grid.worldFromGrid(segments[i].to));
    const bool met = out[i].x < 1.0F;
    hits += std::size_t(want.has_value());
    backs += std::size_t(want && !want->front);
    if (met != want.has_value()) {
      ++different;
      continue;
    }
    if (!want) continue;
    const glm::dvec3 at = glm::mix(segments[i].from, segments[i].to, double(out[i].x));
    const bool same = glm::distance(grid.worldFromGrid(at), want->position) < 1e-3 &&
                      int(out[i].y) == want->surface + 1 && (out[i].w == 1.0F) == want->front;
    different += std::size_t(!same);
  }
  EXPECT_LE(different, segments.size() / 500);
  EXPECT_GE(hits, segments.size() / 5);
  EXPECT_GE(backs, segments.size() / 100);
}

// Red where what stands in the buffer is taken for what the scene has now.
TEST_F(OccludersTest, FollowTheScene) {
  Scene scene = fullRoom();
  GpuOccluders occluders;
  test::finish(occluders.update(occludersOf(scene), scene.grid));
  const auto changed = [&](const std::string& name, const auto& change) {
    auto surface = std::make_shared<Surface>(*scene.surfaces.at(name));
    change(*surface);
    scene.surfaces[name] = surface;
    test::finish(occluders.update(occludersOf(scene), scene.grid));
    compare(scene, occluders, 1, 1000);
  };
  changed("surface 1", [](Surface& s) { s.transform.translation.x += 0.4; });
  changed("surface 2", [](Surface& s) { s.mesh = reference::bumpySphere(1200); });
  for (int i = 0; i < 20; ++i)
    addSurface(scene, reference::pyramid(), pose({10.0 + 0.1 * i, -1, 2}, glm::dvec3(0.3), i));
  changed("surface 3", [](Surface& s) { s.mesh = reference::sphere(); });
  scene.surfaces.erase("surface 4");
  scene.lights.erase("rock");
  changed("surface 5", [](Surface& s) { s.transform.scale *= 2.0; });
  scene.grid = {glm::dvec3(9.5, -1.5, 1.5), 0.25, glm::ivec3(12)};
  changed("surface 6", [](Surface& s) { s.transform.scale *= 1.5; });
}

TEST_F(OccludersTest, NothingBlocksInAnEmptyScene) {
  Scene scene;
  scene.grid = test::unitGrid(glm::ivec3(8));
  for (const bool open : openOnGpu(scene, reference::randomSegments(100, glm::dvec3(0), glm::dvec3(8), 1), kAllLights))
    EXPECT_TRUE(open);
  Mesh line;
  line.positions = {{0, 0, 0}, {4, 4, 4}, {8, 8, 8}};
  line.triangles = {{0, 1, 2}};
  ASSERT_TRUE(finishMesh(line).ok());
  addSurface(scene, std::make_shared<Mesh>(line));
  for (const bool open : openOnGpu(scene, {{{1, 3, 2}, {3, 1, 2}}}, kAllLights)) EXPECT_TRUE(open);
}

// Where the grid is a small part of the scene, or far from the world's origin, some surfaces stay in their own spaces
// (scene/placed_trees.h); where there are many, the tree above has as many leaves. Red where a subtree's end is its
// tree's.
TEST_F(OccludersTest, AreTheSameInOneSpaceAndInTheirOwn) {
  Scene near = fullRoom();
  near.grid = {near.grid.worldFromGrid(glm::dvec3(12)), 0.005, glm::ivec3(128)};
  Scene far = fullRoom();
  const glm::dvec3 away(1e5, -3e4, 2e5);
  for (auto& [name, surface] : far.surfaces) {
    auto moved = std::make_shared<Surface>(*surface);
    moved->transform.translation += away;
    surface = moved;
  }
  for (auto& [name, light] : far.lights) {
    auto moved = std::make_shared<Light>(*light);
    moved->transform.translation += away;
    light = moved;
  }
  far.grid.origin += away;
  Scene many = fullRoom();
  const MeshPtr rock = reference::bumpySphere(200);
  const glm::dvec3 middle = many.grid.worldFromGrid(glm::dvec3(16));
  for (int i = 0; i < 400; ++i) {
    const glm::dvec3 at = middle + 1.7 * glm::dvec3(std::sin(1.3 * i), std::sin(2.1 * i), std::cos(0.7 * i));
    addSurface(many, rock, pose(at, glm::dvec3(0.05 + 0.001 * (i % 50)), i));
  }
  for (const Scene& scene : {near, far, many}) {
    const CommonSpace space = commonSpaceOf(occludersOf(scene), scene.grid);
    EXPECT_GE(space.members.size(), 4U);
    EXPECT_GE(space.others.size(), 1U);
    GpuOccluders occluders;
    test::finish(occluders.update(occludersOf(scene), scene.grid));
    compare(scene, occluders, 1, 2000);
  }
}

// Red where two triangles that share an edge may both say that a ray passes beside them.
TEST_F(OccludersTest, LetNothingThroughWhereTrianglesShareAnEdge) {
  const std::vector<std::pair<std::string, MeshPtr>> meshes = {
      {"box", reference::box(glm::dvec3(-0.5), glm::dvec3(0.5))},
      {"sphere", reference::sphere()},
      {"fine sphere", reference::sphereOf(400, 201, false)},
      {"bumpy sphere", reference::bumpySphere(20000)}};
  for (const auto& [name, mesh] : meshes) {
    for (const Transform& t : {pose({16, 16, 16}, glm::dvec3(24), 0), pose({20, 40, 60}, {40, -5, 20}, 0.8),
                               pose({120, 120, 120}, glm::dvec3(1), 2)}) {
      Scene scene;
      scene.grid = test::unitGrid(glm::ivec3(128));
      addSurface(scene, mesh, t);
      const Occluder occluder = occludersOf(scene)[0];
      const glm::dvec3 from(occluder.worldFromObject * glm::dvec4(0.1, 0.05, -0.03, 1.0));
      expectBlocked(scene, reference::segmentsThroughEdges(occluder, from, 20000), name);
    }
  }
}

// Segments along axes meet boxes without thickness, and triangles in their edges.
TEST_F(OccludersTest, LetNothingThroughAlongAxes) {
  constexpr int kCuts = 16;
  Scene scene;
  scene.grid = test::unitGrid(glm::ivec3(16));
  addSurface(scene, reference::quadOf(kCuts), {glm::dvec3(8), {1, 0, 0, 0}, glm::dvec3(kCuts)});
  std::vector<Segment> segments;
  for (int i = 1; i < kCuts; ++i) {
    for (int k = 1; k < 2 * kCuts; ++k) {
      segments.push_back({{i, 0.5 * k, 1}, {i, 0.5 * k, 15}});
      segments.push_back({{0.5 * k, i, 15}, {0.5 * k, i, 1}});
    }
  }
  expectBlocked(scene, segments, "square");
}

// Red where three equal sides count as none.
TEST_F(OccludersTest, MeetTheMiddleOfARegularTriangle) {
  Scene scene;
  scene.grid = test::unitGrid(glm::ivec3(8));
  addSurface(scene, test::meshOf({{glm::vec3(4, 1, 1), glm::vec3(1, 4, 1), glm::vec3(1, 1, 4)}}));
  expectBlocked(scene, {{{0, 0, 0}, {5, 5, 5}}, {{5, 5, 5}, {0, 0, 0}}}, "triangle");
}

/// A square of 1 m at the origin as strips of two triangles.
MeshPtr strips(int count) {
  std::vector<std::array<glm::vec3, 3>> triangles;
  for (int i = 0; i < count; ++i) {
    const float x = float(i) / float(count) - 0.5F, next = float(i + 1) / float(count) - 0.5F;
    triangles.push_back({glm::vec3(x, -0.5F, 0), {next, -0.5F, 0}, {x, 0.5F, 0}});
    triangles.push_back({glm::vec3(next, -0.5F, 0), {next, 0.5F, 0}, {x, 0.5F, 0}});
  }
  return test::meshOf(triangles);
}

// Floors that are askew in their meshes, so that their boxes say nothing. Red with an offset of 1e-6 cells; with
// normals that the shader works out.
TEST_F(OccludersTest, LeaveOpenWhatStartsJustAboveAFloor) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(-0.45, 0.45);
  for (const MeshPtr& floor : {reference::quad(), reference::quadOf(200), strips(30), strips(1000)}) {
    for (const double angle : {0.0, 0.9}) {
      Scene scene;
      scene.grid = test::unitGrid(glm::ivec3(128));
      addSurface(scene, reference::turned(floor, 0.8), pose(glm::dvec3(64), glm::dvec3(110), angle));
      const glm::dmat4 m = scene.surfaces.begin()->second->transform.worldFromObject() * reference::turn(0.8);
      std::vector<Segment> segments;
      for (int i = 0; i < 20000; ++i) {
        const double x = share(random), y = share(random), up = (i % 3) * (0.2 + 0.4 * share(random));
        const double above = layout::kShadowOffset / 110.0;
        segments.push_back({glm::dvec3(m * glm::dvec4(x, y, above, 1.0)),
                            glm::dvec3(m * glm::dvec4(share(random), share(random), above + up, 1.0))});
      }
      const std::vector<bool> open = openOnGpu(scene, segments, kAllLights);
      EXPECT_EQ(std::ranges::count(open, false), 0) << floor->triangles.size() << ", turned by " << angle;
    }
  }
}

}  // namespace
}  // namespace lpv
