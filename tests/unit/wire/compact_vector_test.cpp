// The test vector of proto/wire/COMPACT.md: what the decoder makes of the page's bytes. LPV_COMPACT_MD is the page's
 // path.

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "wire/volume_codec.h"

namespace lpv::wire {
namespace {

/// The elements of one cell of one layer.
struct VectorCell {
  std::size_t layer = 0;
  glm::ivec3 at{0};
  std::vector<std::int16_t> elements;
};

struct VectorResult {
  std::vector<BrickRun> bricks;
  std::string length;  ///< the payload's three parts
  std::string runs;
  std::string values;
  std::vector<VectorCell> cells;
  std::uint64_t checksum = 0;

  std::string payload() const { return length + runs + values; }
};

struct TestVector {
  glm::ivec3 dims{0};
  std::vector<double> scales;
  std::vector<VectorResult> results;
};

void appendHex(std::istream& hex, std::string* out) {
  for (int byte = 0; hex >> std::hex >> byte;) out->push_back(char(byte));
}

/// A line of a result; false for a keyword that none has.
bool addVectorLine(const std::string& keyword, std::istream& line, VectorResult* result) {
  if (keyword == "length") return appendHex(line, &result->length), true;
  if (keyword == "runs") return appendHex(line, &result->runs), true;
  if (keyword == "values") return appendHex(line, &result->values), true;
  if (keyword == "checksum") return bool(line >> std::hex >> result->checksum);
  if (keyword == "bricks") {
    BrickRun& run = result->bricks.emplace_back();
    return bool(line >> run.first >> run.count);
  }
  if (keyword != "element") return false;
  VectorCell& cell = result->cells.emplace_back();
  line >> cell.layer >> cell.at.x >> cell.at.y >> cell.at.z;
  cell.elements.assign(std::istream_iterator<std::int16_t>(line), std::istream_iterator<std::int16_t>());
  return cell.elements.size() == kCellElements;
}

TestVector readVector() {
  std::ifstream page(LPV_COMPACT_MD);
  TestVector out;
  std::string text;
  while (std::getline(page, text) && text != "```compact-vector") continue;
  while (std::getline(page, text) && text != "```") {
    std::istringstream line(text);
    std::string keyword;
    if (!(line >> keyword)) continue;
    if (keyword == "grid") {
      line >> out.dims.x >> out.dims.y >> out.dims.z;
    } else if (keyword == "scales") {
      out.scales.assign(std::istream_iterator<double>(line), std::istream_iterator<double>());
    } else if (keyword == "result") {
      out.results.emplace_back();
    } else if (out.results.empty() || !addVectorLine(keyword, line, &out.results.back())) {
      ADD_FAILURE() << "what is this line: " << text;
    }
  }
  return out;
}

std::vector<std::int16_t> elementsAt(const VolumeState& state, const VectorCell& cell) {
  for (std::size_t i = 0; i < state.bricks.size(); ++i) {
    const BrickBox box = brickBox(state.shape.grid.dims, int(i));
    if (glm::any(glm::lessThan(cell.at, box.first)) || !glm::all(glm::lessThan(cell.at, box.end))) continue;
    std::vector<std::int16_t> out(kCellElements, 0);
    if (state.bricks[i] == nullptr) return out;
    const glm::ivec3 in = cell.at - box.first;
    const auto number = std::size_t((in.z * box.size().y + in.y) * box.size().x + in.x);
    const std::size_t first = (cell.layer * box.cells() + number) * kCellElements * sizeof(std::int16_t);
    std::memcpy(out.data(), state.bricks[i]->elements.data() + first, kCellElements * sizeof(std::int16_t));
    return out;
  }
  return {};
}

/// Broken on purpose: a run of 254 that ends a channel, ties away from zero, ratios that are not limited.
TEST(CompactVector, IsWhatTheDecoderReads) {
  const TestVector vector = readVector();
  ASSERT_EQ(vector.results.size(), 2U) << "no vector in " << LPV_COMPACT_MD;
  const VolumeShape shape{Format::kCompact,
                          {{0.0, 0.0, 0.0}, 1.0, vector.dims},
                          VolumeStage::kTransported,
                          std::vector<std::string>(vector.scales.size()),
                          vector.scales};
  VolumeStatePtr held;
  for (const VectorResult& result : vector.results) {
    ASSERT_GE(result.cells.size(), 5U);
    VolumeDecoder decoder(shape, Compression::kNone, held);
    const Status added = decoder.add(result.bricks, result.payload());
    ASSERT_TRUE(added.ok()) << added.message();
    const Expected<VolumeStatePtr> state = decoder.finish(result.checksum);
    ASSERT_TRUE(state.ok()) << state.status().message();
    held = *state;
    for (const VectorCell& cell : result.cells) {
      EXPECT_EQ(elementsAt(*held, cell), cell.elements)
          << cell.layer << ": " << cell.at.x << " " << cell.at.y << " " << cell.at.z;
    }
  }
}

/// The encoder, given the two volumes as states, sends the page's bytes.
TEST(CompactVector, IsWhatTheEncoderSends) {
  const TestVector vector = readVector();
  ASSERT_EQ(vector.results.size(), 2U);
  const VolumeShape shape{Format::kCompact,
                          {{0.0, 0.0, 0.0}, 1.0, vector.dims},
                          VolumeStage::kTransported,
                          std::vector<std::string>(vector.scales.size()),
                          vector.scales};
  VolumeDecoder first(shape, Compression::kNone);
  ASSERT_TRUE(first.add(vector.results[0].bricks, vector.results[0].payload()).ok());
  const VolumeStatePtr base = *first.finish(vector.results[0].checksum);
  VolumeDecoder second(shape, Compression::kNone, base);
  ASSERT_TRUE(second.add(vector.results[1].bricks, vector.results[1].payload()).ok());
  const VolumeStatePtr target = *second.finish(vector.results[1].checksum);
  const EncodedVolume delta = encodeVolume(*target, base.get(), Compression::kNone, kMaxPayloadBytes);
  ASSERT_EQ(delta.parts.size(), 1U);
  EXPECT_EQ(delta.parts[0].payload, vector.results[1].payload());
  EXPECT_EQ(delta.checksum, vector.results[1].checksum);
}

}  // namespace
}  // namespace lpv::wire
