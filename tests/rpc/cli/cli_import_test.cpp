// Files on the client's side: what becomes of good ones, and that bad ones are refused in one clear line.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#if defined(LPV_ADDRESS_SANITIZER)
#include <sanitizer/lsan_interface.h>
#endif

#include "import/file_check.h"
#include "import/image.h"
#include "import/names.h"
#include "import/scene_file.h"
#include "npy.h"
#include "rpc/cli/cli_files.h"
#include "values.h"

namespace lpv::cli {
namespace {

using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

bool near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-5) { return glm::length(a - b) <= tolerance; }

#define EXPECT_NEAR3(a, b) EXPECT_TRUE(near(a, b)) << (a).x << ", " << (a).y << ", " << (a).z

template <typename T>
const T& named(const std::vector<T>& objects, const std::string& name) {
  static const T kNone{};
  const auto found = std::find_if(objects.begin(), objects.end(), [&](const T& o) { return o.name == name; });
  EXPECT_NE(found, objects.end()) << name;
  return found == objects.end() ? kNone : *found;
}

class Import : public testing::Test {
 protected:
  ImportedScene load(const std::string& path, const ImportOptions& options = {}) {
    Expected<ImportedScene> scene = importScene(path, options);
    EXPECT_TRUE(scene.ok()) << scene.status().message();
    return scene ? std::move(*scene) : ImportedScene();
  }
  TemporaryFolder folder_;
};

TEST_F(Import, GltfMaterialsBecomeLightsAndSurfaces) {
  const ImportedScene scene = load(folder_.write("room.glb", glb(gltfJson(), gltfBuffer())));
  ASSERT_THAT(scene.lights, SizeIs(2));
  ASSERT_THAT(scene.surfaces, SizeIs(2));
  EXPECT_THAT(scene.warnings, IsEmpty());
  const Light& lamp = named(scene.lights, "Lamp");
  EXPECT_NEAR3(lamp.radiance, glm::dvec3(8, 4, 2));
  EXPECT_TRUE(lamp.twoSided);
  EXPECT_EQ(lamp.texture, nullptr);
  EXPECT_NEAR3(lamp.transform.translation, glm::dvec3(1, 2, 3));
  EXPECT_NEAR3(lamp.transform.scale, glm::dvec3(2));
  EXPECT_NEAR(std::abs(lamp.transform.rotation.y), std::sqrt(0.5), 1e-5);
  EXPECT_THAT(lamp.mesh->triangles, SizeIs(2));
  EXPECT_THAT(lamp.mesh->positions, SizeIs(4));
  const Surface& floor = named(scene.surfaces, "Floor_1");
  EXPECT_NEAR3(floor.albedo, glm::dvec3(0.5, 0.25, 0.125));
  EXPECT_NEAR(floor.roughness, 0.5, 1e-6);
  EXPECT_NEAR(floor.metalness, 0.25, 1e-6);
  EXPECT_FALSE(floor.twoSided);
}

TEST_F(Import, GltfTexturesAndTheirCoordinates) {
  const ImportedScene scene = load(folder_.write("room.glb", glb(gltfJson(), gltfBuffer())));
  const Light& screen = named(scene.lights, "Screen");
  ASSERT_NE(screen.texture, nullptr);
  EXPECT_EQ(screen.texture->width, 2);
  EXPECT_EQ(screen.texture->height, 1);
  EXPECT_EQ(screen.texture->texels, (std::vector<std::uint8_t>{255, 0, 0, 0, 255, 0}));
  EXPECT_EQ(screen.texture, named(scene.surfaces, "Floor_1").albedoTexture);  // one image, read once
  // (0, 0) is the top left corner, in glTF and here: the vertex at the lower left has v = 1.
  ASSERT_THAT(screen.mesh->uvs, SizeIs(4));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(screen.mesh->uvs[i], glm::vec2(screen.mesh->positions[i].x, 1.0F - screen.mesh->positions[i].y));
  }
}

/// The scene with other text in the floor's material, in its base colour's alpha, and the image from `leaf.png`.
std::string gltfWithFloor(const std::string& members, const std::string& alpha) {
  std::string json = gltfJson();
  const auto replace = [&json](const std::string& from, const std::string& to) {
    ASSERT_NE(json.find(from), std::string::npos) << from;
    json.replace(json.find(from), from.size(), to);
  };
  replace(R"("name":"floor",)", R"("name":"floor",)" + members);
  replace("0.125,1]", "0.125," + alpha + "]");
  replace(R"({"bufferView":4,"mimeType":"image/png"})", R"({"uri":"leaf.png"})");
  return json;
}

// Red where the rewritten file loses a member, or alpha is read of an opaque material.
TEST_F(Import, GltfAlpha) {
  folder_.write("leaf.png", halfClearPng());
  const auto floorOf = [&](const std::string& members, const std::string& alpha) {
    const ImportedScene scene = load(folder_.write("room.glb", glb(gltfWithFloor(members, alpha), gltfBuffer())));
    EXPECT_THAT(scene.warnings, IsEmpty());
    return std::pair(named(scene.surfaces, "Floor_1"), scene.assumed);
  };
  const auto [opaque, nothing] = floorOf("", "0.25");
  EXPECT_EQ(opaque.alphaMode, AlphaMode::kOpaque);
  EXPECT_EQ(opaque.albedoTexture->format, TexelFormat::kRgb8Srgb);
  EXPECT_THAT(nothing, IsEmpty());
  const auto [mask, cut] = floorOf(R"("alphaMode":"MASK","alphaCutoff":0.2,)", "1");
  EXPECT_EQ(mask.alphaMode, AlphaMode::kMask);
  EXPECT_NEAR(mask.alphaCutoff, 0.2, 1e-6);
  EXPECT_EQ(mask.albedoTexture->format, TexelFormat::kRgba8Srgb);
  EXPECT_EQ(mask.albedoTexture->texels, (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 0, 64}));
  EXPECT_NEAR3(mask.transmission, glm::dvec3(1));
  EXPECT_THAT(cut, ElementsAre("floor: cut out where alpha is below 20 %"));
  const auto [blend, less] = floorOf(R"("alphaMode":"BLEND",)", "0.25");
  EXPECT_EQ(blend.alphaMode, AlphaMode::kBlend);
  EXPECT_NEAR(blend.opacity, 0.25, 1e-6);
  EXPECT_NEAR3(blend.transmission, glm::dvec3(0.5, 0.25, 0.125));
  EXPECT_THAT(less,
              ElementsAre("floor: lets 38 %, 19 %, 9 % (red, green, blue) of light through, more where its texture "
                          "does, unrefracted"));
}

// Broken by: the rewritten file without it; a picture of normals that is read as sRGB.
TEST_F(Import, GltfNormals) {
  folder_.write("leaf.png", halfClearPng());
  const std::string normals = R"("normalTexture":{"index":0,"scale":0.5},)";
  const ImportedScene scene = load(folder_.write("room.glb", glb(gltfWithFloor(normals, "1"), gltfBuffer())));
  EXPECT_THAT(scene.warnings, IsEmpty());
  const Surface& floor = named(scene.surfaces, "Floor_1");
  ASSERT_NE(floor.normalTexture, nullptr);
  EXPECT_EQ(floor.normalTexture->format, TexelFormat::kRgb8);
  EXPECT_EQ(floor.normalTexture->texels, (std::vector<std::uint8_t>{255, 0, 0, 0, 255, 0}));
  EXPECT_EQ(floor.normalScale, 0.5);
  EXPECT_EQ(floor.albedoTexture->format, TexelFormat::kRgb8Srgb) << "the same file";
}

// Broken by: the rewritten file without it; reading it as sRGB.
TEST_F(Import, GltfRoughnessAndMetalness) {
  folder_.write("leaf.png", halfClearPng());
  std::string json = gltfWithFloor("", "1");
  const std::string pbr = R"("pbrMetallicRoughness":{)", floorStarts = R"("name":"floor",)";
  json.insert(json.find(pbr, json.find(floorStarts)) + pbr.size(), R"("metallicRoughnessTexture":{"index":0},)");
  const ImportedScene scene = load(folder_.write("room.glb", glb(json, gltfBuffer())));
  EXPECT_THAT(scene.warnings, IsEmpty());
  const Surface& floor = named(scene.surfaces, "Floor_1");
  ASSERT_NE(floor.glossTexture, nullptr);
  EXPECT_EQ(floor.glossTexture->format, TexelFormat::kRgb8);
  EXPECT_EQ(floor.glossTexture->texels, (std::vector<std::uint8_t>{255, 0, 0, 0, 255, 0}));
  EXPECT_EQ(floor.roughness, 0.5);
  EXPECT_EQ(floor.metalness, 0.25);
}

// OBJ has a picture for each. Broken by: only one of them, or both in one channel.
TEST_F(Import, ObjRoughnessAndMetalness) {
  folder_.write("rough.pgm", "P5 2 1 255\n\x33\x66");
  folder_.write("metal.pgm", std::string("P5 2 1 255\n\0\xff", 13));
  folder_.write("wide.pgm", "P5 3 1 255\n\x11\xff\xff");
  const auto floorOf = [&](const std::string& material) {
    folder_.write("room.mtl", mtlText() + "newmtl worn\nKd 0.1 0.1 0.1\n" + material);
    std::string text = objText();
    text.replace(text.find("usemtl white"), 12, "vt 0 0\nvt 1 1\nusemtl worn");
    text.replace(text.find("f -4 -1 -2 -3"), 13, "f -4/-2 -1/-1 -2/-2 -3/-1");
    const ImportedScene scene = load(folder_.write("room.obj", text));
    return std::pair(named(scene.surfaces, "floor"), scene.warnings);
  };
  const auto [both, nothing] = floorOf("map_Pr rough.pgm\nmap_Pm metal.pgm\n");
  EXPECT_THAT(nothing, IsEmpty());
  ASSERT_NE(both.glossTexture, nullptr);
  EXPECT_EQ(both.glossTexture->texels, (std::vector<std::uint8_t>{255, 51, 0, 255, 102, 255}));
  EXPECT_EQ(both.metalness, 1.0);
  const auto [rough, none] = floorOf("map_Pr rough.pgm\n");
  EXPECT_EQ(rough.glossTexture->texels, (std::vector<std::uint8_t>{255, 51, 255, 255, 102, 255}));
  EXPECT_EQ(rough.metalness, 0.0);
  const auto [unequal, warned] = floorOf("map_Pr rough.pgm\nmap_Pm wide.pgm\n");
  EXPECT_EQ(unequal.glossTexture->texels, rough.glossTexture->texels);
  EXPECT_THAT(warned, ElementsAre(testing::HasSubstr("give both the same size")));
}

// Triangles share vertices, none of which has the normal of all of them. Broken by: the normal of the last triangle.
TEST_F(Import, GltfWithoutNormalsIsFlat) {
  std::string json = gltfJson();
  const std::string normal = R"("NORMAL":1,)";
  for (std::size_t at = 0; (at = json.find(normal)) != std::string::npos;) json.erase(at, normal.size());
  const ImportedScene scene = load(folder_.write("room.glb", glb(json, gltfBuffer())));
  const Surface& floor = named(scene.surfaces, "Floor_1");
  EXPECT_THAT(floor.mesh->positions, SizeIs(4));
  EXPECT_THAT(floor.mesh->normals, IsEmpty());
}

TEST_F(Import, GltfTransmission) {
  folder_.write("leaf.png", halfClearPng());
  const std::string glass = R"("extensions":{"KHR_materials_transmission":{"transmissionFactor":0.8}},)";
  const ImportedScene scene = load(folder_.write("room.glb", glb(gltfWithFloor(glass, "0.25"), gltfBuffer())));
  EXPECT_THAT(scene.warnings, IsEmpty());
  const Surface& floor = named(scene.surfaces, "Floor_1");
  EXPECT_EQ(floor.alphaMode, AlphaMode::kBlend);
  EXPECT_NEAR(floor.opacity, 0.2, 1e-6);
  EXPECT_EQ(floor.albedoTexture->format, TexelFormat::kRgb8Srgb) << "alpha of an opaque material";
  EXPECT_NEAR3(floor.transmission, glm::dvec3(0.25, 0.125, 0.0));  // times the texture's mean
  EXPECT_THAT(scene.assumed,
              ElementsAre("floor: lets 20 %, 10 %, 0 % (red, green, blue) of light through, unrefracted"));
}

TEST_F(Import, ObjOpacity) {
  folder_.write("room.mtl", mtlText() + "newmtl glass\nKd 0.1 0.1 0.1\nd 0.25\nTf 1 0.5 0.25\n");
  std::string text = objText();
  text.replace(text.find("usemtl white"), 12, "usemtl glass");
  const ImportedScene scene = load(folder_.write("room.obj", text));
  const Surface& floor = named(scene.surfaces, "floor");
  EXPECT_EQ(floor.alphaMode, AlphaMode::kBlend);
  EXPECT_NEAR(floor.opacity, 0.25, 1e-6);
  EXPECT_NEAR3(floor.transmission, glm::dvec3(1.0, 0.5, 0.25));
  EXPECT_THAT(scene.assumed, SizeIs(1));
}

TEST_F(Import, MeanColourInsteadOfEmissiveTextures) {
  ImportOptions options;
  options.ignoreEmissiveTextures = true;
  const ImportedScene scene = load(folder_.write("room.glb", glb(gltfJson(), gltfBuffer())), options);
  const Light& screen = named(scene.lights, "Screen");
  EXPECT_EQ(screen.texture, nullptr);
  EXPECT_NEAR3(screen.radiance, glm::dvec3(0.5, 0.5, 0.0));
  EXPECT_NE(named(scene.surfaces, "Floor_1").albedoTexture, nullptr);
}

TEST_F(Import, ShearGoesIntoTheVertices) {
  const ImportedScene scene = load(folder_.write("room.glb", glb(gltfJson(), gltfBuffer())));
  const Surface& slanted = named(scene.surfaces, "Slanted");
  EXPECT_EQ(slanted.transform, Transform());
  // (1, 0, 0) turned by 45 degrees about z, then y times 3.
  const double h = std::sqrt(0.5);
  bool found = false;
  for (const glm::vec3& p : slanted.mesh->positions) found = found || near(glm::dvec3(p), {h, 3 * h, 0});
  EXPECT_TRUE(found);
}

TEST_F(Import, GltfCamera) {
  const ImportedScene scene = load(folder_.write("room.glb", glb(gltfJson(), gltfBuffer())));
  ASSERT_THAT(scene.cameras, SizeIs(1));
  const auto& [name, camera] = scene.cameras[0];
  EXPECT_EQ(name, "View");
  EXPECT_NEAR3(camera.eye, glm::dvec3(0, 1, 5));
  EXPECT_NEAR3(glm::normalize(camera.target - camera.eye), glm::dvec3(0, 0, -1));
  EXPECT_NEAR(camera.fovDegrees, glm::degrees(0.8), 1e-3);
}

TEST_F(Import, GltfWithFilesBesideIt) {
  folder_.write("data.bin", gltfBuffer());
  const ImportedScene scene = load(folder_.write("room.gltf", gltfJson("data.bin")));
  EXPECT_THAT(scene.lights, SizeIs(2));
  EXPECT_NEAR3(named(scene.lights, "Lamp").radiance, glm::dvec3(8, 4, 2));
}

TEST_F(Import, ObjWithNegativeIndicesAndKe) {
  folder_.write("room.mtl", mtlText());
  const ImportedScene scene = load(folder_.write("room.obj", objText()));
  const Light& lamp = named(scene.lights, "lamp");
  EXPECT_NEAR3(lamp.radiance, glm::dvec3(17, 12, 4));
  EXPECT_FALSE(lamp.twoSided);
  EXPECT_THAT(lamp.mesh->triangles, SizeIs(1));
  const Surface& floor = named(scene.surfaces, "floor");
  EXPECT_NEAR3(floor.albedo, glm::dvec3(0.7, 0.6, 0.5));
  EXPECT_THAT(floor.mesh->triangles, SizeIs(2));
  ASSERT_THAT(floor.mesh->normals, SizeIs(4));
  EXPECT_NEAR3(glm::dvec3(floor.mesh->normals[0]), glm::dvec3(0, 1, 0));
}

TEST_F(Import, PlyAndStlWithUnitAndUpAxis) {
  const std::pair<std::string, std::string> files[] = {
      {"a.ply", asciiPly()}, {"b.ply", binaryPly()}, {"c.stl", binaryStl()}};
  ImportOptions options;
  options.scale = 0.5;
  options.zUp = true;
  for (const auto& [name, bytes] : files) {
    const std::string path = folder_.write(name, bytes);
    const ImportedScene scene = load(path, options);
    ASSERT_THAT(scene.surfaces, SizeIs(1)) << name;
    EXPECT_EQ(scene.surfaces[0].name, name.substr(0, 1));
    EXPECT_NEAR3(scene.surfaces[0].albedo, glm::dvec3(0.8));
    const Bounds bounds = boundsOf(scene);
    EXPECT_NEAR3(bounds.min, glm::dvec3(0, 0, -0.5));  // the file's +y points away
    EXPECT_NEAR3(bounds.max, glm::dvec3(0.5, 0, 0));
    const Expected<Mesh> mesh = importMesh(path, options);
    ASSERT_TRUE(mesh.ok()) << mesh.status().message();
    EXPECT_THAT(mesh->triangles, SizeIs(2));
    EXPECT_NEAR3(mesh->bounds.max, glm::dvec3(0.5, 0, 0));
  }
  EXPECT_THAT(load(folder_.write("d.stl", asciiStl())).surfaces, SizeIs(1));
}

TEST_F(Import, MergedMeshKeepsTheFrontOfMirroredParts) {
  std::string json = gltfJson();
  json.replace(json.find("\"scale\":[2,2,2]"), 15, "\"scale\":[-2,2,2]");
  const Expected<Mesh> mesh = importMesh(folder_.write("room.glb", glb(json, gltfBuffer())), {});
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  EXPECT_THAT(mesh->triangles, SizeIs(8));
  const ImportedScene scene = load(folder_.path("room.glb"));
  EXPECT_TRUE(named(scene.lights, "Lamp").transform.mirrors());
  // The first mesh is the lamp's: its outer side, +z in object space, points to where the matrix sends it.
  const glm::uvec3 t = mesh->triangles[0];
  const glm::dvec3 normal = glm::cross(glm::dvec3(mesh->positions[t.y] - mesh->positions[t.x]),
                                       glm::dvec3(mesh->positions[t.z] - mesh->positions[t.x]));
  EXPECT_GT(normal.x, 0.0);  // turned by 90 degrees about y
}

TEST_F(Import, UnreadableTexturesAreLeftOutWithAWarning) {
  std::string buffer = gltfBuffer();
  buffer[150] = 'x';
  const ImportedScene scene = load(folder_.write("room.glb", glb(gltfJson(), buffer)));
  EXPECT_EQ(named(scene.lights, "Screen").texture, nullptr);
  EXPECT_THAT(scene.warnings, SizeIs(1));
}

TEST_F(Import, RefusesWhatIsNoSceneFile) {
  const auto message = [&](const std::string& path) {
    const Status status = importScene(path, {}).status();
    EXPECT_EQ(status.code(), Code::kInvalidArgument) << path;
    return status.message();
  };
  EXPECT_THAT(message(folder_.path("none.glb")), HasSubstr("No such file"));
  EXPECT_THAT(message(folder_.write("a.fbx", "x")), HasSubstr("glb, gltf, obj, ply and stl"));
  EXPECT_THAT(message(folder_.write("a.obj", "")), HasSubstr("empty"));
  EXPECT_THAT(message(folder_.write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")), HasSubstr("b.obj"));
  EXPECT_THAT(message(folder_.write("c.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n")), HasSubstr("c.obj"));
  EXPECT_THAT(message(folder_.write("d.ply", asciiPly().replace(asciiPly().find("3 0 1 2"), 7, "3 0 1 9"))),
              HasSubstr("d.ply"));
  EXPECT_THAT(message(folder_.write("e.ply", asciiPly().replace(asciiPly().find("1 0 0"), 5, "1 nan 0"))),
              HasSubstr("e.ply"));
}

/// Assimp and libpng leak what they had made of a file when they meet its fault.
struct ForeignLeaks {
  ForeignLeaks() {}  // NOLINT(modernize-use-equals-default): so that an empty one is not unused
#if defined(LPV_ADDRESS_SANITIZER)
  __lsan::ScopedDisabler disabled;
#endif
};

/// Every format cut at every length, and with bytes changed at random: an answer, never a crash; an error where the
/// format lets one tell.
class BadFiles : public testing::TestWithParam<std::tuple<std::string, std::string, bool>> {
  ForeignLeaks leaks_;
};

TEST_P(BadFiles, CutAtEveryLength) {
  const auto& [name, bytes, tells] = GetParam();
  const TemporaryFolder folder;
  folder.write("room.mtl", mtlText());
  for (std::size_t size = 0; size < bytes.size(); size += std::max<std::size_t>(1, bytes.size() / 150)) {
    const Expected<ImportedScene> scene = importScene(folder.write(name, bytes.substr(0, size)), {});
    EXPECT_FALSE(tells && scene.ok() && size + 1 < bytes.size()) << name << " cut to " << size;
    EXPECT_THAT(scene.status().message(), testing::Not(HasSubstr("\n"))) << size;
  }
}

TEST_P(BadFiles, BytesChanged) {
  const auto& [name, bytes, tells] = GetParam();
  const TemporaryFolder folder;
  folder.write("room.mtl", mtlText());
  std::mt19937 generator(11);
  for (int round = 0; round < 150; ++round) {
    std::string changed = bytes;
    for (int i = 0; i < 1 + round % 4; ++i) changed[generator() % changed.size()] = char(generator());
    (void)importScene(folder.write(name, changed), {});
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, BadFiles,
                         testing::Values(std::tuple("a.glb", glb(gltfJson(), gltfBuffer()), true),
                                         std::tuple("b.gltf", gltfJson(), true), std::tuple("c.obj", objText(), false),
                                         std::tuple("d.ply", asciiPly(), true), std::tuple("e.ply", binaryPly(), true),
                                         std::tuple("f.stl", binaryStl(), true),
                                         std::tuple("g.stl", asciiStl(), false)),
                         [](const auto& test) {
                           std::string name = std::get<0>(test.param);
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

TEST(Images, FloatingPointBecomesLinearHalves) {
  const TemporaryFolder folder;
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
  const std::string texels{'\x80', '\x40', '\0', '\x84', '\0', '\0', '\0', '\0'};  // (8, 4, 0) and black
  const Expected<Texture> texture = readImage(folder.write("a.hdr", header + texels));
  ASSERT_TRUE(texture.ok()) << texture.status().message();
  EXPECT_EQ(texture->format, TexelFormat::kRgb16F);
  EXPECT_EQ(texture->texels.size(), 2U * 6U);
  EXPECT_TRUE(near(meanColour(*texture), {4, 2, 0}, 0.05));
}

TEST(Images, RefusesWhatIsNoImage) {
  const ForeignLeaks leaks;
  const TemporaryFolder folder;
  EXPECT_EQ(readImage(folder.path("none.png")).status().code(), Code::kInvalidArgument);
  EXPECT_EQ(readImage(folder.write("a.png", "no picture")).status().code(), Code::kInvalidArgument);
  const std::string png = redGreenPng();
  for (std::size_t size = 0; size < 58; size += 3) {
    EXPECT_FALSE(readImage(folder.write("b.png", png.substr(0, size))).ok()) << size;
  }
}

TEST(Names, AreWhatTheServerTakes) {
  EXPECT_EQ(objectName("Lamp", "mesh", "file"), "Lamp");
  EXPECT_EQ(objectName("", "mesh", "file"), "mesh");
  EXPECT_EQ(objectName("<STL_BINARY>", "", "file"), "file");
  EXPECT_EQ(objectName("a/b\n", "", ""), "a_b_");
  EXPECT_EQ(objectName("caf\xc3\xa9\xff", "", ""), "caf\xc3\xa9_");
  EXPECT_EQ(objectName(std::string(199, 'a') + "\xc3\xa9", "", "").size(), 199U);
  EXPECT_EQ(objectName("", "", ""), "object");
}

TEST(Values, AreReadWholeOrNotAtAll) {
  EXPECT_EQ(parseNumbers("1,-2.5,3e2", {3}), (std::vector<double>{1, -2.5, 300}));
  for (const char* bad : {"", "1,2", "1,2,3,4", "1,2,x", "1,,3", "1,2,3 ", "nan,1,1", "1,2,inf"}) {
    EXPECT_EQ(parseNumbers(bad, {3}), std::nullopt) << bad;
  }
  EXPECT_EQ(parseSize("640x360"), glm::ivec2(640, 360));
  for (const char* bad : {"", "640", "640x", "x360", "640x360x2", "640 x 360"}) EXPECT_EQ(parseSize(bad), std::nullopt);
  EXPECT_EQ(parseDuration("90"), 90.0);
  EXPECT_EQ(parseDuration("1.5h"), 5400.0);
  for (const char* bad : {"", "h", "-1s", "1w"}) EXPECT_EQ(parseDuration(bad), std::nullopt) << bad;
}

TEST(Npy, HeaderIsPaddedAndNamesTheShape) {
  const std::string file = npyFile({2, 3}, std::vector<float>(6, 1.0F));
  EXPECT_EQ(file.substr(0, 8), std::string("\x93NUMPY\x01\0", 8));
  EXPECT_EQ((file.size() - 24) % 64, 0U);
  EXPECT_THAT(file, HasSubstr("'descr': '<f4', 'fortran_order': False, 'shape': (2,3)"));
}

}  // namespace
}  // namespace lpv::cli
