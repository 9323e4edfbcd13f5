// The worked example of proto/wire/COMPACT.md: what the page states is what the encoder makes of the light and what the
// decoder makes of the bytes. LPV_COMPACT_MD is the page's path.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "wire/brick_transform.h"
#include "wire/compression.h"
#include "wire/publish.h"
#include "wire/volume_codec.h"

namespace lpv::wire {
namespace {

/// Element, component, then frequencies u, v, w.
using Place = std::array<std::size_t, 5>;

/// One result of the example; lists are per cell, x fastest, colour, coefficient.
struct Result {
  std::vector<float> light;
  double scale = 0.0;
  std::map<Place, std::int32_t> coded;  ///< differences to the base that are not 0
  std::string length;  ///< the payload's three parts
  std::string runs;
  std::string values;
  std::vector<std::int16_t> elements;
  std::vector<float> decoded;
  std::uint64_t checksum = 0;

  std::string payload() const { return length + runs + values; }
};

struct Example {
  glm::ivec3 dims{0};
  int toleranceClass = 0;
  std::map<std::string, Result> results;
};

/// The lines between the fence named "compact-example" and the next.
std::vector<std::string> fencedLines() {
  std::ifstream page(LPV_COMPACT_MD);
  std::vector<std::string> out;
  std::string line;
  while (std::getline(page, line) && line != "```compact-example") continue;
  while (std::getline(page, line) && line != "```") out.push_back(line);
  return out;
}

std::string bytesFrom(std::istream& hex) {
  std::string out;
  for (int byte = 0; hex >> std::hex >> byte;) out += char(byte);
  return out;
}

/// A line "X Y Z" and twelve numbers; cells have to come in the grid's order.
template <typename Number>
void addCell(std::istream& line, const glm::ivec3& dims, std::vector<Number>* out) {
  const auto cell = int(out->size() / kCellElements);
  glm::ivec3 at{-1};
  line >> at.x >> at.y >> at.z;
  EXPECT_EQ((at.z * dims.y + at.y) * dims.x + at.x, cell);
  out->insert(out->end(), std::istream_iterator<Number>(line), std::istream_iterator<Number>());
  EXPECT_EQ(out->size(), std::size_t(cell + 1) * kCellElements);
}

void addCoded(std::istream& line, Result* result) {
  Place place{};
  std::int32_t value = 0;
  for (std::size_t& index : place) line >> index;
  line >> value;
  EXPECT_FALSE(line.fail());
  EXPECT_TRUE(result->coded.emplace(place, value).second) << "stated twice";
}

/// A line of a result; false for a keyword that none has.
bool addLine(const std::string& keyword, std::istream& line, const glm::ivec3& dims, Result* result) {
  if (keyword == "light") return addCell(line, dims, &result->light), true;
  if (keyword == "element") return addCell(line, dims, &result->elements), true;
  if (keyword == "decoded") return addCell(line, dims, &result->decoded), true;
  if (keyword == "coded") return addCoded(line, result), true;
  if (keyword == "scale") return bool(line >> result->scale);
  if (keyword == "length") return result->length = bytesFrom(line), true;
  if (keyword == "runs") return result->runs = bytesFrom(line), true;
  if (keyword == "values") return result->values = bytesFrom(line), true;
  return keyword == "checksum" && bool(line >> std::hex >> result->checksum);
}

Example readExample() {
  Example out;
  Result* result = nullptr;
  for (const std::string& text : fencedLines()) {
    std::istringstream line(text);
    std::string keyword;
    std::string name;
    if (!(line >> keyword)) continue;
    if (keyword == "grid") {
      line >> out.dims.x >> out.dims.y >> out.dims.z;
    } else if (keyword == "class") {
      line >> out.toleranceClass;
    } else if (keyword == "result" && line >> name) {
      result = &out.results[name];
    } else if (result == nullptr || !addLine(keyword, line, out.dims, result)) {
      ADD_FAILURE() << "what is this line: " << text;
    }
  }
  return out;
}

Grid gridOf(const Example& example) { return {{0.0, 0.0, 0.0}, 1.0, example.dims}; }

VolumeStatePtr published(const Example& example, const Result& result, const VolumeState* before) {
  const Volume volume{gridOf(example), VolumeStage::kTransported, {{"", result.light}}, nullptr};
  return publish(volume, Format::kCompact, example.toleranceClass, before);
}

std::map<Place, std::int32_t> differences(const Brick& brick, const Brick* base) {
  std::map<Place, std::int32_t> out;
  for (std::size_t i = 0; i < brick.coefficients.size(); ++i) {
    const std::int32_t difference = brick.coefficients[i] - (base != nullptr ? base->coefficients[i] : 0);
    const std::size_t plane = i / kBrickCells;
    if (difference != 0) out[{plane / 3, plane % 3, i % 8, i / 8 % 8, i / 64 % 8}] = difference;
  }
  return out;
}

std::vector<std::int16_t> elementsOf(const Brick& brick) {
  std::vector<std::int16_t> out(brick.elements.size() / sizeof(std::int16_t));
  std::memcpy(out.data(), brick.elements.data(), brick.elements.size());
  return out;
}

void expectEncoded(const VolumeState& target, const VolumeState* base, const Result& stated) {
  EXPECT_EQ(target.shape.scales, std::vector<double>{stated.scale});
  ASSERT_EQ(target.bricks.size(), 1U);
  EXPECT_EQ(differences(*target.bricks[0], base != nullptr ? base->bricks[0].get() : nullptr), stated.coded);
  EXPECT_EQ(elementsOf(*target.bricks[0]), stated.elements);
  const EncodedVolume plain = encodeVolume(target, base, Compression::kNone, kMaxPayloadBytes);
  ASSERT_EQ(plain.parts.size(), 1U);
  EXPECT_EQ(plain.parts[0].payload, stated.payload());
  EXPECT_EQ(plain.checksum, stated.checksum);
  const EncodedVolume packed = encodeVolume(target, base, Compression::kZstd, kMaxPayloadBytes);
  ASSERT_EQ(packed.parts.size(), 1U);
  const Expected<std::string> body = decompress(packed.parts[0].payload, kMaxPayloadBytes);
  ASSERT_TRUE(body.ok()) << body.status().message();
  EXPECT_EQ(*body, stated.payload());
}

/// The volume that the stated bytes give, held to what else is stated of it; null where they give none.
VolumeStatePtr decoded(const Example& example, const Result& stated, const VolumeStatePtr& base) {
  const VolumeShape shape{Format::kCompact, gridOf(example), VolumeStage::kTransported, {""}, {stated.scale}};
  VolumeDecoder decoder(shape, Compression::kNone, base);
  const Status added = decoder.add({{0, 1}}, stated.payload());
  EXPECT_TRUE(added.ok()) << added.message();
  const Expected<VolumeStatePtr> state = decoder.finish(stated.checksum);
  EXPECT_TRUE(state.ok()) << state.status().message();
  if (!state) return nullptr;
  EXPECT_EQ(elementsOf(*(*state)->bricks[0]), stated.elements);
  const std::vector<float> floats = volumeFrom(**state).layers[0].coefficients;
  EXPECT_EQ(floats.size(), stated.decoded.size());
  for (std::size_t i = 0; i < std::min(floats.size(), stated.decoded.size()); ++i) {
    EXPECT_NEAR(floats[i], stated.decoded[i], 1e-5 * std::abs(stated.decoded[i])) << i;
  }
  return *state;
}

class CompactWorkedExample : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(example_.results.size(), 2U) << "no example in " << LPV_COMPACT_MD;
    const std::size_t numbers = gridOf(example_).cells() * kCellElements;
    for (const auto& [name, result] : example_.results) {
      ASSERT_EQ(result.light.size(), numbers) << name;
      ASSERT_EQ(result.elements.size(), numbers) << name;
      ASSERT_EQ(result.decoded.size(), numbers) << name;
    }
  }
  const Result& key() const { return example_.results.at("key"); }
  const Result& delta() const { return example_.results.at("delta"); }

  const Example example_ = readExample();
};

/// Broken on purpose: another first step, order of the scan or sign in the transform shows here.
TEST_F(CompactWorkedExample, IsWhatTheEncoderMakes) {
  const VolumeStatePtr first = published(example_, key(), nullptr);
  expectEncoded(*first, nullptr, key());
  const VolumeStatePtr second = published(example_, delta(), first.get());
  expectEncoded(*second, first.get(), delta());
}

/// The decoder sees the page's bytes only. Broken on purpose: another order of the scan or sign in the transform.
TEST_F(CompactWorkedExample, IsWhatTheDecoderReads) {
  const VolumeStatePtr first = decoded(example_, key(), nullptr);
  ASSERT_NE(first, nullptr);
  EXPECT_NE(decoded(example_, delta(), first), nullptr);
}

TEST_F(CompactWorkedExample, HasTheChecksumOfItsElements) {
  for (const auto& [name, result] : example_.results) {
    EXPECT_EQ(checksumBytes(result.elements.data(), result.elements.size() * sizeof(std::int16_t)), result.checksum)
        << name;
  }
}

TEST_F(CompactWorkedExample, IsWithinTheToleranceOfItsClass) {
  const double tolerance = toleranceOf(Format::kCompact, example_.toleranceClass);
  for (const auto& [name, result] : example_.results) {
    for (std::size_t i = 0; i < result.light.size(); i += 4) {
      const float* truth = &result.light[i];
      const float* held = &result.decoded[i];
      const double band1 = std::hypot(truth[1] - held[1], truth[2] - held[2], truth[3] - held[3]);
      EXPECT_LE(std::abs(truth[0] - held[0]), tolerance * truth[0]) << name << " " << i;
      EXPECT_LE(band1 / std::sqrt(3.0), tolerance * truth[0]) << name << " " << i;
    }
  }
}

}  // namespace
}  // namespace lpv::wire
