// The volume codec: what one side encodes the other decodes, and nothing malformed gets through.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "unit/wire/wire_rig.h"
#include "wire/half.h"

namespace lpv::wire {
namespace {

EncodedVolume encode(const Volume& volume, Format format, std::size_t maxPayload) {
  return encodeVolume(*publish(volume, format, 0, nullptr), nullptr, Compression::kNone, maxPayload);
}

Expected<Volume> roundTrip(const Volume& volume, Format format, Compression compression, std::size_t maxPayload) {
  const VolumeStatePtr state = publish(volume, format, 0, nullptr);
  const Expected<VolumeStatePtr> back = decode(*state, encodeVolume(*state, nullptr, compression, maxPayload), nullptr);
  if (!back) return back.status();
  return volumeFrom(**back);
}

TEST(Half, EveryHalfSurvives) {
  std::vector<std::uint16_t> halves(65536);
  for (std::size_t i = 0; i < halves.size(); ++i) halves[i] = std::uint16_t(i);
  std::vector<float> floats(halves.size());
  std::vector<std::uint16_t> back(halves.size());
  floatsFromHalves(halves.data(), halves.size(), 1.0F, floats.data());
  halvesFromFloats(floats.data(), floats.size(), 1.0F, back.data());
  for (std::size_t i = 0; i < halves.size(); ++i) {
    const bool isNan = (i & 0x7c00U) == 0x7c00U && (i & 0x3ffU) != 0;
    if (isNan) {
      EXPECT_TRUE(std::isnan(floats[i])) << i;
      EXPECT_GT(back[i] & 0x7fffU, 0x7c00U) << i;
    } else {
      EXPECT_EQ(back[i], halves[i]) << i;
    }
  }
  EXPECT_EQ(floats[0x3c00], 1.0F);
  EXPECT_EQ(floats[0x7bff], kMaxHalf);
  EXPECT_EQ(floats[1], std::ldexp(1.0F, -24));
}

TEST(Half, RoundsToNearestTiesToEven) {
  const auto half = [](float value) {
    std::uint16_t out = 0;
    halvesFromFloats(&value, 1, 1.0F, &out);
    return out;
  };
  EXPECT_EQ(half(1.0F + std::ldexp(1.0F, -11)), 0x3c00);         // tie, even below
  EXPECT_EQ(half(1.0F + 3.0F * std::ldexp(1.0F, -11)), 0x3c02);  // tie, even above
  EXPECT_EQ(half(std::ldexp(1.0F, -25)), 0);                     // tie of the smallest subnormal
  EXPECT_EQ(half(std::ldexp(1.5F, -25)), 1);
  EXPECT_EQ(half(65519.0F), 0x7bff);
  EXPECT_EQ(half(65520.0F), 0x7c00);
  EXPECT_EQ(half(-std::numeric_limits<float>::infinity()), 0xfc00);
}

TEST(VolumeCodec, FloatIsExact) {
  const Volume volume = randomVolume({19, 8, 5}, 3, 1e6F);
  const Expected<Volume> back = roundTrip(volume, Format::kFloat, Compression::kNone, 4096);
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_EQ(back->grid, volume.grid);
  ASSERT_EQ(back->layers.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(back->layers[i].group, volume.layers[i].group);
    EXPECT_EQ(back->layers[i].coefficients, volume.layers[i].coefficients);
  }
}

TEST(VolumeCodec, HalfIsWithinHalfAUnitAtAnyMagnitude) {
  for (const float magnitude : {1e-20F, 1e-3F, 1.0F, 1e9F, 1e35F}) {
    const Volume volume = randomVolume({9, 9, 9}, 1, magnitude);
    const Expected<Volume> back = roundTrip(volume, Format::kHalf, Compression::kZstd, 1U << 20U);
    ASSERT_TRUE(back.ok()) << back.status().message();
    for (std::size_t i = 0; i < volume.layers[0].coefficients.size(); ++i) {
      const float value = volume.layers[0].coefficients[i];
      EXPECT_NEAR(back->layers[0].coefficients[i], value, std::abs(value) * 0x1p-11 + magnitude * 0x1p-30);
    }
  }
}

TEST(VolumeCodec, ScalesArePowersOfTwoAndKeepMagnitudesBelow1024) {
  Volume volume = randomVolume({2, 1, 1}, 2, 1.0F);
  volume.layers[0].coefficients.assign(24, 0.0F);
  volume.layers[1].coefficients[5] = -4096.0F;
  const EncodedVolume encoded = encode(volume, Format::kHalf, 1U << 20U);
  EXPECT_THAT(encoded.scales, testing::ElementsAre(1.0, 4.0));
}

TEST(VolumeCodec, PartsStayBelowTheLimitAndCoverEveryBrickOnce) {
  const Volume volume = randomVolume({33, 17, 20}, 2, 1.0F);
  const std::size_t limit = 200000;
  const EncodedVolume encoded = encode(volume, Format::kHalf, limit);
  int next = 0;
  std::size_t bytes = 0;
  for (const Part& part : encoded.parts) {
    EXPECT_LE(part.payload.size(), limit);
    ASSERT_EQ(part.bricks.size(), 1U);
    EXPECT_EQ(part.bricks[0].first, next);
    next += part.bricks[0].count;
    bytes += part.payload.size();
  }
  EXPECT_EQ(next, brickCount(volume.grid.dims));
  EXPECT_EQ(next, 5 * 3 * 3);
  EXPECT_EQ(bytes, volume.grid.cells() * 12 * 2 * 2);
}

TEST(VolumeCodec, PayloadAndChecksumFollowTheDocumentedOrder) {
  const Volume volume = randomVolume({9, 2, 1}, 2, 1.0F);
  const EncodedVolume encoded = encode(volume, Format::kFloat, 1U << 20U);
  std::vector<float> payload(encoded.parts.at(0).payload.size() / 4);
  std::memcpy(payload.data(), encoded.parts[0].payload.data(), payload.size() * 4);
  std::size_t at = 0;
  for (const auto& [x0, x1] : {std::pair(0, 8), std::pair(8, 9)}) {
    for (const VolumeLayer& layer : volume.layers) {
      for (int y = 0; y < 2; ++y) {
        for (int i = x0 * 12; i < x1 * 12; ++i) {
          ASSERT_EQ(payload[at++], layer.coefficients[std::size_t(y * 9 * 12 + i)]);
        }
      }
    }
  }
  std::string all;
  for (const VolumeLayer& layer : volume.layers) {
    all.append(reinterpret_cast<const char*>(layer.coefficients.data()), layer.coefficients.size() * 4);
  }
  EXPECT_EQ(encoded.checksum, checksumBytes(all.data(), all.size()));
  EXPECT_EQ(checksumBytes("", 0), 0xef46db3751d8e999ULL);  // XXH64 of nothing, seed 0
}

class VolumeDecoderRefuses : public testing::Test {
 protected:
  VolumeStatePtr state_ = publish(randomVolume({16, 8, 8}, 1, 1.0F), Format::kHalf, 0, nullptr);
  EncodedVolume encoded_ = encodeVolume(*state_, nullptr, Compression::kNone, 1U << 20U);
  const std::string& payload() const { return encoded_.parts[0].payload; }
  Code codeOf(const std::vector<BrickRun>& runs, const std::string& bytes) const {
    return VolumeDecoder(state_->shape, Compression::kNone).add(runs, bytes).code();
  }
};

TEST_F(VolumeDecoderRefuses, BricksOutOfRangeOrTwice) {
  for (const BrickRun run : {BrickRun{-1, 1}, BrickRun{0, 3}, BrickRun{2, 1}, BrickRun{0, 0}, BrickRun{1, -1},
                             BrickRun{1, std::numeric_limits<int>::max()}}) {
    EXPECT_EQ(codeOf({run}, payload()), Code::kInvalidArgument) << run.first << " " << run.count;
  }
  EXPECT_EQ(codeOf({{0, 1}, {0, 1}}, payload()), Code::kInvalidArgument);
  EXPECT_EQ(codeOf({{0, 2}}, payload()), Code::kOk);
  VolumeDecoder decoder(state_->shape, Compression::kNone);
  EXPECT_TRUE(decoder.add({{0, 2}}, payload()).ok());
  EXPECT_EQ(decoder.add({{0, 2}}, payload()).code(), Code::kInvalidArgument);
  EXPECT_FALSE(decoder.finish(encoded_.checksum).ok());
}

TEST_F(VolumeDecoderRefuses, PayloadsOfAnotherSize) {
  EXPECT_EQ(codeOf({{0, 2}}, payload().substr(1)), Code::kInvalidArgument);
  EXPECT_EQ(codeOf({{0, 2}}, payload() + "x"), Code::kInvalidArgument);
  EXPECT_EQ(codeOf({{0, 2}}, ""), Code::kInvalidArgument);
  EXPECT_EQ(codeOf({}, "x"), Code::kInvalidArgument);
}

TEST_F(VolumeDecoderRefuses, IncompleteAndDamagedVolumes) {
  VolumeDecoder incomplete(state_->shape, Compression::kNone);
  ASSERT_TRUE(incomplete.add({{1, 1}}, payload().substr(payload().size() / 2)).ok());
  EXPECT_EQ(incomplete.finish(encoded_.checksum).status().field(), "result.checksum");
  std::string damaged = payload();
  damaged[100] = char(damaged[100] ^ 1);
  VolumeDecoder decoder(state_->shape, Compression::kNone);
  ASSERT_TRUE(decoder.add({{0, 2}}, damaged).ok());
  EXPECT_EQ(decoder.finish(encoded_.checksum).status().field(), "result.checksum");
}

TEST_F(VolumeDecoderRefuses, ImpossibleHeaders) {
  const auto refused = [&](const Grid& grid, std::vector<std::string> groups, std::vector<double> scales) {
    const VolumeShape shape{Format::kHalf, grid, VolumeStage::kTransported, std::move(groups), std::move(scales)};
    VolumeDecoder decoder(shape, Compression::kNone);
    return !decoder.add({{0, 1}}, payload()).ok() && !decoder.finish(0).ok();
  };
  Grid grid = state_->shape.grid;
  EXPECT_TRUE(refused(grid, {}, {}));
  EXPECT_TRUE(refused(grid, {"a"}, {1.0, 1.0}));
  EXPECT_TRUE(refused(grid, std::vector<std::string>(9), std::vector<double>(9, 1.0)));
  EXPECT_TRUE(refused(grid, {"a"}, {0.0}));
  EXPECT_TRUE(refused(grid, {"a"}, {std::nan("")}));
  grid.dims.y = 129;
  EXPECT_TRUE(refused(grid, {"a"}, {1.0}));
  grid.dims.y = 0;
  EXPECT_TRUE(refused(grid, {"a"}, {1.0}));
  grid = state_->shape.grid;
  grid.cell = std::nan("");
  EXPECT_TRUE(refused(grid, {"a"}, {1.0}));
}

TEST_F(VolumeDecoderRefuses, ASecondTake) {
  VolumeDecoder decoder(state_->shape, Compression::kNone);
  ASSERT_TRUE(decoder.add(encoded_.parts[0].bricks, payload()).ok());
  EXPECT_TRUE(decoder.finish(encoded_.checksum).ok());
  EXPECT_EQ(decoder.finish(encoded_.checksum).status().code(), Code::kFailedPrecondition);
}

}  // namespace
}  // namespace lpv::wire
