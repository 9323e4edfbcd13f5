// VOLUME_FORMAT_COMPACT: transform, run-level coding, and how far its light is from the truth.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "unit/wire/wire_rig.h"
#include "wire/brick_transform.h"
#include "wire/compact.h"
#include "wire/compression.h"
#include "wire/run_level.h"

namespace lpv::wire {
namespace {

std::vector<std::int32_t> randomCoefficients(int magnitude, double density) {
  std::mt19937 generator(3);
  std::uniform_int_distribution<std::int32_t> value(-magnitude, magnitude);
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  std::vector<std::int32_t> out(kChannels * kBrickCells, 0);
  for (std::int32_t& c : out) c = chance(generator) < density ? value(generator) : 0;
  return out;
}

/// A basis function of result.proto, written from its words: product over the axes, colours by their matrix.
double wordOfProto(std::size_t component, std::size_t u, std::size_t v, std::size_t w, std::size_t colour,
                   std::size_t cell) {
  const int rows[8][8] = {{64, 64, 64, 64, 64, 64, 64, 64},     {89, 75, 50, 18, -18, -50, -75, -89},
                          {83, 36, -36, -83, -83, -36, 36, 83}, {75, -18, -89, -50, 50, 89, 18, -75},
                          {64, -64, -64, 64, 64, -64, -64, 64}, {50, -89, 18, 75, -75, -18, 89, -50},
                          {36, -83, 83, -36, -36, 83, -83, 36}, {18, -50, 75, -89, 89, -75, 50, -18}};
  const int colours[3][3] = {{2, 2, 2}, {2, 0, -2}, {1, -2, 1}};
  return double(colours[component][colour]) * rows[u][cell % 8] * rows[v][cell / 8 % 8] * rows[w][cell / 64];
}

TEST(BrickTransform, ElementsAreTheDocumentedSums) {
  std::vector<std::int32_t> coefficients(kChannels * kBrickCells, 0);
  Coefficients<std::int16_t> elements;
  for (const std::size_t at : {std::size_t(0), std::size_t(3 * 64 + 5 * 8 + 7), std::size_t(7 * 64 + 6)}) {
    for (std::size_t component = 0; component < 3; ++component) {
      std::fill(coefficients.begin(), coefficients.end(), 0);
      coefficients[(1 * 3 + component) * kBrickCells + at] = 4321;
      elementsFrom(coefficients.data(), &elements);
      for (std::size_t i = 0; i < 3 * kBrickCells; ++i) {
        const double sum =
            4321.0 * wordOfProto(component, at % 8, at / 8 % 8, at / 64, i / kBrickCells, i % kBrickCells);
        ASSERT_EQ(elements[3 * kBrickCells + i], std::nearbyint(sum / 8388608.0)) << at << " " << component;
      }
    }
  }
}

TEST(BrickTransform, CoefficientsGiveTheElementsBack) {
  std::mt19937 generator(5);
  std::uniform_int_distribution<int> level(0, 30000);
  std::uniform_int_distribution<int> ratio(-2048, 2048);
  Coefficients<double> wanted;
  for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = i < 3 * kBrickCells ? level(generator) : ratio(generator);
  Coefficients<double> coefficients;
  coefficientsFrom(wanted, &coefficients);
  std::vector<std::int32_t> rounded;
  for (const double c : coefficients) rounded.push_back(std::int32_t(std::lround(c)));
  Coefficients<std::int16_t> elements;
  elementsFrom(rounded.data(), &elements);
  for (std::size_t i = 0; i < wanted.size(); ++i) ASSERT_NEAR(elements[i], wanted[i], 6.0) << i;
}

TEST(BrickTransform, ElementsStayInRangeWhateverTheCoefficients) {
  Coefficients<std::int16_t> elements;
  const std::vector<std::int32_t> wild = randomCoefficients(kMaxCoefficient, 1.0);
  elementsFrom(wild.data(), &elements);
  for (std::size_t i = 0; i < elements.size(); ++i) {
    ASSERT_GE(elements[i], i < 3 * kBrickCells ? 0 : -kMaxRatio);
    ASSERT_LE(elements[i], i < 3 * kBrickCells ? kMaxLevel : kMaxRatio);
  }
}

TEST(RunLevel, BlocksComeBackOneAfterTheOther) {
  RunLevels runLevels;
  std::vector<std::vector<std::int32_t>> blocks{randomCoefficients(0, 0.0), randomCoefficients(1, 0.01),
                                                randomCoefficients(kMaxCoefficient, 1.0)};
  blocks.push_back(blocks[1]);
  for (std::int32_t& c : blocks.back()) c *= 64;  // a common step
  blocks.push_back(randomCoefficients(0, 0.0));
  blocks.back()[511] = -1;  // 511 zeros before it
  for (std::size_t i = 0; i < blocks.size(); ++i) EXPECT_EQ(appendBlock(blocks[i].data(), &runLevels), i > 0);
  RunLevelReader reader(runLevels.runs, runLevels.levels);
  for (const std::vector<std::int32_t>& block : blocks) {
    std::vector<std::int32_t> back(block.size(), 0);
    ASSERT_TRUE(reader.addBlock(back.data()).ok());
    EXPECT_EQ(back, block);
  }
  EXPECT_TRUE(reader.atEnd());
}

TEST(Compact, RoundTripIsWithinTheToleranceAtAnyMagnitudeAndSize) {
  for (const glm::ivec3& dims : {glm::ivec3(16), glm::ivec3(13, 9, 5), glm::ivec3(1), glm::ivec3(3, 1, 20)}) {
    for (int toleranceClass = 0; toleranceClass < kToleranceClasses; ++toleranceClass) {
      Volume volume = fieldOf({{{1.0, 1.1, 0.6}}, {{2.0, 0.2, 0.1}, {1.0, 0.0, 0.0}, 0.02, 0.1, 1.0}}, dims);
      for (float& c : volume.layers[0].coefficients) c *= 1e12F;
      Wire wire(Format::kCompact, toleranceClass);
      ASSERT_TRUE(wire.send(volume).ok());
      const double off = furthest(volume, volumeFrom(*wire.held()));
      EXPECT_LE(off, toleranceOf(Format::kCompact, toleranceClass)) << dims.x << " class " << toleranceClass;
    }
  }
}

/// Every coefficient is a quarter of class 0's step from where it rounds to, all to the same side of cell 0: 3 % there.
/// Only finer steps keep the promise.
TEST(Compact, StepsBecomeFinerWhereABrickNeedsIt) {
  std::vector<std::int32_t> coefficients(kChannels * kBrickCells, 0);
  for (std::size_t i = 0; i < 3 * kBrickCells; ++i) {
    const double sign = wordOfProto(i / kBrickCells, i % 8, i / 8 % 8, i % kBrickCells / 64, 0, 0);
    coefficients[i] = sign < 0.0 ? -3 : 3;
  }
  coefficients[0] += 400000;  // light everywhere
  Coefficients<std::int16_t> elements;
  elementsFrom(coefficients.data(), &elements);
  Volume volume = fieldOf({}, glm::ivec3(8));
  for (std::size_t i = 0; i < kBrickCells; ++i) {
    for (std::size_t colour = 0; colour < 3; ++colour) {
      const std::int16_t four[4] = {elements[colour * kBrickCells + i], 0, 0, 0};
      floatsFromCompact(four, 1, 1.0, volume.layers[0].coefficients.data() + i * 12 + colour * 4);
    }
  }
  Wire wire(Format::kCompact, 0);
  ASSERT_TRUE(wire.send(volume).ok());
  EXPECT_LE(furthest(volume, volumeFrom(*wire.held())), toleranceOf(Format::kCompact, 0));
}

TEST(Compact, DarknessIsDarkAndUndefinedLightIsNone) {
  Volume volume = fieldOf({}, glm::ivec3(9));
  Wire dark(Format::kCompact, 0);
  ASSERT_TRUE(dark.send(volume).ok());
  EXPECT_EQ(volumeFrom(*dark.held()).layers[0].coefficients, volume.layers[0].coefficients);
  volume.layers[0].coefficients[0] = std::nanf("");
  volume.layers[0].coefficients[12] = std::numeric_limits<float>::infinity();
  volume.layers[0].coefficients[24] = -3.0F;
  Wire odd(Format::kCompact, 0);
  ASSERT_TRUE(odd.send(volume).ok());
  const Volume finite = volumeFrom(*odd.held());
  for (const float c : finite.layers[0].coefficients) ASSERT_TRUE(std::isfinite(c));
}

TEST(Compact, TheSameVolumesGiveTheSameBytes) {
  const Volume volume = fieldOf({{{1.0, 1.1, 0.6}}}, glm::ivec3(16, 12, 8));
  const VolumeStatePtr a = publish(volume, Format::kCompact, 0, nullptr);
  const VolumeStatePtr b = publish(volume, Format::kCompact, 0, nullptr);
  const EncodedVolume first = encodeVolume(*a, nullptr, Compression::kZstd, kMaxPayloadBytes);
  const EncodedVolume second = encodeVolume(*b, nullptr, Compression::kZstd, kMaxPayloadBytes);
  EXPECT_EQ(first.checksum, second.checksum);
  ASSERT_EQ(first.parts.size(), second.parts.size());
  EXPECT_EQ(first.parts[0].payload, second.parts[0].payload);
}

TEST(Compression, RefusesWhatItShouldNotAllocate) {
  const std::string zeros(1U << 22U, '\0');
  const std::string frame = compress(zeros);
  EXPECT_EQ(decompress(frame, zeros.size()).ok(), true);
  EXPECT_EQ(decompress(frame, zeros.size() - 1).status().code(), Code::kInvalidArgument);
  EXPECT_FALSE(decompress(frame.substr(0, frame.size() - 1), zeros.size()).ok());
  EXPECT_FALSE(decompress(frame + frame, zeros.size()).ok());
  EXPECT_FALSE(decompress("", 100).ok());
  EXPECT_FALSE(decompress("no frame at all", 100).ok());
  // Magic, a descriptor without content size, window, then an empty last raw block.
  EXPECT_FALSE(decompress(std::string("\x28\xb5\x2f\xfd\x00\x58\x01\x00\x00", 9), 100).ok());
}

}  // namespace
}  // namespace lpv::wire
