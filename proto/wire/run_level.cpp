#include "wire/run_level.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "wire/brick_transform.h"

namespace lpv::wire {
namespace {

constexpr int kMaxShift = 22;
constexpr int kSkip = 254;          // 254 zeros without a value after them
constexpr int kEndOfChannel = 255;  // zeros to the end of the channel

/// Positions of a channel in coding order: low frequencies first, because most values that are not zero are there.
const std::array<std::uint16_t, kBrickCells>& scanOrder() {
  static const auto kOrder = [] {
    std::array<std::uint16_t, kBrickCells> order;
    std::iota(order.begin(), order.end(), std::uint16_t(0));
    const auto frequency = [](int i) { return i % 8 + i / 8 % 8 + i / 64; };
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return frequency(a) < frequency(b); });
    return order;
  }();
  return kOrder;
}

void appendLevel(std::int32_t level, std::string* out) {
  auto zigzag = (std::uint32_t(level) << 1U) ^ std::uint32_t(level >> 31);
  for (; zigzag >= 0x80U; zigzag >>= 7U) out->push_back(char(zigzag | 0x80U));
  out->push_back(char(zigzag));
}

void appendChannel(const std::int32_t* channel, int shift, RunLevels* out) {
  int zeros = 0;
  for (const std::uint16_t at : scanOrder()) {
    if (channel[at] == 0) {
      ++zeros;
      continue;
    }
    for (; zeros >= kSkip; zeros -= kSkip) out->runs.push_back(char(kSkip));
    out->runs.push_back(char(zeros));
    appendLevel(channel[at] / (1 << shift), &out->levels);
    zeros = 0;
  }
  if (zeros > 0) out->runs.push_back(char(kEndOfChannel));
}

Status torn() { return invalid("part.payload", "the payload ends within a brick"); }

}  // namespace

bool appendBlock(const std::int32_t* coefficients, RunLevels* out) {
  std::uint32_t all = 0;
  for (std::size_t i = 0; i < kChannels * kBrickCells; ++i) all |= std::uint32_t(coefficients[i]);
  const int shift = all == 0 ? 0 : std::min(std::countr_zero(all), kMaxShift);
  out->runs.push_back(char(shift));
  for (std::size_t channel = 0; channel < kChannels; ++channel)
    appendChannel(coefficients + channel * kBrickCells, shift, out);
  return all != 0;
}

bool RunLevelReader::takeRun(int* run) {
  if (runs_.empty()) return false;
  *run = std::uint8_t(runs_.front());
  runs_.remove_prefix(1);
  return true;
}

bool RunLevelReader::takeLevel(std::int32_t* level) {
  std::uint32_t zigzag = 0;
  for (std::uint32_t at = 0; at < 28 && !levels_.empty(); at += 7) {
    const auto byte = std::uint8_t(levels_.front());
    levels_.remove_prefix(1);
    zigzag |= std::uint32_t(byte & 0x7fU) << at;
    if (byte >= 0x80U) continue;
    *level = std::int32_t(zigzag >> 1U) ^ -std::int32_t(zigzag & 1U);
    return true;
  }
  return false;
}

Status RunLevelReader::addChannel(int shift, std::int32_t* channel) {
  std::size_t at = 0;
  while (at < kBrickCells) {
    int run = 0;
    if (!takeRun(&run)) return torn();
    if (run == kEndOfChannel) return {};
    at += std::size_t(run);
    if (run == kSkip) continue;
    if (at >= kBrickCells) return invalid("part.payload", "a coefficient of a brick lies outside it");
    std::int32_t level = 0;
    if (!takeLevel(&level)) return torn();
    std::int32_t& value = channel[scanOrder()[at++]];
    const std::int64_t sum = value + (std::int64_t(level) << shift);
    if (sum > kMaxCoefficient || sum < -kMaxCoefficient) {
      return invalid("part.payload", "a coefficient of a brick is " + std::to_string(sum) + ", allowed are +-" +
                                         std::to_string(kMaxCoefficient));
    }
    value = std::int32_t(sum);
  }
  return {};
}

Status RunLevelReader::addBlock(std::int32_t* coefficients) {
  int shift = 0;
  if (!takeRun(&shift)) return torn();
  if (shift > kMaxShift) return invalid("part.payload", "a brick's shift is " + std::to_string(shift));
  for (std::size_t channel = 0; channel < kChannels; ++channel) {
    if (Status s = addChannel(shift, coefficients + channel * kBrickCells); !s.ok()) return s;
  }
  return {};
}

}  // namespace lpv::wire
