// Histories made by hand: a good one passes, and each way of breaking the service's word is found and called by its
// name.

#include "rpc/durability/faults/checker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

namespace lpv::rpc::faults {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;

constexpr std::uint64_t kEpoch = 100;

Attempt accepted(EditId id, std::uint64_t revision, Moment began, std::uint64_t removes = 0) {
  return {id, removes, began, began + 1, Outcome::kAccepted, revision, nameOf(id), ""};
}

Attempt unknown(EditId id, Moment began) { return {id, 0, began, began + 1, Outcome::kUnknown, 0, "", "no answer"}; }

Read seen(const std::string& reader, std::uint64_t epoch, std::uint64_t revision) {
  Read read;
  read.reader = reader;
  read.epoch = epoch;
  read.revision = revision;
  read.digest = 1000 * epoch + revision;
  return read;
}

Read change(const std::string& reader, std::uint64_t epoch, std::uint64_t revision, std::uint64_t follows) {
  Read read = seen(reader, epoch, revision);
  read.follows = follows;
  return read;
}

/// Revision 1 made the lamp; then writer 1 made 2, writer 2 made 3 (after a restart, at its second try), writer 1 made
/// 4 without ever being told, and 5, which deleted the scratch light of 2. Writer 2's second edit never happened.
History good() {
  History out;
  out.firstRevision = 1;
  out.firstObjects = {"lamp"};
  out.attempts = {accepted({1, 1}, 2, 10),    unknown({2, 1}, 20), accepted({2, 1}, 3, 30), unknown({1, 2}, 40),
                  accepted({1, 3}, 5, 50, 1), unknown({2, 2}, 60), accepted({1, 1}, 2, 70)};
  out.truth.epoch = kEpoch + 1;
  out.truth.revision = 5;
  out.truth.last = "w1-3";
  out.truth.objects = {{"lamp", {5, 50}}, {"w1-1", {2, 20}},         {"w2-1", {3, 30}}, {"w2-1-scratch", {3, 31}},
                       {"w1-2", {4, 40}}, {"w1-2-scratch", {4, 41}}, {"w1-3", {5, 51}}, {"w1-3-scratch", {5, 52}}};
  out.reads = {seen("a", kEpoch, 1),     change("a", kEpoch, 2, 1),     seen("b", kEpoch, 2),
               seen("a", kEpoch + 1, 3), change("a", kEpoch + 1, 5, 3), seen("b", kEpoch + 1, 5)};
  out.reads[3].asked = 35;
  out.reads[5].asked = 80;
  out.mirrors = {{"a", out.truth}, {"b", out.truth}};
  return out;
}

std::vector<Fault> faultsOf(const std::function<void(History&)>& spoil) {
  History history = good();
  spoil(history);
  std::vector<Fault> out;
  for (const Violation& violation : check(history)) out.push_back(violation.fault);
  return out;
}

/// What the final state says as well as the mirrors: a fault of the server, not of a reader.
void everywhere(History& history, const std::function<void(SceneState&)>& spoil) {
  spoil(history.truth);
  for (Mirror& mirror : history.mirrors) spoil(mirror.scene);
}

TEST(Checker, PassesAGoodHistory) {
  const std::vector<Violation> found = check(good());
  EXPECT_THAT(found, IsEmpty()) << describe(found);
}

TEST(Checker, AnUnknownEditMayHaveHappenedOrNot) {
  const auto didNot = [](SceneState& scene) {
    scene.objects.erase("w1-2");
    scene.objects.erase("w1-2-scratch");
    scene.revision = 4;
    for (const char* name : {"lamp", "w1-3", "w1-3-scratch"}) scene.objects.at(name).revision = 4;
  };
  const std::vector<Fault> faults = faultsOf([&](History& history) {
    everywhere(history, didNot);
    history.attempts[4].revision = 4;
    history.reads[4].revision = history.reads[5].revision = 4;
    history.reads[4].digest = history.reads[5].digest = 7;
  });
  EXPECT_THAT(faults, IsEmpty());
}

TEST(Checker, FindsALostEdit) {
  EXPECT_THAT(faultsOf([](History& history) {
                everywhere(history, [](SceneState& scene) {
                  scene.objects.erase("w2-1");
                  scene.objects.erase("w2-1-scratch");
                });
              }),
              Contains(Fault::kLost));
}

TEST(Checker, FindsAnEditDoneTwice) {
  EXPECT_THAT(faultsOf([](History& history) {
                everywhere(history, [](SceneState& scene) { scene.objects["w1-2.001"] = {5, 9}; });
              }),
              Contains(Fault::kTwice));
  EXPECT_THAT(faultsOf([](History& history) { history.attempts[2].name = "w2-1.001"; }), Contains(Fault::kTwice));
  EXPECT_THAT(faultsOf([](History& history) { everywhere(history, [](SceneState& scene) { scene.revision = 6; }); }),
              Contains(Fault::kTwice))
      << "a revision more than there are edits";
}

TEST(Checker, FindsAnotherOutcomeThanTheFirst) {
  EXPECT_THAT(faultsOf([](History& history) { history.attempts[6].revision = 4; }), Contains(Fault::kOutcomeChanged));
  EXPECT_THAT(faultsOf([](History& history) { history.attempts[1].outcome = Outcome::kRefused; }),
              Contains(Fault::kOutcomeChanged));
  EXPECT_THAT(faultsOf([](History& history) {
                everywhere(history, [](SceneState& scene) { scene.objects.at("w2-1").revision = 6; });
              }),
              Contains(Fault::kOutcomeChanged));
}

TEST(Checker, FindsARefusedEditThatWasDone) {
  EXPECT_THAT(faultsOf([](History& history) { history.attempts[3].outcome = Outcome::kRefused; }),
              Contains(Fault::kRefusedButDone));
}

TEST(Checker, FindsAnEditDoneInPart) {
  const auto without = [](const char* name) {
    return faultsOf(
        [name](History& history) { everywhere(history, [name](SceneState& scene) { scene.objects.erase(name); }); });
  };
  EXPECT_THAT(without("w2-1-scratch"), Contains(Fault::kInPart)) << "not created";
  EXPECT_THAT(without("w1-2"), Contains(Fault::kInPart)) << "only the scratch light";
  EXPECT_THAT(faultsOf([](History& history) {
                everywhere(history, [](SceneState& scene) { scene.objects["w1-1-scratch"] = {2, 21}; });
              }),
              Contains(Fault::kInPart))
      << "not deleted";
  EXPECT_THAT(faultsOf([](History& history) { everywhere(history, [](SceneState& scene) { scene.last = "w1-2"; }); }),
              Contains(Fault::kInPart))
      << "the lamp kept its colour";
  EXPECT_THAT(faultsOf([](History& history) { history.reads[1].whole = false; }), Contains(Fault::kInPart));
}

TEST(Checker, FindsAnEditOutOfOrder) {
  EXPECT_THAT(faultsOf([](History& history) { history.attempts[4].began = 5; }), IsEmpty())
      << "sent before the others were acknowledged, it may be after them";
  EXPECT_THAT(faultsOf([](History& history) {
                for (const std::size_t i : {1U, 2U}) {
                  history.attempts[i].began += 100;
                  history.attempts[i].ended += 100;
                }
              }),
              Contains(Fault::kOutOfOrder))
      << "sent after 5 was acknowledged, it is 3";
  EXPECT_THAT(faultsOf([](History& history) {
                everywhere(history, [](SceneState& scene) { scene.objects.at("w1-2").revision = 3; });
              }),
              Contains(Fault::kOutOfOrder))
      << "two edits of one revision";
}

TEST(Checker, FindsAReaderThatGoesBack) {
  EXPECT_THAT(faultsOf([](History& history) { history.reads[3] = seen("a", kEpoch, 1); }), Contains(Fault::kBackwards));
  EXPECT_THAT(faultsOf([](History& history) { history.reads[4] = seen("a", kEpoch + 1, 2); }),
              Contains(Fault::kBackwards));
}

TEST(Checker, FindsAGap) {
  EXPECT_THAT(faultsOf([](History& history) { history.reads[4].follows = 4; }), Contains(Fault::kGap));
  EXPECT_THAT(faultsOf([](History& history) { history.reads[3].follows = 2; }), Contains(Fault::kGap))
      << "a change where another epoch asks for a snapshot";
}

TEST(Checker, FindsAReaderThatIsShownTheOld) {
  EXPECT_THAT(faultsOf([](History& history) { history.reads[5].revision = 4; }), Contains(Fault::kStale));
}

TEST(Checker, FindsMirrorsThatDiffer) {
  EXPECT_THAT(faultsOf([](History& history) { history.reads[2].digest = 7; }), Contains(Fault::kMirrorsDiffer));
  EXPECT_THAT(faultsOf([](History& history) { history.mirrors[1].scene.objects.at("lamp").hash = 7; }),
              Contains(Fault::kMirrorsDiffer));
  EXPECT_THAT(faultsOf([](History& history) { history.mirrors[0].scene.objects.erase("w1-1"); }),
              Contains(Fault::kMirrorsDiffer));
  EXPECT_THAT(faultsOf([](History& history) { history.mirrors[0].scene.revision = 4; }),
              Contains(Fault::kMirrorsDiffer));
}

}  // namespace
}  // namespace lpv::rpc::faults
