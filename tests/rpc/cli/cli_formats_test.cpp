// What formats allow beyond the ordinary, and what they forbid: each file is read with the triangles and the area that
// it describes, or refused in a line that names the place, the value and the way out. Most cases were seen to fail with
// Assimp 5.2 alone.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "import/gltf_draco.h"
#include "import/gltf_meshopt.h"
#include "import/scene_file.h"
#include "rpc/cli/cli_files.h"

namespace lpv::cli {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::SizeIs;

std::size_t trianglesOf(const ImportedScene& scene) {
  std::size_t triangles = 0;
  for (const Light& light : scene.lights) triangles += light.mesh->triangles.size();
  for (const Surface& surface : scene.surfaces) triangles += surface.mesh->triangles.size();
  return triangles;
}

double areaOf(const ImportedScene& scene) {
  double area = 0.0;
  for (const Light& light : scene.lights) area += worldArea(*light.mesh, light.transform);
  for (const Surface& surface : scene.surfaces) area += worldArea(*surface.mesh, surface.transform);
  return area;
}

class Formats : public testing::Test {
 protected:
  void expectRead(const std::string& name, const std::string& bytes, std::size_t triangles, double area,
                  double tolerance = 1e-6) {
    const Expected<ImportedScene> scene = importScene(folder_.write(name, bytes), {});
    ASSERT_TRUE(scene.ok()) << name << ": " << scene.status().message();
    EXPECT_EQ(trianglesOf(*scene), triangles) << name;
    EXPECT_NEAR(areaOf(*scene), area, tolerance) << name;
  }

  /// The refusal's sentence, which begins with the file's path and is one line.
  std::string refusal(const std::string& name, const std::string& bytes) {
    const std::string path = folder_.write(name, bytes);
    const Status status = importScene(path, {}).status();
    EXPECT_EQ(status.code(), Code::kInvalidArgument) << name;
    EXPECT_THAT(status.message(), AllOf(testing::StartsWith(path + ": "), testing::Not(HasSubstr("\n"))));
    return status.message().substr(std::min(status.message().size(), path.size()));
  }

  TemporaryFolder folder_;
};

const std::string kBom = "\xef\xbb\xbf";
const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

// ---------------------------------------------------------------------------------------------------------------- OBJ

TEST_F(Formats, ObjNumbersWithoutALeadingZero) {
  expectRead("a.obj", "v 0 0 0\nv .5 0 0\nv .5 +.5 0\nv -.5 .5 0\nf 1 2 3\nf 1 3 4\n", 2, 0.375);
}

TEST_F(Formats, ObjWithAByteOrderMark) { expectRead("a.obj", kBom + kSquare + "f 1 2 3 4\n", 2, 1.0); }

TEST_F(Formats, ObjWithIndentedLines) {
  expectRead("a.obj", "  v 0 0 0\n\tv 1 0 0\n \t v 1 1 0\n  v 0 1 0\n  f 1 2 3\n\tf 1 3 4\n", 2, 1.0);
}

TEST_F(Formats, ObjWithCommentsAfterFaces) {
  expectRead("a.obj", kSquare + "f 1 2 3 # 4\nf 1 3 4# two\n", 2, 1.0);
  expectRead("b.obj", "v 0 0 0 # the origin\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", 1, 0.5);  // Assimp reads this one
}

TEST_F(Formats, ObjLinesThatContinueAndEndAnyhow) {  // Assimp reads these: they have to stay right
  expectRead("a.obj", kSquare + "f 1 2 \\\n3 4\n", 2, 1.0);
  std::string text = kSquare + "f 1 2 3 4\n";
  std::replace(text.begin(), text.end(), '\n', '\r');
  expectRead("b.obj", text, 2, 1.0);
  expectRead("c.obj", kSquare + "f 1 2 3 4", 2, 1.0);
}

TEST_F(Formats, MtlWithAByteOrderMarkAndIndentedLines) {
  folder_.write("a.mtl", kBom + "  newmtl lamp\n\tKe .5 .25 1\n  Kd 0 0 0\n");
  const Expected<ImportedScene> scene =
      importScene(folder_.write("a.obj", "mtllib a.mtl\n" + kSquare + "usemtl lamp\nf 1 2 3 4\n"), {});
  ASSERT_TRUE(scene.ok()) << scene.status().message();
  ASSERT_THAT(scene->lights, SizeIs(1));
  EXPECT_EQ(scene->lights[0].radiance, glm::dvec3(0.5, 0.25, 1.0));
}

TEST_F(Formats, ObjIndicesOutOfRange) {
  EXPECT_THAT(refusal("a.obj", kSquare + "f 1 2 9\n"),
              AllOf(HasSubstr("line 5"), HasSubstr("vertex 9"), HasSubstr("4 vertices")));
  EXPECT_THAT(refusal("b.obj", kSquare + "f 0 1 2\n"), AllOf(HasSubstr("line 5"), HasSubstr("vertex 0")));
  EXPECT_THAT(refusal("c.obj", kSquare + "f -9 -1 -2\n"), AllOf(HasSubstr("line 5"), HasSubstr("vertex -9")));
  EXPECT_THAT(refusal("d.obj", kSquare + "vt 0 0\nf 1/1 2/7 3/1\n"),
              AllOf(HasSubstr("line 6"), HasSubstr("texture coordinate 7")));
  EXPECT_THAT(refusal("e.obj", kSquare + "vn 0 0 1\nf 1//1 2//1 3//2\n"),
              AllOf(HasSubstr("line 6"), HasSubstr("normal 2")));
  EXPECT_THAT(refusal("f.obj", kSquare + "f 1 2 x\n"), AllOf(HasSubstr("line 5"), HasSubstr("'x'")));
  EXPECT_THAT(refusal("h.obj", kSquare + "f 1 2 5\n"), HasSubstr("vertex 5")) << "the first one that is not there";
  expectRead("g.obj", "f 1 2 3\n" + kSquare, 1, 0.5);  // OBJ lets faces come before their vertices
}

/// Assimp reads the last ones, with a decimal comma: they have to stay right.
TEST_F(Formats, VerticesThatAreNoNumbers) {
  EXPECT_THAT(refusal("a.obj", "v 0 0 0\nv 1 0\nv 1 1 0\nf 1 2 3\n"), AllOf(HasSubstr("line 2"), HasSubstr("'v 1 0'")));
  EXPECT_THAT(refusal("b.obj", "v 0 0 0\nv 1 0 0\nv 1 x 0\nf 1 2 3\n"), HasSubstr("line 3"));
  EXPECT_THAT(refusal("c.ply", asciiPly().replace(asciiPly().find("1 1 0"), 5, "1 x 0")), HasSubstr("'vertex' 2"));
  EXPECT_THAT(refusal("d.stl", asciiStl().replace(asciiStl().find("1 1 0"), 5, "1 x 0")), HasSubstr("line 6"));
  EXPECT_THAT(refusal("e.obj", "v nan 0 0\n" + kSquare + "f 1 2 3 4 5\n"),
              AllOf(HasSubstr("object 'e'"), HasSubstr("not finite")));
  expectRead("f.obj", "v 0 0 0\nv 1 0 0\nv 1,5 1,5 0\nf 1 2 3\n", 1, 0.75);
  expectRead("g.stl", asciiStl().replace(asciiStl().find("1 1 0"), 5, "1 1,5 0"), 1, 0.75);
}

TEST_F(Formats, ObjWithoutFacesAndInUtf16) {
  EXPECT_THAT(refusal("a.obj", kSquare), HasSubstr("no face"));
  EXPECT_THAT(refusal("b.obj", kSquare + "l 1 2\np 3\n"), HasSubstr("no face"));
  EXPECT_THAT(refusal("c.obj", std::string("\xff\xfev\0 \0", 6)), HasSubstr("UTF-16"));
}

// ---------------------------------------------------------------------------------------------------------------- PLY

const std::string kPlyVertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kPlyFaces = "element face 2\nproperty list uchar int vertex_indices\n";
const std::string kPlyText = "ply\nformat ascii 1.0\n";

std::string swapped(std::string bytes) {
  for (std::size_t at = 0; at + 4 <= bytes.size(); at += 4) std::reverse(bytes.begin() + at, bytes.begin() + at + 4);
  return bytes;
}

TEST_F(Formats, PlyWithFacesFirst) {
  const std::string numbers = bytesOf<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  const std::string first = bytesOf<std::int32_t>({0, 1, 2});
  const std::string second = bytesOf<std::int32_t>({0, 2, 3});
  expectRead("a.ply",
             kPlyText + kPlyFaces + kPlyVertices + "end_header\n3 0 1 2\n3 0 2 3\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n", 2,
             1.0);
  expectRead("b.ply",
             "ply\nformat binary_little_endian 1.0\n" + kPlyFaces + kPlyVertices + "end_header\n" + '\3' + first +
                 '\3' + second + numbers,
             2, 1.0);
  expectRead("c.ply",
             "ply\nformat binary_big_endian 1.0\n" + kPlyFaces + kPlyVertices + "end_header\n" + '\3' + swapped(first) +
                 '\3' + swapped(second) + swapped(numbers),
             2, 1.0);
}

TEST_F(Formats, PlyWithTriangleStrips) {
  const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  expectRead("a.ply", kPlyText + kPlyVertices + strips + "0 0 0\n1 0 0\n0 1 0\n1 1 0\n4 0 1 2 3\n", 2, 1.0);
  // -1 begins another strip, whose first triangle is turned as written.
  const std::string path =
      folder_.write("b.ply", kPlyText + kPlyVertices + strips + "0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 3\n");
  const Expected<Mesh> mesh = importMesh(path, {});
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  EXPECT_THAT(mesh->triangles, SizeIs(3));
  for (const glm::uvec3& t : mesh->triangles) {
    const glm::vec3 a = mesh->positions[t.x];
    EXPECT_GT(glm::cross(mesh->positions[t.y] - a, mesh->positions[t.z] - a).z, 0.0F);
  }
  const std::string binary = "ply\nformat binary_little_endian 1.0\n" + strips.substr(0, strips.size() - 11) +
                             kPlyVertices + "end_header\n" + bytesOf<std::int32_t>({4, 0, 1, 2, 3}) +
                             bytesOf<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
  expectRead("c.ply", binary, 2, 1.0);
}

TEST_F(Formats, PlyWithAByteOrderMark) { expectRead("a.ply", kBom + asciiPly(), 2, 1.0); }

TEST_F(Formats, PlyIndicesOutOfRange) {
  const std::string head = kPlyText + kPlyVertices + kPlyFaces + "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  EXPECT_THAT(refusal("a.ply", head + "3 0 1 2\n3 0 1 9\n"),
              AllOf(HasSubstr("face 1"), HasSubstr("vertex 9"), HasSubstr("4 vertices")));
  EXPECT_THAT(refusal("b.ply", head + "3 0 1 -1\n3 0 1 2\n"), AllOf(HasSubstr("face 0"), HasSubstr("vertex -1")));
  EXPECT_THAT(refusal("d.ply", head + "3 0 1 2\n3 0 1 4\n"), HasSubstr("vertex 4"))
      << "the first one that is not there";
  std::string binary = binaryPly();
  binary[binary.size() - 4] = 77;
  EXPECT_THAT(refusal("c.ply", binary), AllOf(HasSubstr("face 1"), HasSubstr("vertex 77")));
}

TEST_F(Formats, PlyWithoutFaces) {
  EXPECT_THAT(refusal("a.ply", kPlyText + kPlyVertices + "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"),
              HasSubstr("no face, only"));
}

// ---------------------------------------------------------------------------------------------------------------- STL

TEST_F(Formats, StlInUpperCase) {
  std::string text = asciiStl();
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  expectRead("a.stl", text, 1, 0.5);
  expectRead("B.STL", text, 1, 0.5);
  std::string mixed = asciiStl();
  mixed.replace(mixed.find("facet"), 5, "Facet").replace(mixed.find("vertex"), 6, "Vertex");
  expectRead("c.stl", mixed, 1, 0.5);
}

TEST_F(Formats, StlWithAByteOrderMarkAndAnEmptySolid) {
  expectRead("a.stl", kBom + asciiStl(), 1, 0.5);  // Assimp reads this one
  expectRead("b.stl", "solid none\nendsolid none\n" + asciiStl(), 1, 0.5);
}

TEST_F(Formats, StlWithoutOrWithHalfAFacet) {
  EXPECT_THAT(refusal("a.stl", "solid none\nendsolid none\n"), HasSubstr("no facet"));
  std::string text = asciiStl();
  EXPECT_THAT(refusal("b.stl", text.replace(text.find("vertex 1 1 0"), 12, "vertex 1 1")),
              AllOf(HasSubstr("line 6"), HasSubstr("vertex")));
}

// --------------------------------------------------------------------------------------------------------------- glTF

/// The square of two triangles with its data beside the JSON; `change` edits the JSON before it is written.
struct Gltf {
  json file = json::parse(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0,"name":"square"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
                 {"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],
    "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
    "buffers":[{"byteLength":60}]})");
  std::string data = bytesOf<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) + bytesOf<std::uint16_t>({0, 1, 2, 0, 2, 3});

  std::string binary() const { return glb(file.dump(), data); }

  /// Positions of another component type, four components apart so that vertices are aligned.
  template <typename T>
  void quantise(int componentType, T one, bool normalised) {
    const T zero = 0;
    data = bytesOf<T>({zero, zero, zero, zero, one, zero, zero, zero, one, one, zero, zero, zero, one, zero, zero});
    describeQuantised(componentType, normalised, data.size(), 4 * sizeof(T));
    data += bytesOf<std::uint16_t>({0, 1, 2, 0, 2, 3});
    file["buffers"][0]["byteLength"] = data.size();
  }

 private:
  /// Not in the template: what clang 16 makes of these lists there is never freed.
  void describeQuantised(int componentType, bool normalised, std::size_t positions, std::size_t stride) {
    file["accessors"][0]["componentType"] = componentType;
    file["accessors"][0]["normalized"] = normalised;
    file["accessors"][0].erase("min");
    file["accessors"][0].erase("max");
    file["bufferViews"] = {{{"buffer", 0}, {"byteLength", positions}, {"byteStride", stride}},
                           {{"buffer", 0}, {"byteOffset", positions}, {"byteLength", 12}}};
    file["extensionsUsed"] = file["extensionsRequired"] = {"KHR_mesh_quantization"};
  }
};

TEST_F(Formats, QuantisedPositions) {
  const auto expect = [&](int type, auto one, bool normalised, double area) {
    Gltf gltf;
    gltf.quantise(type, one, normalised);
    expectRead("a.glb", gltf.binary(), 2, area, 1e-6 * area);
  };
  expect(5120, std::int8_t(127), true, 1.0);
  expect(5120, std::int8_t(100), false, 1e4);
  expect(5120, std::int8_t(-128), true, 1.0);  // clamped to -1
  expect(5121, std::uint8_t(255), true, 1.0);
  expect(5121, std::uint8_t(200), false, 4e4);
  expect(5122, std::int16_t(32767), true, 1.0);
  expect(5122, std::int16_t(-300), false, 9e4);
  expect(5123, std::uint16_t(65535), true, 1.0);
  expect(5123, std::uint16_t(65535), false, 65535.0 * 65535.0);
}

TEST_F(Formats, QuantisedNormalsAndTextureCoordinates) {
  Gltf gltf;
  const std::size_t normals = gltf.data.size();
  for (int i = 0; i < 4; ++i) gltf.data += bytesOf<std::int8_t>({0, 0, 127, 0});
  gltf.data += bytesOf<std::uint16_t>({0, 65535, 65535, 65535, 65535, 0, 0, 0});
  gltf.file["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", normals}, {"byteLength", 16}, {"byteStride", 4}});
  gltf.file["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", normals + 16}, {"byteLength", 16}});
  gltf.file["accessors"].push_back(
      {{"bufferView", 2}, {"componentType", 5120}, {"normalized", true}, {"count", 4}, {"type", "VEC3"}});
  gltf.file["accessors"].push_back(
      {{"bufferView", 3}, {"componentType", 5123}, {"normalized", true}, {"count", 4}, {"type", "VEC2"}});
  gltf.file["meshes"][0]["primitives"][0]["attributes"] = {{"POSITION", 0}, {"NORMAL", 2}, {"TEXCOORD_0", 3}};
  gltf.file["buffers"][0]["byteLength"] = gltf.data.size();
  const Expected<ImportedScene> scene = importScene(folder_.write("a.glb", gltf.binary()), {});
  ASSERT_TRUE(scene.ok()) << scene.status().message();
  ASSERT_THAT(scene->surfaces, SizeIs(1));
  const Mesh& mesh = *scene->surfaces[0].mesh;
  ASSERT_THAT(mesh.normals, SizeIs(4));
  ASSERT_THAT(mesh.uvs, SizeIs(4));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(mesh.normals[i].z, 1.0F, 1e-6F);
    EXPECT_EQ(mesh.uvs[i], glm::vec2(mesh.positions[i].x, 1.0F - mesh.positions[i].y));
  }
}

TEST_F(Formats, GltfWithoutScenes) {
  Gltf gltf;
  gltf.file.erase("scene");
  gltf.file.erase("scenes");
  gltf.file["nodes"] = json::parse(R"([{"mesh":0},{"children":[0,2],"scale":[2,2,2]},{"mesh":0}])");
  expectRead("a.glb", gltf.binary(), 4, 8.0);  // the roots are the nodes that are nobody's children
}

TEST_F(Formats, GltfWithPercentEncodedAddresses) {
  Gltf gltf;
  folder_.write("my file+%.bin", gltf.data);
  gltf.file["buffers"][0]["uri"] = "my%20file+%25.bin";
  expectRead("a.gltf", gltf.file.dump(), 2, 1.0);
  expectRead("b.gltf", kBom + gltf.file.dump(), 2, 1.0);
}

TEST_F(Formats, GltfExtensionsThatAreNotKnown) {
  Gltf gltf;
  gltf.file["extensionsUsed"] = gltf.file["extensionsRequired"] = {"KHR_materials_unlit", "EXT_mesh_of_tomorrow"};
  EXPECT_THAT(refusal("a.glb", gltf.binary()),
              AllOf(HasSubstr("extensionsRequired"), HasSubstr("EXT_mesh_of_tomorrow")));
  gltf.file.erase("extensionsRequired");
  expectRead("b.glb", gltf.binary(), 2, 1.0);  // Assimp reads this one
}

TEST_F(Formats, GltfIndicesOutOfRange) {
  const auto message = [&](const std::function<void(Gltf&)>& change) {
    Gltf gltf;
    change(gltf);
    return refusal("a.glb", gltf.binary());
  };
  EXPECT_THAT(message([](Gltf& g) { g.data[52] = 9; }),
              AllOf(HasSubstr("meshes[0].primitives[0].indices"), HasSubstr("index 2 is 9"), HasSubstr("4 vertices")));
  EXPECT_THAT(message([](Gltf& g) { g.data[52] = 4; }), HasSubstr("index 2 is 4")) << "the first one that is not there";
  EXPECT_THAT(message([](Gltf& g) { g.file["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 7; }),
              AllOf(HasSubstr("meshes[0].primitives[0].attributes.POSITION is 7"), HasSubstr("2 accessors")));
  EXPECT_THAT(message([](Gltf& g) { g.file["accessors"][0]["bufferView"] = 9; }),
              AllOf(HasSubstr("accessors[0].bufferView is 9"), HasSubstr("2 bufferViews")));
  EXPECT_THAT(message([](Gltf& g) { g.file["accessors"][0]["count"] = 400; }),
              AllOf(HasSubstr("accessors[0]"), HasSubstr("4800"), HasSubstr("48 bytes")));
  EXPECT_THAT(message([](Gltf& g) { g.file["bufferViews"][1]["byteOffset"] = 50; }),
              AllOf(HasSubstr("bufferViews[1]"), HasSubstr("62"), HasSubstr("60 bytes")));
  EXPECT_THAT(message([](Gltf& g) { g.file["bufferViews"][1]["buffer"] = 3; }),
              HasSubstr("bufferViews[1].buffer is 3"));
  EXPECT_THAT(message([](Gltf& g) { g.file["nodes"][0]["mesh"] = 5; }), HasSubstr("nodes[0].mesh is 5"));
  EXPECT_THAT(message([](Gltf& g) { g.file["scenes"][0]["nodes"][0] = 5; }), HasSubstr("scenes[0].nodes[0] is 5"));
  EXPECT_THAT(message([](Gltf& g) { g.file["scene"] = 5; }), HasSubstr("scene is 5"));
  EXPECT_THAT(message([](Gltf& g) { g.file["nodes"][0]["children"] = {0}; }), HasSubstr("nodes[0]"));
  EXPECT_THAT(message([](Gltf& g) { g.file["meshes"][0]["primitives"][0]["material"] = 1; }),
              HasSubstr("meshes[0].primitives[0].material is 1"));
}

TEST_F(Formats, GltfOfTheWrongShape) {
  const auto message = [&](const std::function<void(json&)>& change) {
    Gltf gltf;
    change(gltf.file);
    return refusal("a.glb", gltf.binary());
  };
  EXPECT_THAT(message([](json& g) { g["meshes"] = 3; }), AllOf(HasSubstr("meshes"), HasSubstr("array")));
  EXPECT_THAT(message([](json& g) { g["meshes"][0]["primitives"] = "x"; }), HasSubstr("meshes[0].primitives"));
  EXPECT_THAT(message([](json& g) { g["accessors"][0]["componentType"] = 5125.5; }),
              HasSubstr("accessors[0].componentType"));
  EXPECT_THAT(message([](json& g) { g["accessors"][0]["type"] = "VEC9"; }),
              AllOf(HasSubstr("accessors[0].type"), HasSubstr("VEC9")));
  EXPECT_THAT(message([](json& g) { g["scene"] = "first"; }), HasSubstr("scene"));
  EXPECT_THAT(message([](json& g) { g["asset"]["version"] = "3.0"; }), HasSubstr("3.0"));
  EXPECT_THAT(refusal("b.gltf", "{\"asset\":\n{\"version\" 2}}"), HasSubstr("line 2"));
  EXPECT_THAT(refusal("c.gltf", std::string(100000, '[')), HasSubstr("nested"));
  Gltf gltf;
  gltf.file["buffers"][0]["uri"] = "none.bin";
  EXPECT_THAT(refusal("d.gltf", gltf.file.dump()), AllOf(HasSubstr("buffers[0].uri"), HasSubstr("none.bin")));
  gltf.file["buffers"][0]["uri"] = "https://example.org/a.bin";
  EXPECT_THAT(refusal("e.gltf", gltf.file.dump()), AllOf(HasSubstr("buffers[0].uri"), HasSubstr("https")));
}

// Files of glTF 1.0 are Assimp's to read. Broken by: its message, which begins with GLTF: and names no way out.
TEST_F(Formats, NoMessageSpeaksInTheImportersPhrases) {
  for (const char* rest : {"}", ",\"scene\":\"x\"}", ",\"meshes\":{\"m\":{\"primitives\":[{\"mode\":77}]}}}"}) {
    EXPECT_EQ(
        refusal("a.gltf", std::string(R"({"asset":{"version":"1.0"})") + rest),
        ": the file cannot be read as gltf, or has no triangle; open it in the program that made it and export it "
        "again");
  }
}

TEST_F(Formats, GltfSparseAccessors) {  // Assimp reads the first of these, the others are refused in its own words
  Gltf gltf;
  gltf.data += bytesOf<float>({2, 0, 0});
  gltf.file["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 60}, {"byteLength", 12}});
  gltf.file["buffers"][0]["byteLength"] = 72;
  gltf.file["accessors"][0]["sparse"] = json::parse(
      R"({"count":1,"indices":{"bufferView":1,"byteOffset":2,"componentType":5123},"values":{"bufferView":2}})");
  expectRead("a.glb", gltf.binary(), 2, 1.5);
  gltf.data[50] = 8;
  gltf.file["accessors"][0]["count"] = 4;
  EXPECT_THAT(refusal("b.glb", gltf.binary()), AllOf(HasSubstr("accessors[0].sparse.indices"), HasSubstr("8")));
}

std::string fromHex(const std::string& hex) {
  std::string out;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) out += char(std::stoi(hex.substr(i, 2), nullptr, 16));
  return out;
}

/// The square as gltf-transform 4.5.1 compresses it ("gltf-transform draco").
Gltf dracoSquare() {
  Gltf gltf;
  gltf.file = json::parse(R"({"asset":{"version":"2.0"},"accessors":[{"type":"SCALAR","componentType":5123,"count":6},
    {"type":"VEC3","componentType":5126,"count":4,"max":[1,1,0],"min":[0,0,0]}],
    "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":75}],"buffers":[{"byteLength":75}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":1},"mode":4,"indices":0,"extensions":
      {"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}}}]}],
    "nodes":[{"name":"n","mesh":0}],"scenes":[{"nodes":[0]}],"scene":0,
    "extensionsUsed":["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_draco_mesh_compression"]})");
  gltf.data = fromHex(
      "445241434f02020101000000040200020000011fff011101ff0000010009030000020101010003030130011003002882980000000000ff3f"
      "00000000000000000000000000000000803f0e00");
  return gltf;
}

/// The same by "gltf-transform meshopt", which quantises too.
Gltf meshoptSquare() {
  Gltf gltf;
  gltf.file = json::parse(R"({"asset":{"version":"2.0"},
    "accessors":[{"type":"SCALAR","componentType":5123,"count":6,"normalized":false,"byteOffset":0,"bufferView":0},
    {"type":"VEC3","componentType":5122,"count":4,"normalized":true,"byteOffset":0,"bufferView":1}],
    "bufferViews":[{"buffer":1,"byteOffset":0,"byteLength":12,"extensions":{"EXT_meshopt_compression":
      {"buffer":0,"byteOffset":0,"byteLength":19,"mode":"TRIANGLES","byteStride":2,"count":6}}},
    {"buffer":1,"byteOffset":12,"byteLength":32,"byteStride":8,"extensions":{"EXT_meshopt_compression":
      {"buffer":0,"byteOffset":20,"byteLength":60,"mode":"ATTRIBUTES","byteStride":8,"count":4}}}],
    "buffers":[{"byteLength":80},{"byteLength":44,"extensions":{"EXT_meshopt_compression":{"fallback":true}}}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":1},"mode":4,"indices":0}]}],
    "nodes":[{"name":"n","translation":[0.5,0.5,0],"scale":[0.5,0.5,0.5],"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0,
    "extensionsUsed":["EXT_meshopt_compression","KHR_mesh_quantization"],
    "extensionsRequired":["EXT_meshopt_compression","KHR_mesh_quantization"]})");
  gltf.data = fromHex(
      "e1f000007687566778a986658968980169000000a0013300000003040112000000010c000000030104000000000000000000000000000000"
      "000000000000000000000000000000000180018000000000");
  return gltf;
}

/// Reads the file where its library was there when lpvctl was built; else it is refused by the extension's name.
TEST_F(Formats, DracoAndMeshoptAreReadOrRefusedByName) {
  if (dracoIsBuiltIn()) {
    expectRead("a.glb", dracoSquare().binary(), 2, 1.0, 1e-3);
  } else {
    EXPECT_THAT(refusal("a.glb", dracoSquare().binary()), HasSubstr("KHR_draco_mesh_compression"));
  }
  if (meshoptIsBuiltIn()) {
    expectRead("b.glb", meshoptSquare().binary(), 2, 1.0, 1e-6);
  } else {
    EXPECT_THAT(refusal("b.glb", meshoptSquare().binary()), HasSubstr("EXT_meshopt_compression"));
  }
}

TEST_F(Formats, DamagedDracoAndMeshopt) {
  if (!dracoIsBuiltIn() || !meshoptIsBuiltIn()) GTEST_SKIP() << "built without libdraco or libmeshoptimizer";
  Gltf draco = dracoSquare();
  draco.data.resize(40);
  draco.data.resize(75);
  EXPECT_THAT(refusal("a.glb", draco.binary()),
              AllOf(HasSubstr("meshes[0].primitives[0].extensions.KHR_draco_mesh_compression"), HasSubstr("damaged")));
  draco = dracoSquare();
  draco.file["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = 7;
  EXPECT_THAT(refusal("b.glb", draco.binary()), HasSubstr("attribute 7"));
  Gltf meshopt = meshoptSquare();
  meshopt.data[20] = 'x';
  EXPECT_THAT(refusal("c.glb", meshopt.binary()),
              AllOf(HasSubstr("bufferViews[1].extensions.EXT_meshopt_compression"), HasSubstr("damaged")));
  meshopt = meshoptSquare();
  meshopt.file["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = 1e12;
  EXPECT_THAT(refusal("d.glb", meshopt.binary()), HasSubstr("1000000000000 elements of 2 bytes"));
}

/// Every byte of the compressed files changed at random: an answer, never a crash.
TEST_F(Formats, CompressedBytesChanged) {
  std::mt19937 generator(17);
  for (int round = 0; round < 400; ++round) {
    Gltf gltf = round % 2 == 0 ? dracoSquare() : meshoptSquare();
    for (int i = 0; i < 1 + round % 3; ++i) gltf.data[generator() % gltf.data.size()] = char(generator());
    (void)importScene(folder_.write("a.glb", gltf.binary()), {});
  }
}

}  // namespace
}  // namespace lpv::cli
