// Payloads that no server of ours would send: the worst is an error.

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "unit/wire/wire_rig.h"
#include "wire/brick_transform.h"
#include "wire/compression.h"

namespace lpv::wire {
namespace {

struct Sample {
  VolumeStatePtr state;
  EncodedVolume encoded;
};

Sample sample(Format format, Compression compression) {
  Sample out;
  out.state = publish(fieldOf({{{1.0, 1.1, 0.6}}}, {11, 8, 9}), format, 0, nullptr);
  out.encoded = encodeVolume(*out.state, nullptr, compression, kMaxPayloadBytes);
  return out;
}

Status tryPayload(const Sample& s, const std::string& payload) {
  VolumeDecoder decoder(s.state->shape, s.encoded.compression);
  if (Status status = decoder.add(s.encoded.parts[0].bricks, payload); !status.ok()) return status;
  return decoder.finish(s.encoded.checksum).status();
}

TEST(Malformed, EveryDamageIsAnError) {
  std::mt19937 generator(11);
  for (const Format format : {Format::kHalf, Format::kFloat, Format::kCompact}) {
    for (const Compression compression : {Compression::kNone, Compression::kZstd}) {
      const Sample s = sample(format, compression);
      const std::string& good = s.encoded.parts[0].payload;
      ASSERT_TRUE(tryPayload(s, good).ok());
      for (int i = 0; i < 300; ++i) {
        std::string bad = good;
        const auto at = std::size_t(generator()) % bad.size();
        bad[at] = char(bad[at] ^ (1U << (generator() % 8U)));
        // A frame's header has bits that change nothing; what it decodes to then is right all the same.
        const Status status = tryPayload(s, bad);
        EXPECT_TRUE(compression == Compression::kZstd || !status.ok()) << at;
        EXPECT_FALSE(tryPayload(s, good.substr(0, at)).ok()) << at;
      }
      EXPECT_FALSE(tryPayload(s, good + "x").ok());
      EXPECT_FALSE(tryPayload(s, "").ok());
    }
  }
}

/// The content of one brick and layer, by hand.
Status tryRunLevels(const std::string& runs, const std::string& levels) {
  const VolumeShape shape{Format::kCompact, Grid{{0, 0, 0}, 1.0, {8, 8, 8}}, VolumeStage::kTransported, {""}, {1.0}};
  const auto size = std::uint32_t(runs.size());
  std::string body(reinterpret_cast<const char*>(&size), sizeof(size));
  body += runs + levels;
  VolumeDecoder decoder(shape, Compression::kZstd);
  return decoder.add({{0, 1}}, compress(body));
}

TEST(Malformed, RunLevels) {
  const std::string dark = std::string("\x00", 1) + std::string(12, '\xff');
  EXPECT_TRUE(tryRunLevels(dark, "").ok());
  EXPECT_FALSE(tryRunLevels(dark.substr(0, 12), "").ok());               // a plane is missing
  EXPECT_FALSE(tryRunLevels(dark + "x", "").ok());                       // bytes left over
  EXPECT_FALSE(tryRunLevels(dark, "x").ok());                            // values left over
  EXPECT_FALSE(tryRunLevels("\x17" + dark.substr(1), "").ok());          // shift 23
  const std::string one = std::string("\x00\x00", 2) + std::string(12, '\xff');
  EXPECT_TRUE(tryRunLevels(one, "\x02").ok());
  EXPECT_FALSE(tryRunLevels(one, "").ok());                              // no value
  EXPECT_FALSE(tryRunLevels(one, "\x82").ok());                          // half a value
  EXPECT_FALSE(tryRunLevels(one, "\x82\x82\x82\x82\x82\x01").ok());      // an endless value
  EXPECT_FALSE(tryRunLevels(one, "\xfe\xff\xff\x7f").ok());              // beyond the largest coefficient
  std::string far = std::string("\x00", 1) + std::string(2, '\xfe') + "\x04" + std::string(12, '\xff');
  EXPECT_FALSE(tryRunLevels(far, "\x02").ok());                          // 254 + 254 + 4: the 513th
  far[3] = '\x03';
  EXPECT_TRUE(tryRunLevels(far.substr(0, far.size() - 1), "\x02").ok());
}

TEST(Malformed, AMessageThatExpandsTooFar) {
  const VolumeShape shape{
      Format::kFloat, Grid{{0, 0, 0}, 1.0, {128, 128, 128}}, VolumeStage::kTransported, {""}, {1.0}};
  VolumeDecoder decoder(shape, Compression::kZstd);
  const std::string zeros(64U * 512U * 48U, '\0');  // 64 bricks' worth: 1.5 MiB
  const Status status = decoder.add({{0, 64}}, compress(zeros));
  EXPECT_EQ(status.code(), Code::kInvalidArgument);
  EXPECT_NE(status.message().find("1572864"), std::string::npos) << status.message();
}

TEST(Malformed, ABaseOfAnotherKind) {
  const Sample half = sample(Format::kHalf, Compression::kZstd);
  const Sample compact = sample(Format::kCompact, Compression::kZstd);
  VolumeDecoder decoder(compact.state->shape, Compression::kZstd, half.state);
  EXPECT_EQ(decoder.add({{0, 1}}, "").field(), "base_result_id");
}

/// A delta on another base than it was made for gives another volume, which the checksum tells.
TEST(Malformed, ABaseThatIsNotTheOneMeant) {
  for (const Format format : {Format::kHalf, Format::kCompact}) {
    const VolumeStatePtr a = publish(fieldOf({{{1.0, 1.1, 0.6}}}, {8, 8, 8}), format, 0, nullptr);
    const VolumeStatePtr b = publish(fieldOf({{{1.2, 1.1, 0.6}}}, {8, 8, 8}), format, 0, a.get());
    const VolumeStatePtr c = publish(fieldOf({{{1.4, 1.1, 0.6}}}, {8, 8, 8}), format, 0, b.get());
    ASSERT_EQ(a->shape, c->shape);
    const EncodedVolume encoded = encodeVolume(*c, b.get(), Compression::kZstd, kMaxPayloadBytes);
    EXPECT_TRUE(decode(*c, encoded, b).ok());
    EXPECT_EQ(decode(*c, encoded, a).status().field(), "result.checksum");
  }
}

}  // namespace
}  // namespace lpv::wire
