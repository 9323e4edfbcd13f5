// Patches tile what they stand for, and bounces go on for as long as the wanted error asks.
#include "scene/patches.h"

#include <gtest/gtest.h>
#include <utility>

#include <cmath>
#include <map>

#include "reference/meshes.h"
#include "reference/textures.h"

namespace lpv {
namespace {

Surface& add(Scene& scene, const std::string& name, const MeshPtr& mesh) {
  auto surface = std::make_shared<Surface>();
  surface->name = name;
  surface->mesh = mesh;
  scene.surfaces[name] = surface;
  return *surface;
}

Scene sceneWith(const MeshPtr& mesh, bool twoSided = false) {
  Scene scene;
  add(scene, "it", mesh).twoSided = twoSided;
  return scene;
}

double areaOf(const std::vector<Patch>& patches) {
  double sum = 0.0;
  for (const Patch& p : patches) sum += double(p.area);
  return sum;
}

// Broken by: the last small triangles, which no patch was made of.
TEST(Patches, HaveTheSurfacesArea) {
  for (const MeshPtr& mesh : {reference::quad(), reference::sphere(), reference::pyramid(), reference::tube(),
                              reference::bumpySphere(2000)}) {
    double area = 0.0;
    for (const glm::uvec3& t : mesh->triangles) {
      const auto& p = mesh->positions;
      area += 0.5 * double(glm::length(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x])));
    }
    EXPECT_NEAR(areaOf(patchesOf(sceneWith(mesh), 300)), area, 1e-4 * area);
    EXPECT_NEAR(areaOf(patchesOf(sceneWith(mesh, true), 300)), 2.0 * area, 2e-4 * area);
  }
}

/// A room of 4 m with walls of two sides, and a lamp in it.
Scene litRoom() {
  Scene scene = sceneWith(reference::box(glm::dvec3(-2.0), glm::dvec3(2.0), true), true);
  auto lamp = std::make_shared<Light>();
  lamp->name = "lamp";
  lamp->mesh = reference::quad();
  scene.lights["lamp"] = lamp;
  return scene;
}

// Broken by: sides whose planes the lamp may be before.
TEST(Patches, AreOnSidesThatLightMayComeTo) {
  Scene scene = litRoom();
  EXPECT_NEAR(areaOf(patchesOf(scene, 300)), 96.0, 1e-3) << "no light comes to the outside";
  auto lamp = std::make_shared<Light>(*scene.lights.at("lamp"));
  lamp->transform.translation.z = 5.0;
  scene.lights["lamp"] = lamp;
  EXPECT_NEAR(areaOf(patchesOf(scene, 300)), 96.0 + 16.0, 1e-3) << "above the roof";
  lamp = std::make_shared<Light>(*lamp);
  lamp->distant = true;
  scene.lights["lamp"] = lamp;
  EXPECT_NEAR(areaOf(patchesOf(scene, 300)), 192.0, 1e-3) << "the sky";
}

// Broken by: triangles cut to an area of 0, or to that of what little is lit.
TEST(Patches, AreFewWhereHardlyAnythingIsLit) {
  Scene scene = litRoom();
  scene.surfaces.clear();
  Surface& sheet = add(scene, "sheet", reference::quad());
  sheet.twoSided = false;
  sheet.transform.scale = glm::dvec3(1000.0);
  sheet.transform.rotation = rotationFromEulerDegrees({180.0, 0.0, 0.0});
  sheet.transform.translation.z = -1.0;
  EXPECT_TRUE(patchesOf(scene, 300).empty()) << "it turns its back to the lamp";
  add(scene, "thing", reference::sphere()).transform.scale = glm::dvec3(0.1);
  EXPECT_LE(patchesOf(scene, 300).size(), 600U);
}

TEST(Patches, AreAboutAsManyAsAskedFor) {
  for (const MeshPtr& mesh : {reference::quad(), reference::sphere(), reference::bumpySphere(2000)}) {
    const std::size_t count = patchesOf(sceneWith(mesh), 500).size();
    EXPECT_GE(count, 250U);
    EXPECT_LE(count, 1000U);
  }
}

// A flat wall's patches differ by a factor of two at most. Broken by: halves along the first edge instead of the
// longest.
TEST(Patches, OfAWallAreAlikeInSizeAndShape) {
  Scene scene = sceneWith(reference::quad());
  auto wide = std::make_shared<Surface>(*scene.surfaces.at("it"));
  wide->transform.scale = {4.0, 1.0, 1.0};
  scene.surfaces["it"] = wide;
  float least = 1e9F, most = 0.0F;
  for (const Patch& p : patchesOf(scene, 200)) {
    least = std::min(least, p.area);
    most = std::max(most, p.area);
    ASSERT_TRUE(p.triangle.has_value());
    const auto& c = *p.triangle;
    const float longest = std::max({glm::distance(c[0], c[1]), glm::distance(c[1], c[2]), glm::distance(c[2], c[0])});
    EXPECT_LE(longest * longest, 17.0F * p.area);  // the wall's own two triangles: 8.5
    EXPECT_NEAR(glm::dot(p.normal, glm::cross(c[1] - c[0], c[2] - c[0])), 2.0F * p.area, 1e-5F);
  }
  EXPECT_LE(most, 2.01F * least);
}

// Corners turn as the side does, mirrored objects too. Broken by: the back's corners in the front's order.
TEST(Patches, OfTheBackAreSeenFromTheBack) {
  Scene scene = sceneWith(reference::quad(), true);
  auto mirrored = std::make_shared<Surface>(*scene.surfaces.at("it"));
  mirrored->name = "mirrored";
  mirrored->transform.scale = {-1.0, 1.0, 1.0};
  scene.surfaces["mirrored"] = mirrored;
  std::map<bool, int> sides;
  for (const Patch& p : patchesOf(scene, 100)) {
    const auto& c = p.triangle.value();
    EXPECT_GT(glm::dot(p.normal, glm::cross(c[1] - c[0], c[2] - c[0])), 0.0F);
    ++sides[p.normal.z > 0.0F];
  }
  EXPECT_EQ(sides[true], sides[false]);
}

// Broken by: the whole texture's mean for each patch.
TEST(Patches, HaveTheTexturesColourAroundThem) {
  Scene scene = sceneWith(reference::quad());
  auto textured = std::make_shared<Surface>(*scene.surfaces.at("it"));
  textured->albedo = {1.0, 0.5, 0.25};
  textured->albedoTexture = reference::noise(2, 2);
  scene.surfaces["it"] = textured;
  float least = 1.0F, most = 0.0F;
  for (const Patch& p : patchesOf(scene, 200)) {
    least = std::min(least, p.albedo.r);
    most = std::max(most, p.albedo.r);
    EXPECT_LE(p.albedo.g, 0.5F);
    EXPECT_LE(p.albedo.b, 0.25F);
  }
  EXPECT_GT(most, least + 0.1F);
}

// Of thin boards in a row each patch has many, and their mean. Broken by: the colour in its middle (.08 or 1).
TEST(Patches, HaveTheMeanOfWhatIsOnThem) {
  Scene scene = sceneWith(reference::quad());
  auto boards = std::make_shared<Surface>(*scene.surfaces.at("it"));
  boards->albedo = glm::dvec3(1.0);
  boards->albedoTexture = reference::textureOf(64, 64, [](int x, int) { return glm::dvec3(x % 4 == 0 ? 1.0 : 0.08); });
  scene.surfaces["it"] = boards;
  const std::vector<Patch> patches = patchesOf(scene, 16);
  EXPECT_GE(patches.size(), 8U);
  for (const Patch& p : patches) EXPECT_NEAR(p.albedo.r, 0.31F, 0.05F) << p.position.x << ", " << p.position.y;
}

// A thousand small things have as many patches as a few, of the same area. Broken by: one of each at least.
TEST(Patches, AreBoundedForManySurfaces) {
  Scene scene;
  for (int i = 0; i < 1000; ++i) {
    Surface& ball = add(scene, std::to_string(i), reference::sphereOf(8, 6));
    ball.twoSided = i % 3 == 0;
    ball.transform.scale = glm::dvec3(0.01 * (1 + i % 7));
    ball.transform.translation.x = i;
  }
  const std::vector<Patch> few = patchesOf(scene, 128), many = patchesOf(scene, 4096);
  EXPECT_LE(few.size(), 256U);
  EXPECT_GE(many.size(), 1000U);
  EXPECT_NEAR(areaOf(few), areaOf(many), 1e-3 * areaOf(many));
}

/// A ball of small triangles on both sides, and a wall so large that few patches stand for the ball.
Scene ballBeforeWall() {
  Scene scene = sceneWith(reference::sphereOf(32, 16), true);
  Surface& wall = add(scene, "wall", reference::quad());
  wall.transform.scale = glm::dvec3(20.0);
  wall.twoSided = false;
  return scene;
}

// Pieces tile what folded patches stand for, each of the patch that has it. Broken by: the last piece's area; pieces of
// the back that belong to the front's patches.
TEST(Folds, PiecesHaveTheirPatchesArea) {
  const PatchedScene patched = patchedScene(ballBeforeWall(), 64, 256);
  const Folds& folds = patched.folds;
  ASSERT_EQ(folds.patchOf.size(), folds.pieces.size());
  EXPECT_GE(folds.pieces.size(), 200U);
  EXPECT_LE(folds.pieces.size(), 600U);
  std::map<std::uint32_t, double> areas;
  for (std::size_t i = 0; i < folds.pieces.size(); ++i) areas[folds.patchOf[i]] += double(folds.pieces[i].area);
  std::size_t folded = 0;
  for (std::uint32_t p = 0; p < patched.patches.size(); ++p) {
    folded += std::size_t(patched.patches[p].reach > 0.0F);
    EXPECT_EQ(patched.patches[p].reach > 0.0F, areas.contains(p)) << p;
    if (!areas.contains(p)) continue;
    EXPECT_NEAR(areas[p], double(patched.patches[p].area), 1e-4 * areas[p]);
  }
  EXPECT_GE(folded, 2U);
  EXPECT_LT(folded, patched.patches.size() / 4);
}

// What a ray meets has a piece there, which faces as it does; that of the back faces the other way.
// Broken by: pieces by the order of triangles alone, which on a ball go all around.
TEST(Folds, ATriangleHasAPieceThatFacesLikeIt) {
  const Scene scene = ballBeforeWall();
  const Folds folds = patchedScene(scene, 64, 256).folds;
  ASSERT_EQ(folds.surfaces.size(), 2U);
  EXPECT_TRUE(folds.surfaces[1].triangles.empty());
  const Mesh& mesh = *scene.surfaces.at("it")->mesh;
  const Folds::OfSurface& of = folds.surfaces[0];
  ASSERT_EQ(of.triangles.size(), mesh.triangles.size());
  EXPECT_EQ(2 * of.toBack, folds.pieces.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    const glm::vec3 cross = glm::cross(b - a, c - a);
    if (!(glm::length(cross) > 1e-9F)) continue;
    ASSERT_EQ(of.triangles[i].count, 1U);
    const Patch &front = folds.pieces[of.triangles[i].first], &back = folds.pieces[of.triangles[i].first + of.toBack];
    EXPECT_GT(glm::dot(front.normal, glm::normalize(cross)), 0.2F) << i;
    EXPECT_EQ(front.normal, -back.normal);
    EXPECT_LT(glm::distance(front.position, (a + b + c) / 3.0F), 0.5F) << i;
  }
}

// A small triangle that is larger than a piece is cut.
TEST(Folds, LongTrianglesHaveSeveralPieces) {
  Scene scene = ballBeforeWall();
  auto bar = std::make_shared<Surface>(*scene.surfaces.at("it"));
  bar->mesh = reference::box(glm::dvec3(0.0), glm::dvec3(2.0, 0.1, 0.1), false);
  scene.surfaces["it"] = bar;
  const Folds folds = patchedScene(scene, 64, 256).folds;
  std::uint32_t most = 0;
  for (const Folds::Range& range : folds.surfaces[0].triangles) most = std::max(most, range.count);
  EXPECT_GE(most, 4U);
}

// Panes do not end a ray, so what is behind them is not hidden by their pieces.
TEST(Folds, WhatLetsLightThroughHasNone) {
  Scene scene = ballBeforeWall();
  auto pane = std::make_shared<Surface>(*scene.surfaces.at("it"));
  pane->opacity = 0.5;
  pane->alphaMode = AlphaMode::kBlend;
  scene.surfaces["it"] = pane;
  EXPECT_TRUE(patchedScene(scene, 64, 256).folds.pieces.empty());
}

TEST(Patches, BlackSurfacesHaveNone) {
  Scene scene = sceneWith(reference::quad());
  add(scene, "black", reference::quad()).albedo = glm::dvec3(0.0);
  scene.surfaces.erase("it");
  EXPECT_TRUE(patchesOf(scene, 100).empty());
}

Scene reflecting(double albedo, int asked, double wanted = 0.0) {
  Scene scene = sceneWith(reference::quad());
  auto surface = std::make_shared<Surface>(*scene.surfaces.at("it"));
  surface->albedo = glm::dvec3(0.5 * albedo, albedo, 0.0);
  scene.surfaces["it"] = surface;
  scene.options.bounces = asked;
  scene.options.maxError = wanted;
  return scene;
}

int bounces(double albedo, int asked, double wanted = 0.0) { return bouncesFor(reflecting(albedo, asked, wanted)); }

// After n bounces a share of albedo^(n + 1) at most is still under way.
// Broken by: the mean albedo; the whole of the wanted error.
TEST(Bounces, GoOnUntilAThirdOfTheWantedError) {
  for (const double albedo : {0.2, 0.5, 0.8}) {
    const int n = bounces(albedo, kAutoBounces, 0.03);
    EXPECT_LE(std::pow(albedo, n + 1), 0.01) << albedo;
    EXPECT_GT(std::pow(albedo, n), 0.01) << albedo;
  }
  EXPECT_GT(bounces(0.5, kAutoBounces, 0.001), bounces(0.5, kAutoBounces, 0.1));
  EXPECT_EQ(bounces(1.0, kAutoBounces), kMaxBounces);
}

/// What is missing of 1 / (1 - exchange) after the plan's turns and the receiver's own, as a share of it.
double missingAfter(const BouncePlan& plan, double exchange) {
  double before = 0.0, now = 1.0;
  for (int turn = 1; turn < plan.turns; ++turn)
    before = std::exchange(now, before + plan.weight(turn) * (1.0 + exchange * now - before));
  return std::abs(1.0 - (1.0 - exchange) * (1.0 + exchange * now));
}

// Broken by: weights of one turn too early or too late; turns for the receiver's own.
TEST(Bounces, WeighedTurnsLeaveNoMoreForAnyExchange) {
  for (const double albedo : {0.1, 0.5, 0.8, 0.95}) {
    const BouncePlan plan = bouncePlan(reflecting(albedo, kAutoBounces, 0.03));
    EXPECT_LE(plan.turns, 1 + bounces(albedo, kAutoBounces, 0.03)) << albedo;
    double most = 0.0;
    for (int i = -100; i <= 100; ++i) most = std::max(most, missingAfter(plan, albedo * i / 100.0));
    EXPECT_LE(most, 0.01 / 3.0) << albedo << ", " << plan.turns << " turns";
  }
  EXPECT_LE(bouncePlan(reflecting(0.8, kAutoBounces, 0.03)).turns, 9);
  EXPECT_EQ(bounces(0.8, kAutoBounces, 0.03), 20);
}

TEST(Bounces, ThatWereAskedForAreNotWeighed) {
  const BouncePlan plan = bouncePlan(reflecting(0.8, 5));
  EXPECT_EQ(plan.turns, 5);
  for (int turn = 0; turn < 5; ++turn) EXPECT_EQ(plan.weight(turn), 1.0);
}

TEST(Bounces, AreWhatWasAskedFor) {
  EXPECT_EQ(bounces(0.5, 0), 0);
  EXPECT_EQ(bounces(0.5, 3), 3);
  EXPECT_EQ(bounces(0.0, 3), 0) << "no surface reflects";
  EXPECT_EQ(bouncesFor(Scene()), 0);
}

}  // namespace
}  // namespace lpv
