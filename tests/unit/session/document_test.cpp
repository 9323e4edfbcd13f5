// Edits as a document takes them: whole or not at all, field by field, one revision each.
#include "session/document/document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "reference/meshes.h"
#include "unit/session/session_rig.h"

namespace lpv {
namespace {

using test::createLight;
using test::createSurface;
using test::editOf;
using test::moveLight;
using test::setRadiance;
using testing::ElementsAre;
using testing::HasSubstr;

LightingSettings fixedGrid() {
  LightingSettings options;
  options.grid.longest = 8;
  options.grid.hasBounds = true;
  options.grid.bounds = {glm::dvec3(-1.0), glm::dvec3(1.0)};
  return options;
}

class DocumentTest : public testing::Test {
 protected:
  Expected<std::vector<std::string>> apply(std::vector<Operation> operations) {
    return document_.apply(editOf(std::move(operations)), blobs_);
  }
  std::vector<std::string> applied(std::vector<Operation> operations) {
    const auto names = apply(std::move(operations));
    EXPECT_TRUE(names.ok()) << names.status().message();
    return names ? *names : std::vector<std::string>();
  }
  std::shared_ptr<const Light> light(const std::string& name) {
    const ScenePtr scene = document_.snapshot();
    return scene->lights.contains(name) ? scene->lights.at(name) : nullptr;
  }

  Limits limits_;
  Blobs blobs_{limits_};
  Document document_{fixedGrid(), limits_, test::nameOfContent};
};

TEST_F(DocumentTest, AnEditIsOneRevisionWithANameForEachOperation) {
  EXPECT_EQ(document_.revision(), 0U);
  EXPECT_THAT(applied({createLight("Lamp"), createSurface("Wall"), PutCamera{"Front", Camera()}, moveLight("Lamp", {}),
                       DeleteSurface{"Wall"}}),
              ElementsAre("Lamp", "Wall", "Front", "Lamp", "Wall"));
  EXPECT_EQ(document_.revision(), 1U);
  EXPECT_EQ(document_.lightCount(), 1U);
  EXPECT_EQ(document_.surfaceCount(), 0U);
  EXPECT_EQ(document_.triangleCount(), 2);
  EXPECT_EQ(document_.snapshot()->revision, 1U);
}

TEST_F(DocumentTest, ATakenNameGetsANumberAmongLightsAndSurfacesTogether) {
  EXPECT_THAT(applied({createLight("Lamp"), createSurface("Lamp"), createLight("Lamp")}),
              ElementsAre("Lamp", "Lamp.001", "Lamp.002"));
  applied({DeleteSurface{"Lamp.001"}});
  EXPECT_THAT(applied({createLight("Lamp")}), ElementsAre("Lamp.001"));
}

// Seen to fail when the lights, the surfaces, the cameras or the deletions are not taken back.
TEST_F(DocumentTest, AnEditThatFailsAtItsLastOperationChangesNothing) {
  applied({createLight("Lamp"), createLight("Old"), createSurface("Wall"), PutCamera{"Front", Camera()}});
  const std::int64_t triangles = document_.triangleCount();
  Camera moved;
  moved.eye = {9, 9, 9};
  const Status failed =
      apply({setRadiance("Lamp", 9.0), createLight("New"), DeleteLight{"Old"}, createSurface("Floor"),
             DeleteSurface{"Wall"}, PutCamera{"Front", moved}, PutCamera{"Back", moved}, DeleteCamera{"Front"},
             createLight("Brief"), DeleteLight{"Brief"}, DeleteLight{"Nobody"}})
          .status();
  EXPECT_EQ(failed.code(), Code::kNotFound);
  EXPECT_EQ(failed.field(), "operations[10].delete_light");
  EXPECT_EQ(document_.revision(), 1U);
  EXPECT_EQ(document_.triangleCount(), triangles);
  const ScenePtr scene = document_.snapshot();
  EXPECT_EQ(scene->lights.size(), 2U);
  EXPECT_EQ(light("Lamp")->radiance, glm::dvec3(1.0));
  EXPECT_NE(light("Old"), nullptr);
  EXPECT_EQ(scene->surfaces.size(), 1U);
  EXPECT_TRUE(scene->surfaces.contains("Wall"));
  ASSERT_EQ(scene->cameras.size(), 1U);
  EXPECT_NE(scene->cameras.at("Front").eye, moved.eye);
  const Changes none = document_.changesSince(1);
  EXPECT_TRUE(none.lights.empty() && none.surfaces.empty() && none.cameras.empty() && none.deleted.empty());
}

TEST_F(DocumentTest, AnEditThatFailsTakesItsGridBack) {
  Document fitted(LightingSettings(), limits_, test::nameOfContent);
  ASSERT_TRUE(fitted.apply(editOf({createLight("Lamp")}), blobs_).ok());
  const Grid before = fitted.grid();
  EXPECT_FALSE(fitted.apply(editOf({moveLight("Lamp", {50, 0, 0}), FitGrid{}, DeleteLight{"Nobody"}}), blobs_).ok());
  EXPECT_EQ(fitted.grid(), before);
  EXPECT_FALSE(fitted.changesSince(1).grid);
}

TEST_F(DocumentTest, TheLastWriterWinsFieldByField) {
  applied({createLight("Lamp")});
  UpdateLight turned{"Lamp", {}};
  turned.fields.transform.rotation = rotationFromEulerDegrees({0, 90, 0});
  UpdateLight scaled{"Lamp", {}};
  scaled.fields.transform.scale = glm::dvec3(3.0);
  scaled.fields.enabled = false;
  applied({moveLight("Lamp", {1, 2, 3})});
  applied({turned});
  applied({setRadiance("Lamp", 4.0)});
  applied({scaled});
  applied({setRadiance("Lamp", 5.0)});
  const auto lamp = light("Lamp");
  EXPECT_EQ(lamp->transform.translation, glm::dvec3(1, 2, 3));
  EXPECT_NEAR(std::abs(lamp->transform.rotation.y), std::sqrt(0.5), 1e-12);
  EXPECT_EQ(lamp->transform.scale, glm::dvec3(3.0));
  EXPECT_EQ(lamp->radiance, glm::dvec3(5.0));
  EXPECT_FALSE(lamp->enabled);
  EXPECT_FALSE(lamp->twoSided);
}

TEST_F(DocumentTest, RadianceAndPowerReplaceEachOther) {
  applied({createLight("Lamp")});
  UpdateLight powered{"Lamp", {}};
  powered.fields.power = glm::dvec3(6.0);
  applied({powered});
  ASSERT_TRUE(light("Lamp")->power);
  applied({moveLight("Lamp", {1, 0, 0})});
  EXPECT_TRUE(light("Lamp")->power) << "another field";
  applied({setRadiance("Lamp", 2.0)});
  EXPECT_FALSE(light("Lamp")->power);
}

Operation createSky() {
  Operation made = createLight("Sky");
  std::get<CreateLight>(made).fields.distant = true;
  std::get<CreateLight>(made).fields.transform.translation = glm::dvec3(0.0, 0.0, -5.0);
  return made;
}

// Broken by: a grid that is fitted to the sky; names of parts that lights could have.
TEST_F(DocumentTest, ADistantLightIsNoContentAndInPartsForTicks) {
  Document fitted(LightingSettings(), limits_, test::nameOfContent);
  ASSERT_TRUE(fitted.apply(editOf({createSurface("Floor")}), blobs_).ok());
  const Grid before = fitted.grid();
  ASSERT_TRUE(fitted.apply(editOf({createSky(), FitGrid{}}, 2), blobs_).ok());
  EXPECT_EQ(fitted.grid(), before);
  EXPECT_EQ(fitted.lightCount(), 1U);
  EXPECT_EQ(fitted.lights()[0].object->name, "Sky");
  const ScenePtr scene = fitted.snapshot();
  ASSERT_EQ(scene->lights.size(), 1U);
  EXPECT_EQ(scene->lights.begin()->first, "Sky/1");
  EXPECT_EQ(sessionName("Sky/1", *scene->lights.at("Sky/1")), "Sky");
}

TEST_F(DocumentTest, ADistantLightHasNoPower) {
  applied({createSky()});
  UpdateLight powered{"Sky", {}};
  powered.fields.power = glm::dvec3(6.0);
  const Status refused = apply({powered}).status();
  EXPECT_EQ(refused.field(), "operations[0].update_light.light.power");
  EXPECT_THAT(refused.message(), HasSubstr("give its radiance"));
  powered.fields.distant = false;
  applied({powered});
}

TEST_F(DocumentTest, AnotherRevisionThanExpectedAborts) {
  applied({createLight("Lamp")});
  Edit edit = editOf({setRadiance("Lamp", 2.0)});
  for (const std::uint64_t wrong : {0U, 2U}) {
    edit.expectedRevision = wrong;
    const Status status = document_.apply(edit, blobs_).status();
    EXPECT_EQ(status.code(), Code::kAborted);
    EXPECT_EQ(status.field(), "expected_revision");
    EXPECT_THAT(status.message(), HasSubstr("at revision 1"));
  }
  EXPECT_EQ(light("Lamp")->radiance, glm::dvec3(1.0));
  edit.expectedRevision = 1;
  EXPECT_TRUE(document_.apply(edit, blobs_).ok());
  EXPECT_EQ(document_.revision(), 2U);
}

TEST_F(DocumentTest, ASceneOnceReadStaysAsItWas) {
  applied({createLight("Lamp")});
  const ScenePtr before = document_.snapshot();
  EXPECT_EQ(document_.snapshot(), before) << "nothing changed: the same one";
  applied({setRadiance("Lamp", 2.0), createLight("Other")});
  EXPECT_EQ(before->lights.size(), 1U);
  EXPECT_EQ(before->lights.at("Lamp")->radiance, glm::dvec3(1.0));
  EXPECT_EQ(document_.snapshot()->lights.at("Lamp")->radiance, glm::dvec3(2.0));
}

/// An operation that is wrong by itself, sent to a session with a light "Lamp" and a surface "Wall".
struct BadOperation {
  const char* name;
  Operation operation;
  Code code;
  const char* field;
  const char* text;
};
class BadOperations : public DocumentTest, public testing::WithParamInterface<BadOperation> {};

TEST_P(BadOperations, AreRefusedByFieldAndChangeNothing) {
  applied({createLight("Lamp"), createSurface("Wall")});
  const BadOperation& bad = GetParam();
  const Status status = apply({setRadiance("Lamp", 3.0), bad.operation}).status();
  EXPECT_EQ(status.code(), bad.code) << status.message();
  EXPECT_EQ(status.field(), std::string("operations[1].") + bad.field);
  EXPECT_THAT(status.message(), HasSubstr(bad.text));
  EXPECT_EQ(document_.revision(), 1U);
  EXPECT_EQ(light("Lamp")->radiance, glm::dvec3(1.0));
}

Operation lightWith(const std::function<void(LightFields&)>& set) {
  UpdateLight op{"Lamp", {}};
  set(op.fields);
  return op;
}

Operation surfaceWith(const std::function<void(SurfaceFields&)>& set) {
  UpdateSurface op{"Wall", {}};
  set(op.fields);
  return op;
}

INSTANTIATE_TEST_SUITE_P(
    All, BadOperations,
    testing::Values(
        BadOperation{"NoName", createLight(""), Code::kInvalidArgument, "create_light.name", "0 bytes"},
        BadOperation{"Slash", createSurface("a/b"), Code::kInvalidArgument, "create_surface.name", "'/'"},
        BadOperation{"NoLightMesh", CreateLight{"New", {}}, Code::kInvalidArgument, "create_light.mesh", "inline_mesh"},
        BadOperation{"NoSurfaceMesh", CreateSurface{"New", {}}, Code::kInvalidArgument, "create_surface.mesh",
                     "inline_mesh"},
        BadOperation{"NoSuchLight", setRadiance("Wall", 1.0), Code::kNotFound, "update_light.light.name", "Wall"},
        BadOperation{"NoSuchSurface", UpdateSurface{"Lamp", {}}, Code::kNotFound, "update_surface.surface.name",
                     "Lamp"},
        BadOperation{"DeleteNoLight", DeleteLight{"Wall"}, Code::kNotFound, "delete_light", "Wall"},
        BadOperation{"DeleteNoSurface", DeleteSurface{"Lamp"}, Code::kNotFound, "delete_surface", "Lamp"},
        BadOperation{"DeleteNoCamera", DeleteCamera{"Front"}, Code::kNotFound, "delete_camera", "Front"},
        BadOperation{"NegativeRadiance", setRadiance("Lamp", -1.0), Code::kInvalidArgument,
                     "update_light.light.radiance", "-1"},
        BadOperation{"FlatScale", lightWith([](LightFields& f) { f.transform.scale = glm::dvec3(1, 0, 1); }),
                     Code::kInvalidArgument, "update_light.light.transform.scale", "0"},
        BadOperation{"UnknownMesh", lightWith([](LightFields& f) {
                       f.mesh = MeshReference{"feed", nullptr};
                     }),
                     Code::kNotFound, "update_light.light.mesh", "UploadBlob"},
        BadOperation{"Group", lightWith([](LightFields& f) { f.group = "key/fill"; }), Code::kInvalidArgument,
                     "update_light.light.group", "'/'"},
        BadOperation{"Albedo", surfaceWith([](SurfaceFields& f) { f.albedo = glm::dvec3(2.0); }),
                     Code::kInvalidArgument, "update_surface.surface.albedo", "2"},
        BadOperation{"UnknownTexture", surfaceWith([](SurfaceFields& f) { f.albedoTexture = "feed"; }), Code::kNotFound,
                     "update_surface.surface.albedo_texture", "feed"},
        BadOperation{"VerticesOfNobody", SetVertices{"Nobody", {}, {}, nullptr, nullptr}, Code::kNotFound,
                     "set_vertices.object", "Nobody"},
        BadOperation{"TooFewVertices", SetVertices{"Lamp", {glm::vec3(0.0F)}, {}, nullptr, nullptr},
                     Code::kInvalidArgument, "set_vertices.positions", "1 vertices"},
        BadOperation{"FitOfAFixedGrid", FitGrid{}, Code::kFailedPrecondition, "fit_grid", "fixed bounds"}),
    [](const auto& row) { return row.param.name; });

TEST_F(DocumentTest, ABlobIsTakenForWhatItIs) {
  auto texture = std::make_shared<Blob>();
  texture->kind = BlobKind::kTexture;
  texture->hash = "picture";
  texture->bytes = std::make_shared<const std::string>("t");
  Texture picture;
  picture.hash = texture->hash;
  texture->texture = std::make_shared<const Texture>(picture);
  ASSERT_TRUE(blobs_.add(texture, Clock::now()).ok());
  applied({createSurface("Wall")});
  UpdateSurface asMesh{"Wall", {}};
  asMesh.fields.mesh = MeshReference{"picture", nullptr};
  EXPECT_THAT(apply({asMesh}).status().message(), HasSubstr("is a texture"));
  UpdateSurface asTexture{"Wall", {}};
  asTexture.fields.albedoTexture = "picture";
  applied({asTexture});
  EXPECT_EQ(document_.snapshot()->surfaces.at("Wall")->albedoTexture, texture->texture);
  UpdateSurface asNormals{"Wall", {}};
  asNormals.fields.normalTexture = "picture";
  applied({asNormals});
  EXPECT_EQ(document_.snapshot()->surfaces.at("Wall")->normalTexture, texture->texture);
  UpdateSurface asGloss{"Wall", {}};
  asGloss.fields.glossTexture = "picture";
  applied({asGloss});
  EXPECT_EQ(document_.snapshot()->surfaces.at("Wall")->glossTexture, texture->texture);
  asTexture.fields.albedoTexture = "";
  asNormals.fields.normalTexture = "";
  applied({asTexture, asNormals});
  EXPECT_EQ(document_.hashesInUse().count("picture"), 1U) << "what the gloss texture alone refers to";
  EXPECT_EQ(document_.snapshot()->surfaces.at("Wall")->albedoTexture, nullptr);
}

// Broken by: looking among blobs alone, where what came within an edit is not.
TEST_F(DocumentTest, AMeshThatAnObjectHasCanBeNamed) {
  applied({createLight("Lamp"), createSurface("Wall")});
  const MeshPtr mesh = light("Lamp")->mesh;
  CreateLight another{"Lamp", {}};
  another.fields.mesh = MeshReference{mesh->hash, nullptr};
  EXPECT_EQ(applied({another}), std::vector<std::string>{"Lamp.001"});
  EXPECT_EQ(light("Lamp.001")->mesh, mesh);
  UpdateSurface wall{"Wall", {}};
  wall.fields.mesh = MeshReference{mesh->hash, nullptr};
  applied({DeleteLight{"Lamp"}, wall});
  applied({DeleteLight{"Lamp.001"}});
  applied({another});
  EXPECT_EQ(light("Lamp")->mesh, mesh) << "the wall has it";
  applied({DeleteLight{"Lamp"}, DeleteSurface{"Wall"}});
  EXPECT_THAT(apply({another}).status().message(), HasSubstr("is not in this session"));
}

TEST_F(DocumentTest, TotalsAreCountedAtTheEndOfAnEdit) {
  limits_.maxLights = 2;
  limits_.maxSurfaces = 2;
  limits_.maxCameras = 1;
  limits_.maxTriangles = 7;
  Document small(fixedGrid(), limits_, test::nameOfContent);
  const auto refusal = [&](std::vector<Operation> operations) {
    return small.apply(editOf(std::move(operations)), blobs_).status();
  };
  EXPECT_TRUE(refusal({createLight("A"), createLight("B"), DeleteLight{"A"}, createLight("C")}).ok());
  EXPECT_EQ(refusal({createLight("D")}).field(), "max_lights");
  EXPECT_TRUE(refusal({createSurface("E")}).ok());
  const Status triangles = refusal({createSurface("F")});
  EXPECT_EQ(triangles.code(), Code::kResourceExhausted);
  EXPECT_EQ(triangles.field(), "max_triangles");
  EXPECT_THAT(triangles.message(), HasSubstr("8"));
  EXPECT_EQ(refusal({DeleteLight{"B"}, createSurface("F"), createSurface("G")}).field(), "max_surfaces");
  EXPECT_EQ(refusal({PutCamera{"H", Camera()}, PutCamera{"I", Camera()}}).field(), "max_cameras");
  EXPECT_TRUE(refusal({PutCamera{"H", Camera()}, PutCamera{"H", Camera()}}).ok()) << "the same camera again";
  EXPECT_EQ(small.triangleCount(), 6);
  EXPECT_EQ(small.revision(), 3U);
}

CreateLight grouped(const std::string& name, const std::string& group) {
  CreateLight op = std::get<CreateLight>(createLight(name));
  op.fields.group = group;
  return op;
}

// Broken by: a group that goes when an edit does not name it.
TEST_F(DocumentTest, AGroupIsAFieldOfALight) {
  applied({grouped("Key", "key"), createLight("Lamp")});
  EXPECT_EQ(light("Key")->group, "key");
  EXPECT_EQ(light("Lamp")->group, "");
  applied({setRadiance("Key", 2.0), lightWith([](LightFields& f) { f.group = "fill"; })});
  EXPECT_EQ(light("Key")->group, "key") << "another field";
  EXPECT_EQ(light("Lamp")->group, "fill");
  applied({lightWith([](LightFields& f) { f.group = ""; })});
  EXPECT_EQ(light("Lamp")->group, "");
}

// Broken by: nine allowed; the groups of lights that the edit itself touches taken for there already.
TEST_F(DocumentTest, LightsAreInAtMostEightGroups) {
  applied({createLight("Lamp")});  // a group too
  for (int i = 1; i < kMaxGroups; ++i) applied({grouped("Key", "group " + std::to_string(i))});
  const Status ninth = apply({setRadiance("Lamp", 9.0), grouped("Key", "a ninth")}).status();
  EXPECT_EQ(ninth.code(), Code::kResourceExhausted);
  EXPECT_EQ(ninth.field(), "max_groups");
  EXPECT_THAT(ninth.message(), HasSubstr("\"a ninth\""));
  EXPECT_THAT(ninth.message(), HasSubstr("9 groups, allowed are 8"));
  EXPECT_EQ(light("Lamp")->radiance, glm::dvec3(1.0));
  EXPECT_EQ(document_.revision(), 8U);
  applied({grouped("Key", "group 3")});
  applied({grouped("Key", "a ninth"), lightWith([](LightFields& f) { f.group = "group 1"; })});  // counted at the end
  EXPECT_EQ(apply({lightWith([](LightFields& f) { f.group = "a tenth"; })}).status().field(), "max_groups");
  EXPECT_EQ(light("Lamp")->group, "group 1");
}

TEST_F(DocumentTest, VerticesPreparedForAnotherMeshAreMadeAgain) {
  applied({createLight("Lamp")});
  std::vector<glm::vec3> larger = reference::quad()->positions;
  for (glm::vec3& p : larger) p *= 2.0F;
  SetVertices op{"Lamp", larger, {}, nullptr, nullptr};
  ASSERT_TRUE(prepareVertices(op, document_.meshOf("Lamp"), test::nameOfContent).ok());
  const MeshPtr prepared = op.deformed;
  ASSERT_NE(prepared, nullptr);
  applied({op});
  EXPECT_EQ(light("Lamp")->mesh, prepared) << "taken as it was prepared";
  EXPECT_EQ(document_.meshInUse(prepared->hash), prepared);
  EXPECT_TRUE(document_.hashesInUse().contains(prepared->hash));
  UpdateLight pyramid{"Lamp", {}};
  pyramid.fields.mesh = MeshReference{"pyramid", reference::pyramid()};
  applied({pyramid});
  EXPECT_EQ(apply({op}).status().field(), "operations[0].set_vertices.positions") << "the pyramid has other vertices";
  EXPECT_EQ(document_.meshInUse(prepared->hash), nullptr);
}

TEST_F(DocumentTest, AFittedGridFollowsNewContentAndNothingThatMoves) {
  Document fitted(LightingSettings(), limits_, test::nameOfContent);
  const auto grid = [&](std::vector<Operation> operations) {
    EXPECT_TRUE(fitted.apply(editOf(std::move(operations)), blobs_).ok());
    return fitted.grid();
  };
  const Grid first = grid({createLight("Lamp")});
  EXPECT_EQ(grid({moveLight("Lamp", {50, 0, 0})}), first);
  EXPECT_EQ(grid({DeleteLight{"Lamp"}}), first);
  EXPECT_EQ(grid({createSurface("Wall")}), first) << "inside";
  CreateSurface far{"Far", {}};
  far.fields.mesh = MeshReference{"quad", reference::quad()};
  far.fields.transform.translation = glm::dvec3(10, 0, 0);
  EXPECT_FALSE(grid({far}) == first) << "outside";
  EXPECT_TRUE(fitted.changesSince(4).grid);
  grid({DeleteSurface{"Far"}});
  EXPECT_EQ(grid({FitGrid{}}), first) << "on request";
}

TEST_F(DocumentTest, SettingsAreARevisionWhereTheyDiffer) {
  LightingSettings options = fixedGrid();
  EXPECT_TRUE(document_.setOptions(options).ok());
  EXPECT_EQ(document_.revision(), 0U);
  options.iterations = 5;
  EXPECT_TRUE(document_.setOptions(options).ok());
  EXPECT_EQ(document_.revision(), 1U);
  EXPECT_TRUE(document_.changesSince(0).options);
  EXPECT_FALSE(document_.changesSince(0).grid);
  options.iterations = -1;
  EXPECT_EQ(document_.setOptions(options).field(), "settings.iterations");
  EXPECT_EQ(document_.options().iterations, 5);
  options.iterations = 5;
  options.grid.longest = 16;
  EXPECT_TRUE(document_.setOptions(options).ok());
  EXPECT_EQ(document_.grid().dims.x, 16);
  EXPECT_EQ(document_.snapshot()->grid.dims.x, 16);
  EXPECT_TRUE(document_.changesSince(1).grid);
}

}  // namespace
}  // namespace lpv
