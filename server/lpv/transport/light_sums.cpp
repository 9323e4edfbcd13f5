#include "lpv/transport/light_sums.h"

#include <algorithm>

namespace lpv {

namespace {

/// Sums after which a light that does not change stands still: lights that are dragged in turns move all the while.
constexpr int kStandsAfter = 16;
/// Of the sums that are kept, and of those under way.
constexpr std::size_t kMostBytes = std::size_t(128) << 20U;
/// Adding two sums takes llvmpipe as long as gathering a light or two.
constexpr std::size_t kFewAtOnce = 4;

bool isIn(const LightRange& inner, const LightRange& outer) {
  return inner.begin >= outer.begin && inner.end <= outer.end;
}

std::size_t bytesOf(const LightSum& sum) { return sum.field.size() + sum.emitterDistance.size(); }

}  // namespace

std::size_t lightsAtOnce(std::size_t lights, std::size_t bytes) {
  std::size_t levels = 0;  // a sum under way on each
  while (kFewAtOnce << levels < lights && (levels + 1) * bytes <= kMostBytes) ++levels;
  return std::max(kFewAtOnce, (lights + (std::size_t(1) << levels) - 1) >> levels);
}

std::array<LightRange, 2> halvesOf(const LightRange& range, std::size_t atOnce) {
  const std::size_t parts = (range.count() + atOnce - 1) / atOnce;
  const std::size_t middle = range.begin + (parts + 1) / 2 * atOnce;
  return {{{range.begin, middle}, {middle, range.end}}};
}

std::vector<SentInputs> sentInputs(const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels,
                                   const Palette& palette) {
  std::vector<SentInputs> inputs;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const EmittingLight& light = lights[i];
    inputs.push_back({light.emission(), voxels[i]->made.stamp(), palette.weights[i], light.group, light.nextGroup,
                      light.moved, light.lookedAt});
  }
  return inputs;
}

/// Their memory serves others.
template <typename Condition>
void LightSums::letGoOf(const Condition& condition) {
  for (Kept& kept : kept_) {
    if (condition(kept.range)) spare_.push_back(std::move(kept.sum));
  }
  std::erase_if(kept_, [](const Kept& kept) { return !kept.sum.field; });
}

void LightSums::begin(ReceivedInputs received, std::vector<SentInputs> lights) {
  const bool same = received_ == received && lights_.size() == lights.size();
  if (same) {
    for (std::size_t i = 0; i < lights.size(); ++i)
      standing_[i] = lights_[i] == lights[i] ? std::min(standing_[i] + 1, kStandsAfter) : 0;
  } else {
    standing_.assign(lights.size(), kStandsAfter);
  }
  letGoOf([&](const LightRange& range) {
    return !same || std::count(standing_.begin() + std::ptrdiff_t(range.begin),
                               standing_.begin() + std::ptrdiff_t(range.end), 0) > 0;
  });
  received_ = std::move(received);
  lights_ = std::move(lights);
}

void LightSums::end() {
  if (std::count(standing_.begin(), standing_.end(), kStandsAfter) != std::ptrdiff_t(standing_.size())) return;
  kept_.clear();
  spare_.clear();
}

bool LightSums::keeps(const LightRange& range) const {
  if (range.end > standing_.size()) return false;
  std::size_t bytes = 0;
  for (const Kept& kept : kept_) bytes += bytesOf(kept.sum);
  const auto stands = [](int sums) { return sums == kStandsAfter; };
  return bytes < kMostBytes && !std::all_of(standing_.begin(), standing_.end(), stands) &&
         std::all_of(standing_.begin() + std::ptrdiff_t(range.begin), standing_.begin() + std::ptrdiff_t(range.end),
                     stands);
}

const LightSum* LightSums::known(const LightRange& range) const {
  for (const Kept& kept : kept_) {
    if (kept.range == range) return &kept.sum;
  }
  return nullptr;
}

void LightSums::keep(const LightRange& range, LightSum sum) {
  letGoOf([&](const LightRange& known) { return isIn(known, range); });
  kept_.push_back({range, std::move(sum)});
}

LightSum LightSums::take(const LightField& field) {
  const std::size_t bytes = field.transported().buffer.size();
  std::erase_if(spare_, [&](const LightSum& sum) { return sum.field.size() != bytes; });  // of another field
  if (!spare_.empty()) {
    LightSum sum = std::move(spare_.back());
    spare_.pop_back();
    return sum;
  }
  return {gpu::Buffer("sum of some lights", bytes, gpu::BufferUse::kDevice, gpu::Undefined{}),
          gpu::Buffer("nearest VPL of some", field.emitterDistance.size(), gpu::BufferUse::kDevice, gpu::Undefined{})};
}

}  // namespace lpv
