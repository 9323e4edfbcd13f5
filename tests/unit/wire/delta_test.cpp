// Results relative to others: every reader ends up with the same bits, nothing drifts away, nothing is sent for
 // nothing.

#include <gtest/gtest.h>

#include "unit/wire/wire_rig.h"

namespace lpv::wire {
namespace {

constexpr Format kFormats[] = {Format::kHalf, Format::kFloat, Format::kCompact};

/// A lamp at cell `x` of a row, and one that stands still.
Volume lampAt(double x, const glm::ivec3& dims = {18, 9, 10}) {
  return fieldOf({{{0.25 * x, 1.02, 1.1}, {0.0, 0.6, 0.8}}, {{3.9, 0.4, 1.8}, {1.0, 0.0, 0.0}, 0.1, 0.2, 1.0}}, dims);
}

/// Broken on purpose: published relative to what each reader holds, and not once for all, COMPACT's checksums differ.
TEST(Delta, ReadersOfAnySpeedHoldTheSame) {
  for (const Format format : kFormats) {
    for (int toleranceClass = 0; toleranceClass < kToleranceClasses; ++toleranceClass) {
      Wire every(format, toleranceClass);
      Wire third(format, toleranceClass);
      Wire late(format, toleranceClass);
      for (int i = 0; i <= 12; ++i) {
        const Volume volume = lampAt(4.0 + 0.25 * i);
        ASSERT_TRUE(every.send(volume).ok());
        EXPECT_EQ(every.wasDelta(), i > 0);
        if (i % 3 == 0) {
          ASSERT_TRUE(third.send(volume).ok());
        } else {
          third.skip(volume);
        }
        if (i < 12) late.skip(volume);
      }
      ASSERT_TRUE(late.send(lampAt(7.0)).ok());
      EXPECT_FALSE(late.wasDelta());
      EXPECT_TRUE(third.wasDelta());
      EXPECT_EQ(checksumOf(*every.held()), checksumOf(*every.published()));
      EXPECT_EQ(checksumOf(*every.held()), checksumOf(*third.held()));
      EXPECT_EQ(checksumOf(*every.held()), checksumOf(*late.held()));
      EXPECT_LE(furthest(lampAt(7.0), volumeFrom(*every.held())), std::max(1e-3, toleranceOf(format, toleranceClass)));
    }
  }
}

/// Broken on purpose: a brick that may be twice as far off before it is sent shows here.
TEST(Delta, LightThatCreepsNeverGetsBeyondTheTolerance) {
  const Format formats[] = {Format::kHalf, Format::kCompact, Format::kCompact};
  const int classes[] = {1, 0, 2};
  for (std::size_t kind = 0; kind < 3; ++kind) {
    Wire wire(formats[kind], classes[kind]);
    const double tolerance = toleranceOf(formats[kind], classes[kind]);
    std::size_t quiet = 0;
    for (int tick = 0; tick < 2000; ++tick) {
      const Volume volume = lampAt(2.0 + 0.01 * (tick % 800), {12, 7, 6});
      ASSERT_TRUE(wire.send(volume).ok());
      quiet += wire.bytes() == 0 ? 1 : 0;
      if (tick % 10 == 0) {
        ASSERT_LE(furthest(volume, volumeFrom(*wire.held())), tolerance) << "tick " << tick;
      }
    }
    EXPECT_EQ(quiet > 0, classes[kind] > 0);
  }
}

TEST(Delta, NothingNewIsNothing) {
  for (const Format format : kFormats) {
    Wire wire(format, 0);
    ASSERT_TRUE(wire.send(lampAt(5.0)).ok());
    EXPECT_GT(wire.bytes(), 1000U);
    ASSERT_TRUE(wire.send(lampAt(5.0)).ok());
    EXPECT_TRUE(wire.wasDelta());
    EXPECT_EQ(wire.bytes(), 0U);
  }
}

TEST(Delta, OnlyBricksThatChangedAreSent) {
  Volume volume = lampAt(5.0, {24, 8, 8});
  for (const Format format : kFormats) {
    const VolumeStatePtr before = publish(volume, format, 0, nullptr);
    Volume after = volume;
    for (int colour = 0; colour < 3; ++colour) {
      after.layers[0].coefficients[after.grid.index({9, 3, 3}) * 12 + std::size_t(colour) * 4] *= 1.2F;
    }
    const VolumeStatePtr now = publish(after, format, 0, before.get());
    const EncodedVolume encoded = encodeVolume(*now, before.get(), Compression::kZstd, kMaxPayloadBytes);
    ASSERT_EQ(encoded.parts.size(), 1U);
    ASSERT_EQ(encoded.parts[0].bricks.size(), 1U);
    EXPECT_EQ(encoded.parts[0].bricks[0].first, 1);
    EXPECT_EQ(encoded.parts[0].bricks[0].count, 1);
    EXPECT_EQ(now->bricks[0], before->bricks[0]);
  }
}

TEST(Delta, AnotherGridLayersOrScaleIsAKeyFrame) {
  for (const Format format : {Format::kHalf, Format::kCompact}) {
    Wire wire(format, 0);
    ASSERT_TRUE(wire.send(lampAt(5.0)).ok());
    Volume brighter = lampAt(5.0);
    for (float& c : brighter.layers[0].coefficients) c *= 2.0F;
    ASSERT_TRUE(wire.send(brighter).ok());
    EXPECT_TRUE(wire.wasDelta());  // scales stay while they will do
    for (float& c : brighter.layers[0].coefficients) c *= 64.0F;
    ASSERT_TRUE(wire.send(brighter).ok());
    EXPECT_FALSE(wire.wasDelta());
    brighter.grid.origin.x += 1.0;
    ASSERT_TRUE(wire.send(brighter).ok());
    EXPECT_FALSE(wire.wasDelta());
    brighter.layers.push_back(brighter.layers[0]);
    brighter.layers[1].group = "second";
    ASSERT_TRUE(wire.send(brighter).ok());
    EXPECT_FALSE(wire.wasDelta());
    EXPECT_LE(furthest(brighter, volumeFrom(*wire.held())), 0.01);
  }
}

TEST(Delta, ARegionIsItsBricksAndNothingElse) {
  const glm::ivec3 dims(24, 16, 8);
  const std::vector<bool> chosen = bricksWithin(lampAt(5.0, dims).grid, {{0.1, 0.1, 0.1}, {1.7, 1.7, 1.7}});
  EXPECT_EQ(std::vector<bool>(chosen), (std::vector<bool>{true, false, false, false, false, false}));
  VolumeStatePtr published;
  VolumeStatePtr held;
  VolumeState before;
  for (int i = 0; i < 4; ++i) {
    published = publish(lampAt(3.0 + i, dims), Format::kCompact, 0, published.get());
    const VolumeState target = onlyBricks(*published, chosen);
    const EncodedVolume encoded = encodeVolume(target, i > 0 ? &before : nullptr, Compression::kZstd, kMaxPayloadBytes);
    ASSERT_EQ(encoded.parts.size(), 1U);
    ASSERT_EQ(encoded.parts[0].bricks.size(), 1U);
    EXPECT_EQ(encoded.parts[0].bricks[0].count, 1);
    const Expected<VolumeStatePtr> state = decode(target, encoded, held);
    ASSERT_TRUE(state.ok()) << state.status().message();
    held = *state;
    before = target;
  }
  const Volume whole = volumeFrom(*published);
  const Volume part = volumeFrom(*held);
  const auto at = [&](const Volume& v, const glm::ivec3& cell) { return Volume::at(v.layers[0], v.grid, cell, 1); };
  EXPECT_EQ(at(part, {7, 7, 7}), at(whole, {7, 7, 7}));
  EXPECT_EQ(at(part, {8, 7, 7}), sh::Coefficients(0.0));
}

TEST(Delta, ARegionReadsHalfACellBeyondItself) {
  const Grid grid{{0.0, 0.0, 0.0}, 1.0, {16, 8, 8}};
  using Chosen = std::vector<bool>;
  EXPECT_EQ(bricksWithin(grid, {{1.0, 1.0, 1.0}, {7.4, 2.0, 2.0}}), (Chosen{true, false}));
  EXPECT_EQ(bricksWithin(grid, {{1.0, 1.0, 1.0}, {7.6, 2.0, 2.0}}), (Chosen{true, true}));
  EXPECT_EQ(bricksWithin(grid, {{8.6, 1.0, 1.0}, {9.0, 2.0, 2.0}}), (Chosen{false, true}));
  EXPECT_EQ(bricksWithin(grid, {{20.0, 1.0, 1.0}, {30.0, 2.0, 2.0}}), (Chosen{false, false}));
}

}  // namespace
}  // namespace lpv::wire
