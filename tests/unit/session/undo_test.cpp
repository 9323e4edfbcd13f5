// Undo and redo, of several members at once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/session/undo_rig.h"

namespace lpv {
namespace {

using test::createLight;
using test::createSurface;
using test::editOf;
using test::moveLight;
using test::setRadiance;
using test::UndoTest;
using test::unhurried;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(UndoTest, TakesBackOneStepAfterTheOtherAndMakesThemAgain) {
  apply(a_, {createLight("Lamp")});
  apply(a_, {setRadiance("Lamp", 2.0)});
  apply(a_, {setRadiance("Lamp", 3.0)});
  EXPECT_EQ(undo(a_).revision, 4U) << "an edit";
  EXPECT_EQ(radiance(), 2.0);
  EXPECT_THAT(undo(a_).names, ElementsAre("Lamp"));
  EXPECT_EQ(radiance(), 1.0);
  undo(a_);
  EXPECT_EQ(light(), nullptr);
  EXPECT_EQ(undo(a_).status.code(), Code::kFailedPrecondition);
  for (const double expected : {1.0, 2.0, 3.0}) {
    EXPECT_TRUE(redo(a_).status.ok());
    EXPECT_EQ(radiance(), expected);
  }
  const Status over = redo(a_).status;
  EXPECT_EQ(over.code(), Code::kFailedPrecondition);
  EXPECT_THAT(over.message(), HasSubstr("nothing to redo"));
}

TEST_F(UndoTest, LeavesAndNamesWhatSomebodyElseHasWrittenSince) {
  apply({}, {createLight("Lamp")});
  UpdateLight both{"Lamp", {}};
  both.fields.radiance = glm::dvec3(2.0);
  both.fields.transform.translation = glm::dvec3(1.0);
  apply(a_, {both});
  apply(b_, {setRadiance("Lamp", 5.0)});
  const EditOutcome outcome = undo(a_);
  EXPECT_TRUE(outcome.status.ok());
  EXPECT_THAT(outcome.skipped, ElementsAre("Lamp.radiance"));
  EXPECT_EQ(radiance(), 5.0);
  EXPECT_EQ(place(), 0.0);
  EXPECT_TRUE(undo(b_).skipped.empty());
  EXPECT_EQ(radiance(), 2.0) << "what was there before B's step";
  redo(a_);
  EXPECT_EQ(place(), 1.0) << "what was undone, and no more";
  EXPECT_EQ(radiance(), 2.0);
}

TEST_F(UndoTest, WhatIsSkippedWholeIsAnEditToo) {
  apply({}, {createLight("Lamp")});
  apply(a_, {setRadiance("Lamp", 2.0)});
  apply(b_, {DeleteLight{"Lamp"}});
  const EditOutcome outcome = undo(a_);
  EXPECT_TRUE(outcome.status.ok());
  EXPECT_EQ(outcome.revision, 4U);
  EXPECT_THAT(outcome.names, IsEmpty());
  EXPECT_THAT(outcome.skipped, ElementsAre("Lamp"));
  EXPECT_EQ(redo(a_).status.code(), Code::kFailedPrecondition) << "nothing was undone";
}

TEST_F(UndoTest, AnObjectThatSomebodyElseHasChangedIsNotRemoved) {
  apply(a_, {createLight("Lamp")});
  apply(b_, {setRadiance("Lamp", 4.0)});
  EXPECT_THAT(undo(a_).skipped, ElementsAre("Lamp.radiance"));
  EXPECT_EQ(radiance(), 4.0);
}

TEST_F(UndoTest, ADeletedObjectComesBackWithItsFieldsUnlessItsNameIsTaken) {
  apply({}, {createLight("Lamp"), createLight("Other")});
  apply(a_, {setRadiance("Lamp", 3.0), setRadiance("Other", 3.0)});
  apply(a_, {DeleteLight{"Lamp"}, DeleteLight{"Other"}});
  apply(b_, {createSurface("Other")});
  EXPECT_THAT(undo(a_).skipped, ElementsAre("Other"));
  EXPECT_EQ(radiance(), 3.0);
  EXPECT_THAT(undo(a_).skipped, ElementsAre("Other"));
  EXPECT_EQ(radiance(), 1.0) << "the step before is still there to undo";
}

TEST_F(UndoTest, ADragIsOneStep) {
  apply({}, {createLight("Lamp")});
  apply(a_, {moveLight("Lamp", glm::dvec3(1.0))});
  for (int i = 2; i < 30; ++i) apply(a_, {moveLight("Lamp", glm::dvec3(double(i)))}, "drag");
  apply(a_, {moveLight("Lamp", glm::dvec3(50.0))}, "another");
  undo(a_);
  EXPECT_EQ(place(), 29.0);
  undo(a_);
  EXPECT_EQ(place(), 1.0);
  redo(a_);
  EXPECT_EQ(place(), 29.0);
  apply(a_, {moveLight("Lamp", glm::dvec3(60.0))}, "drag");
  undo(a_);
  EXPECT_EQ(place(), 29.0) << "what follows a redo is no part of the drag";
}

TEST_F(UndoTest, ANewEditClearsWhatCouldBeRedoneOfThatMemberOnly) {
  apply(a_, {createLight("Lamp")});
  apply(b_, {createLight("Other")});
  undo(a_);
  undo(b_);
  apply(a_, {createLight("Third")});
  EXPECT_EQ(redo(a_).status.code(), Code::kFailedPrecondition);
  EXPECT_TRUE(redo(b_).status.ok());
}

TEST_F(UndoTest, ARepeatedSequenceIsOneStep) {
  apply({}, {createLight("Lamp")});
  apply(a_, {setRadiance("Lamp", 2.0)});
  apply(a_, {setRadiance("Lamp", 3.0)});
  apply(b_, {setRadiance("Lamp", 4.0)});
  const EditOutcome first = undo(a_, 7);
  const EditOutcome again = undo(a_, 7);
  EXPECT_EQ(first.revision, again.revision);
  EXPECT_THAT(again.skipped, ElementsAre("Lamp.radiance"));
  EXPECT_EQ(session_->revision(), first.revision);
}

TEST_F(UndoTest, IsForMembersWhoSayWhoTheyAre) {
  apply({}, {createLight("Lamp")});
  const Status nobody = undo({}).status;
  EXPECT_EQ(nobody.code(), Code::kInvalidArgument);
  EXPECT_EQ(nobody.field(), "client");
  EXPECT_EQ(undo({a_.id, "guess"}).status.code(), Code::kPermissionDenied);
  apply(a_, {setRadiance("Lamp", 2.0)});
  session_->leave(a_);
  EXPECT_EQ(undo(a_).status.code(), Code::kPermissionDenied);
  EXPECT_EQ(undo(b_).status.code(), Code::kFailedPrecondition) << "others' steps are not one's own";
}

TEST_F(UndoTest, TheLast100StepsAreKept) {
  apply({}, {createLight("Lamp")});
  for (int i = 1; i <= 101; ++i) apply(a_, {setRadiance("Lamp", i)});
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(undo(a_).status.ok()) << i;
  EXPECT_EQ(undo(a_).status.code(), Code::kFailedPrecondition);
  EXPECT_EQ(radiance(), 1.0) << "the first edit is forgotten, and stays";
}

TEST_F(UndoTest, AStepThatWouldExceedALimitIsRefusedAndStays) {
  apply(a_, {createLight("Lamp")});
  apply(a_, {DeleteLight{"Lamp"}});
  std::vector<Operation> all;
  for (int i = 0; i < session_->limits().maxLights; ++i) all.push_back(createLight("L" + std::to_string(i)));
  apply(b_, all);
  EXPECT_EQ(undo(a_).status.field(), "max_lights");
  apply(b_, {DeleteLight{"L0"}});
  EXPECT_TRUE(undo(a_).status.ok());
  EXPECT_NE(light(), nullptr);
}

TEST_F(UndoTest, WatchersAreToldAsOfAnyEdit) {
  apply(a_, {createLight("Lamp")});
  std::atomic<int> told{0};
  session_->watch([&] { ++told; }, [](Closing) {});
  undo(a_);
  EXPECT_EQ(told, 1);
  std::map<std::string, std::uint64_t> sequences;
  const Changes changes = session_->changesSince(1, &sequences);
  ASSERT_EQ(changes.deleted.size(), 1U);
  EXPECT_EQ(changes.deleted[0].name, "Lamp");
  EXPECT_TRUE(sequences.contains(a_.id)) << "the undo counts as the member's edit";
}

TEST_F(UndoTest, CamerasGoAndComeWhole) {
  Camera far;
  far.eye.z = 30.0;
  apply(a_, {PutCamera{"Front", Camera()}});
  apply(a_, {PutCamera{"Front", far}});
  apply(a_, {DeleteCamera{"Front"}});
  undo(a_);
  EXPECT_EQ(session_->cameras().at(0).second, far);
  undo(a_);
  EXPECT_EQ(session_->cameras().at(0).second, Camera());
  apply(b_, {PutCamera{"Front", far}});
  EXPECT_THAT(undo(a_).skipped, ElementsAre("Front"));
}

TEST_F(UndoTest, ADeformedMeshComesBack) {
  apply({}, {createLight("Lamp")});
  const MeshPtr before = light()->mesh;
  SetVertices op{"Lamp", before->positions, {}, nullptr, nullptr};
  op.positions[0] += glm::vec3(0.25F);
  apply(a_, {op});
  const MeshPtr deformed = light()->mesh;
  ASSERT_NE(deformed, before);
  undo(a_);
  EXPECT_EQ(light()->mesh, before);
  redo(a_);
  EXPECT_EQ(light()->mesh, deformed);
}

class UndoGridTest : public UndoTest {
 protected:
  Grid grid() { return session_->scene()->grid; }
  /// A square light of this size, metres.
  static Operation lightOf(const std::string& name, double size, const glm::dvec3& at = glm::dvec3(0.0)) {
    CreateLight op = std::get<CreateLight>(createLight(name));
    op.fields.transform.scale = glm::dvec3(size);
    op.fields.transform.translation = at;
    return op;
  }
};

// Broken by: a step that does not remember the grid.
TEST_F(UndoGridTest, TheGridComesBackWithTheEditThatHadItFitted) {
  apply(a_, {createLight("Lamp"), createSurface("Wall")});
  const Grid room = grid();
  apply(a_, {lightOf("Statue", 1800.0)});
  const Grid large = grid();
  ASSERT_GT(large.cell, 4.0 * room.cell);
  EXPECT_TRUE(undo(a_).skipped.empty());
  EXPECT_EQ(grid(), room);
  EXPECT_EQ(session_->changesSince(2, nullptr).grid, room) << "watchers are told";
  redo(a_);
  EXPECT_EQ(grid(), large);
  apply(a_, {lightOf("Larger", 9000.0)});
  undo(a_);
  EXPECT_EQ(grid(), large);
  undo(a_);
  EXPECT_EQ(grid(), room);
}

// Broken by: a grid for nothing that counts as fitted.
TEST_F(UndoGridTest, WhatComesIntoAnEmptySceneIsFittedAfterAnUndoToo) {
  apply(a_, {lightOf("Statue", 1800.0)});
  undo(a_);
  apply(a_, {lightOf("Statue", 0.01)});
  EXPECT_LT(grid().cell, 0.001);
}

TEST_F(UndoGridTest, AFitOnRequestIsAStepWhereItChangesTheGrid) {
  apply({}, {createLight("Lamp"), createSurface("Wall")});
  const Grid before = grid();
  apply(a_, {moveLight("Lamp", {50, 0, 0})});
  apply(a_, {FitGrid{}});
  ASSERT_FALSE(grid() == before);
  apply(a_, {FitGrid{}});
  undo(a_);
  EXPECT_EQ(grid(), before);
  EXPECT_EQ(place(), 50.0);
  undo(a_);
  EXPECT_EQ(place(), 0.0);
}

// Broken by: the first grid of a drag's last edit.
TEST_F(UndoGridTest, AGroupBringsBackTheGridThatItsFirstEditFound) {
  apply({}, {createLight("Lamp"), createSurface("Wall")});
  const Grid room = grid();
  for (const double size : {10.0, 100.0, 1000.0}) apply(a_, {lightOf("Statue", size)}, "load");
  undo(a_);
  EXPECT_EQ(grid(), room);
}

// Broken by: a grid that comes back over somebody else's.
TEST_F(UndoGridTest, SomebodyElsesGridStaysAndIsNamed) {
  apply({}, {createLight("Lamp"), createSurface("Wall")});
  apply(a_, {lightOf("Statue", 1800.0)});
  apply(b_, {lightOf("Larger", 9000.0)});
  const Grid theirs = grid();
  EXPECT_THAT(undo(a_).skipped, ElementsAre(kGridField));
  EXPECT_EQ(grid(), theirs);
  undo(b_);
  EXPECT_LT(grid().cell, theirs.cell);
  apply(a_, {lightOf("Statue", 20'000.0)});
  const Expected<SessionSettings> other = [&] {
    SessionSettings settings;
    settings.options.grid.longest = 16;
    return settings;
  }();
  ASSERT_TRUE(session_->changeSettings([&](const SessionSettings&) { return other; }).ok());
  const Grid set = grid();
  EXPECT_THAT(undo(a_).skipped, ElementsAre(kGridField));
  EXPECT_EQ(grid(), set);
}

// Broken by: the old grid all the same.
TEST_F(UndoGridTest, IsFittedAnewWhereSomebodyHasBuiltBeyondTheOldOne) {
  apply({}, {createLight("Lamp"), createSurface("Wall")});
  const Grid room = grid();
  apply(a_, {lightOf("Statue", 1800.0)});
  const Grid large = grid();
  apply(b_, {lightOf("Sofa", 2.0, {20, 0, 0})});
  ASSERT_EQ(grid(), large) << "inside";
  EXPECT_TRUE(undo(a_).skipped.empty());
  const Grid fitted = grid();
  EXPECT_FALSE(fitted == room);
  EXPECT_GT(fitted.bounds().max.x, 20.0);
  EXPECT_LT(fitted.cell, large.cell / 10.0);
  redo(a_);
  EXPECT_EQ(grid(), large);
  undo(a_);
  EXPECT_EQ(grid(), fitted) << "what the redo found";
}

class UndoBytesTest : public UndoTest {
 protected:
  UndoBytesTest() : UndoTest(small()) {}
  static Limits small() {
    Limits limits = unhurried();
    limits.maxUndoBytes = 100'000;
    return limits;
  }
};

// Seen to fail when meshes are not counted.
TEST_F(UndoBytesTest, StepsWithTheirMeshesAreBounded) {
  CreateLight op{"Lamp", {}};
  Mesh mesh;
  mesh.positions.assign(300, glm::vec3(0.0F));
  mesh.positions[298].x = 1.0F;
  mesh.triangles = {{297, 298, 299}};
  ASSERT_TRUE(finishMesh(mesh).ok());
  mesh.hash = "first";
  op.fields.mesh = MeshReference{mesh.hash, std::make_shared<const Mesh>(mesh)};
  apply({}, {op});
  constexpr int kEdits = 90;  // of 3.6 KB and a little each: about 24 fit
  for (int i = 0; i < kEdits; ++i) {
    SetVertices vertices{"Lamp", mesh.positions, {}, nullptr, nullptr};
    vertices.positions[299].y = float(i + 1);
    apply(a_, {vertices});
  }
  int undone = 0;
  while (undo(a_).status.ok()) ++undone;
  EXPECT_GE(undone, 15);
  EXPECT_LE(undone, 30);
  for (int i = 0; i < 90; ++i) apply(b_, {setRadiance("Lamp", i)});
  undone = 0;
  while (undo(b_).status.ok()) ++undone;
  EXPECT_EQ(undone, 90) << "a colour is small";
}

TEST_F(UndoTest, BlobsThatCanComeBackAreKept) {
  Limits limits = unhurried();
  limits.keepUnusedBlobs = std::chrono::minutes(0);
  test::Rig rig(limits);
  const auto session = rig.session();
  Blob blob;
  blob.kind = BlobKind::kMesh;
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  ASSERT_TRUE(finishMesh(mesh).ok());
  blob.hash = mesh.hash = "uploaded";
  blob.bytes = std::make_shared<const std::string>("bytes");
  blob.mesh = std::make_shared<const Mesh>(mesh);
  ASSERT_TRUE(session->addBlob(std::make_shared<const Blob>(blob)).ok());
  const ClientIdentity client = *session->join();
  CreateLight op{"Lamp", {}};
  op.fields.mesh = MeshReference{"uploaded", nullptr};
  ASSERT_TRUE(session->apply(client, editOf({op})).status.ok());
  ASSERT_TRUE(session->apply(client, editOf({DeleteLight{"Lamp"}})).status.ok());
  session->dropUnusedBlobs();
  EXPECT_NE(session->findBlob("uploaded"), nullptr);
  session->leave(client);
  EXPECT_TRUE(test::eventually([&] {
    session->dropUnusedBlobs();
    return session->summary().blobs == 0;
  }));
}

TEST_F(UndoTest, StepsEndWithTheProcess) {
  apply(a_, {createLight("Lamp")});
  SavedSession state = session_->state();
  Members clients(rig_.services.limits);
  Session back(2, 8, state, rig_.services);
  const ClientIdentity again = *back.join();
  EXPECT_EQ(back.undoRedo(again, 0, UndoDirection::kUndo).status.code(), Code::kFailedPrecondition);
  ASSERT_TRUE(back.apply(again, editOf({setRadiance("Lamp", 2.0)})).status.ok());
  EXPECT_TRUE(back.undoRedo(again, 0, UndoDirection::kUndo).status.ok()) << "objects from before have a past too";
  EXPECT_EQ(back.lights().at(0).object->radiance.x, 1.0);
}

}  // namespace
}  // namespace lpv
