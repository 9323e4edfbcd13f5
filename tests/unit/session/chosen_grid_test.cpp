// The number of cells where it is left to the server: chosen by the scene when a grid is fitted, and then only.
#include <gtest/gtest.h>

#include "session/document/document.h"
#include "unit/session/session_rig.h"

namespace lpv {
namespace {

using test::createLight;
using test::createSurface;
using test::editOf;
using test::moveLight;
using test::setRadiance;

/// A scene's grid where the number of cells is left to the server, edit by edit.
class ChosenGridTest : public testing::Test {
 protected:
  static LightingSettings automatic(double maxError) {
    LightingSettings options;
    options.grid.automatic = true;
    options.maxError = maxError;
    return options;
  }
  Grid after(std::vector<Operation> operations) {
    const auto names = chosen_.apply(editOf(std::move(operations)), blobs_);
    EXPECT_TRUE(names.ok()) << names.status().message();
    return chosen_.grid();
  }
  /// One metre, facing down, 2 m over a floor of 8 m.
  static CreateLight lampAt(const glm::dvec3& at) {
    CreateLight out = std::get<CreateLight>(createLight("Lamp"));
    out.fields.transform.rotation = rotationFromEulerDegrees({90, 0, 0});
    out.fields.transform.translation = at;
    return out;
  }
  static CreateSurface floor() {
    CreateSurface out = std::get<CreateSurface>(createSurface("Floor"));
    out.fields.transform.rotation = rotationFromEulerDegrees({-90, 0, 0});
    out.fields.transform.scale = glm::dvec3(8.0);
    return out;
  }

  Limits limits_;
  Blobs blobs_{limits_};
  Document chosen_{automatic(0.01), limits_, test::nameOfContent};
};

// Broken by: a choice before the light is there that stands; a choice when a light moves.
TEST_F(ChosenGridTest, FollowsTheFirstLightAndNothingThatMoves) {
  CreateSurface ceiling = floor();
  ceiling.fields.transform.rotation = rotationFromEulerDegrees({90, 0, 0});
  ceiling.fields.transform.translation = glm::dvec3(0, 4, 0);
  EXPECT_EQ(after({floor(), ceiling}).dims.x, 16);
  const Grid made = after({lampAt({0, 2, 0})});
  EXPECT_GT(made.dims.x, 16) << "though it is inside";
  EXPECT_EQ(after({moveLight("Lamp", {0, 0.5, 0})}), made);
  EXPECT_EQ(after({moveLight("Lamp", {0, 9.0, 0})}), made);
  EXPECT_EQ(after({setRadiance("Lamp", 9.0)}), made);
  EXPECT_EQ(after({moveLight("Lamp", {0, 2, 0})}), made);
  EXPECT_EQ(after({FitGrid{}}), made);
  Document other(automatic(0.01), limits_, test::nameOfContent);
  ASSERT_TRUE(other.apply(editOf({lampAt({0, 2, 0}), floor(), ceiling}), blobs_).ok());
  EXPECT_EQ(other.grid(), made) << "the same scene";
}

// Broken by: settings that choose otherwise and change nothing; ones that choose the same and move the grid.
TEST_F(ChosenGridTest, FollowsTheSettings) {
  const Grid made = after({lampAt({0, 2, 0}), floor()});
  EXPECT_TRUE(chosen_.setOptions(automatic(0.03)).ok());
  EXPECT_EQ(chosen_.grid().dims.x, 16);
  EXPECT_TRUE(chosen_.setOptions(automatic(0.01)).ok());
  EXPECT_EQ(chosen_.grid(), made);
  after({moveLight("Lamp", {0, 2.2, 0})});
  LightingSettings accurate = automatic(0.01);
  accurate.k = 3.0;
  EXPECT_TRUE(chosen_.setOptions(accurate).ok());
  EXPECT_EQ(chosen_.grid(), made);
}

// Broken by: bounds that keep the number of cells from the scene.
TEST_F(ChosenGridTest, FollowsTheSceneWithinGivenBoundsToo) {
  LightingSettings options = automatic(0.01);
  options.grid.hasBounds = true;
  options.grid.bounds = {glm::dvec3(-5.0), glm::dvec3(5.0)};
  ASSERT_TRUE(chosen_.setOptions(options).ok());
  EXPECT_EQ(chosen_.grid().dims.x, 16);
  EXPECT_GT(after({lampAt({0, 2, 0}), floor()}).dims.x, 16);
  const Grid made = chosen_.grid();
  EXPECT_EQ(after({moveLight("Lamp", {0, 4, 0})}), made);
  EXPECT_EQ(after({FitGrid{}}).bounds(), options.grid.bounds);
}

class CorrectedGridTest : public ChosenGridTest {
 protected:
  /// A measurement of the document as it is.
  void measure(double error, double low) {
    chosen_.noteMeasured(MeasuredError{error, low, 2.0 * error - low, chosen_.revision()});
  }
  Grid moved(double height) { return after({moveLight("Lamp", {0, height, 0})}); }

  Grid made_ = after({lampAt({0, 2, 0}), floor()});
};

// Broken by: a measurement that changes nothing; more than one correction for one content; one after the next content
// that is taken from before it.
TEST_F(CorrectedGridTest, MoreCellsWhereTheMeasuredErrorIsTooLarge) {
  measure(0.02, 0.015);
  const Grid corrected = moved(2.01);
  EXPECT_GT(corrected.dims.x, made_.dims.x);
  ASSERT_TRUE(chosen_.lastChange().grid.has_value()) << "whoever watches is told, with the revision";
  EXPECT_EQ(*chosen_.lastChange().grid, corrected);
  ASSERT_TRUE(chosen_.correction().has_value());
  EXPECT_EQ(chosen_.correction()->missed, made_.dims.x);
  EXPECT_EQ(chosen_.correction()->error, 0.02);
  EXPECT_EQ(chosen_.correction()->least, corrected.dims.x);
  measure(0.02, 0.015);
  EXPECT_EQ(moved(2.02), corrected) << "once for one content";
  CreateSurface other = floor();
  other.name = "Other";
  EXPECT_EQ(after({other}).dims.x, corrected.dims.x);
  EXPECT_EQ(moved(2.03).dims.x, corrected.dims.x) << "that was measured before the content changed";
  measure(0.02, 0.015);
  EXPECT_GT(moved(2.04).dims.x, corrected.dims.x);
}

// Broken by: fewer cells where a measurement is good; a fit that forgets the correction; settings that do not.
TEST_F(CorrectedGridTest, DoesNotGoBackAndForth) {
  measure(0.02, 0.015);
  const int corrected = moved(2.01).dims.x;
  measure(0.0001, 0.00005);
  EXPECT_EQ(moved(2.02).dims.x, corrected);
  EXPECT_EQ(after({FitGrid{}}).dims.x, corrected);
  measure(0.0001, 0.00005);
  EXPECT_EQ(moved(2.0).dims.x, corrected);
  EXPECT_TRUE(chosen_.setOptions(automatic(0.03)).ok());
  EXPECT_EQ(chosen_.grid().dims.x, 16);
  EXPECT_FALSE(chosen_.correction().has_value());
}

// Broken by: the error alone, whatever its interval; a measurement of another grid; cells that a client asked for.
TEST_F(CorrectedGridTest, StandsWhereNothingIsKnownToBeWrong) {
  measure(0.02, 0.009);
  EXPECT_EQ(moved(2.01), made_) << "the interval holds what is wanted";
  chosen_.noteMeasured(MeasuredError{0.02, 0.015, 0.025, 0});
  EXPECT_EQ(moved(2.02), made_) << "from before the grid was there";
  LightingSettings given = automatic(0.01);
  given.grid.automatic = false;
  given.grid.longest = 16;
  ASSERT_TRUE(chosen_.setOptions(given).ok());
  measure(0.02, 0.015);
  EXPECT_EQ(moved(2.03).dims.x, 16);
}

// Broken by: a correction that makes an edit too dear, and the edit refused.
TEST_F(CorrectedGridTest, IsLeftOutWhereItCostsTooMuch) {
  chosen_.predictWith([this](const Workload& work) {
    Prediction tick;
    tick.seconds = work.cells > double(made_.cells()) ? 2.0 * limits_.maxTickSeconds : 0.0;
    return tick;
  });
  measure(0.02, 0.015);
  EXPECT_EQ(moved(2.01), made_);
}

}  // namespace
}  // namespace lpv
