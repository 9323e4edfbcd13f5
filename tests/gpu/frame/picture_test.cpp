// Whole pictures against the double-precision reference renderer: no committed images.

#include "gpu/engine/engine_rig.h"
#include "reference/compare.h"
#include "reference/render.h"
#include "reference/room.h"

namespace lpv {
namespace {

class PictureTest : public test::EngineTest {
 protected:
  /// The engine's picture against the reference's, from the engine's own volume (`transport_test` holds that), away
  /// from edges, where coverage of a pixel's centre may differ. Thresholds: half floats for albedo (5e-4), 16-bit
  /// normals (4e-5), 8-bit filter weights of GPUs (4e-3 of a neighbour's difference) leave 1 % of the mean at most and
  /// 0.2 % on average; a wrong normal, texel or cell is 10 % and more.
  void compare(const Scene& scene, const Camera& camera, Lookup lookup = Lookup::kSh2) {
    Scene asked = scene;
    asked.options.lookup = lookup;
    TickRequest request = test::requestOf(asked);
    request.transported = true;
    request.frames = {test::linearFrame(camera, {192, 108})};
    const TickResult result = run(request);
    ASSERT_EQ(result.frames.size(), 1U);
    const reference::RenderOptions options{192, 108, lookup, true};
    const reference::Picture want = reference::render(asked, *result.transported, camera, options);
    std::vector<glm::dvec3> got;
    double mean = 0.0;
    for (int y = 0; y < 108; ++y) {
      for (int x = 0; x < 192; ++x) got.push_back(test::pixel(*result.frames[0], x, y));
    }
    const std::vector<bool> interior = reference::interiorOf(want);
    for (const glm::dvec3& c : want.radiance) mean += (c.r + c.g + c.b) / (3.0 * 192 * 108);
    const reference::PictureDifference d = reference::compare(got, want.radiance, 0.01 * mean, interior);
    EXPECT_LE(d.max, 0.01 * mean * largestShare(want)) << reference::describe(d);
    EXPECT_LE(d.mean, 0.002 * mean) << reference::describe(d);
    // Edges too, but for the pixels where the two may decide differently: at most one in fifty.
    EXPECT_LE(reference::compare(got, want.radiance, 0.02 * mean).shareBeyond, 0.02);
  }

 private:
  /// Differences scale with the pixel's own brightness: the radianceScale surface pixel as a multiple of the mean.
  static double largestShare(const reference::Picture& picture) {
    double mean = 0.0, most = 0.0;
    for (std::size_t i = 0; i < picture.radiance.size(); ++i) {
      const glm::dvec3& c = picture.radiance[i];
      mean += (c.r + c.g + c.b) / (3.0 * double(picture.radiance.size()));
      if (picture.seen[i].object >= 1) most = std::max({most, c.r, c.g, c.b});
    }
    return std::max(1.0, most / mean);
  }
};

// Broken by: nearest for trilinear; vertex normals not renormalised; the box's flat normals from its vertices.
TEST_F(PictureTest, RoomWithALampAndBoxes) { compare(reference::smallRoom(), reference::roomCamera()); }

// 17 cells: with 18 the walls are on cell faces, and the nearest cell of a wall is a matter of the last bit.
TEST_F(PictureTest, RoomWithNearestLookup) {
  compare(reference::smallRoom(17), reference::roomCamera(), Lookup::kNearest);
}

TEST_F(PictureTest, SmoothSphereAndAnObliqueCamera) {
  Scene scene = reference::smallRoom(24);
  Surface& ball = test::addSurface(scene, "ball", reference::sphere());
  ball.transform.translation = {0.1, 0.3, 0.5};
  ball.transform.scale = {0.8, 0.5, -0.6};
  ball.albedo = {0.2, 0.7, 0.9};
  Camera camera = reference::roomCamera();
  camera.eye = {0.8, 0.9, 2.5};
  camera.up = {0.3, 1.0, 0.0};
  compare(scene, camera);
}

// Into an open tube with vertex normals: its far wall is seen from behind. Broken by: normals not turned over.
TEST_F(PictureTest, TheInsideOfATube) {
  Scene scene = reference::smallRoom();
  Surface& tube = test::addSurface(scene, "tube", reference::tube());
  tube.transform.translation = {0.0, 0.2, 0.6};
  tube.transform.rotation = glm::angleAxis(1.2, glm::normalize(glm::dvec3(0.1, 1.0, 0.2)));
  tube.transform.scale = {0.4, 5.0, 5.0};
  compare(scene, reference::roomCamera());
}

// Far from the world's origin nothing gets coarser.
TEST_F(PictureTest, ARoomAMillionMetresAway) {
  const glm::dvec3 far(1e6, -2e6, 3e6);
  Scene scene = reference::smallRoom();
  scene.grid.origin += far;
  for (auto& [name, light] : scene.lights) {
    auto copy = std::make_shared<Light>(*light);
    copy->transform.translation += far;
    light = copy;
  }
  for (auto& [name, surface] : scene.surfaces) {
    auto copy = std::make_shared<Surface>(*surface);
    copy->transform.translation += far;
    surface = copy;
  }
  Camera camera = reference::roomCamera();
  camera.eye += far;
  camera.target += far;
  compare(scene, camera);
}

/// How many channels of rows `first` to `end` differ by more than a hundredth of the picture's mean, as a share.
double shareThatDiffers(const Frame& a, const Frame& b, int first, int end) {
  double mean = 0.0;
  for (const float value : a.rgb32f) mean += double(value) / double(a.rgb32f.size());
  const std::size_t row = std::size_t(a.size.x) * 3;
  std::size_t differ = 0;
  for (std::size_t i = std::size_t(first) * row; i < std::size_t(end) * row; ++i)
    differ += std::abs(double(a.rgb32f[i]) - double(b.rgb32f[i])) > 0.01 * mean ? 1 : 0;
  return double(differ) / double(std::size_t(end - first) * row);
}

// Single pictures of more than two megapixels are made some rows at a time; those of a view, which keeps them, in one
// go. Light, its shadows and edges are the same: positions differ by rounding, which decides a pixel in a thousand
// otherwise. Rows 504 to 519 are on both sides of where the third part begins.
// Broken by: rays that begin anew with each part (5 % of what is on both sides).
TEST_F(PictureTest, LargePicturesAreTheSameInParts) {
  Scene scene = reference::smallRoom();
  scene.options = {};
  scene.options.visibility = Visibility::kOn;
  scene.options.bounces = 0;
  for (const double x : {-0.5, -0.1, 0.3}) {
    test::addSurface(scene, "bar " + std::to_string(x),
                     reference::box(glm::dvec3(x, -0.8, -0.6), glm::dvec3(x + 0.1, 0.6, -0.5)));
  }
  TickRequest request = test::requestOf(scene);
  request.frames = {test::linearFrame(reference::roomCamera(), {4096, 536})};
  request.frames[0].samples = 2;
  const TickResult parts = run(request);
  request.frames[0].view = 7;
  const TickResult whole = run(request);
  ASSERT_EQ(parts.frames.size() + whole.frames.size(), 2U);
  ASSERT_EQ(parts.frames[0]->rgb32f.size(), std::size_t(3) * 4096 * 536);
  ASSERT_EQ(whole.frames[0]->rgb32f.size(), std::size_t(3) * 4096 * 536);
  EXPECT_LE(shareThatDiffers(*whole.frames[0], *parts.frames[0], 0, 536), 1e-3);
  EXPECT_LE(shareThatDiffers(*whole.frames[0], *parts.frames[0], 504, 520), 1e-3);
}

}  // namespace
}  // namespace lpv
