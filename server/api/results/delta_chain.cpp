#include "api/results/delta_chain.h"

#include <algorithm>

#include "session/limits.h"
#include "wire/message_size.h"

namespace lpv::api {
namespace {

constexpr std::size_t kMostBases = 8;
constexpr std::size_t kFewestBases = 2;                          // two results may be in flight
constexpr std::size_t kMostBaseBytes = std::size_t(256) << 20U;  // per chain; large grids keep fewer bases

std::size_t bytesOf(const wire::VolumeState& state) {
  std::size_t bytes = 0;
  for (const wire::BrickPtr& brick : state.bricks) {
    if (brick) bytes += brick->elements.size() + brick->coefficients.size() * sizeof(std::int32_t);
  }
  return bytes;
}

std::size_t basesKept(const wire::VolumeState& state) {
  return std::clamp(kMostBaseBytes / std::max(bytesOf(state), std::size_t(1)), kFewestBases, kMostBases);
}

bool same(const std::optional<Bounds>& a, const std::optional<Bounds>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->min == b->min && a->max == b->max;
}

}  // namespace

EncodingPtr DeltaChain::encode(const Result& result, const VolumeEncodingRequest& order) {
  const MutexLock lock(mutex_);
  const wire::VolumeStatePtr target = stateOf(result, order);
  const bool inChain = find(result.meta.resultId) != nullptr;
  wire::VolumeStatePtr base = inChain && result.baseId != 0 ? find(result.baseId) : nullptr;
  if (base && base->shape != target->shape) base = nullptr;
  const std::uint64_t baseId = base ? result.baseId : 0;
  for (const CachedEncoding& made : encodings_) {
    if (made.resultId == result.meta.resultId && made.baseId == baseId && made.compression == order.compression &&
        same(made.region, order.region)) {
      return made.encoding;
    }
  }
  auto encoding = std::make_shared<Encoding>();
  encoding->volume = make(*target, base.get(), order);
  encoding->baseId = baseId;
  encodings_.push_front({result.meta.resultId, baseId, order.compression, order.region, encoding});
  return encoding;
}

/// Publishes what is newer than everything published.
wire::VolumeStatePtr DeltaChain::stateOf(const Result& result, const VolumeEncodingRequest& order) {
  if (wire::VolumeStatePtr known = find(result.meta.resultId)) return known;
  const bool newest = published_.empty() || published_.back().resultId < result.meta.resultId;
  const wire::VolumeState* previous = newest && !published_.empty() ? published_.back().state.get() : nullptr;
  wire::VolumeStatePtr state =
      wire::publish(*order.sentOf(result.volume), order.format, order.toleranceClass, previous);
  if (!newest) return state;
  // A worker may still ask for what was the newest until now, for nothing older.
  const std::uint64_t before = published_.empty() ? 0 : published_.back().resultId;
  std::erase_if(encodings_, [before](const CachedEncoding& made) { return made.resultId < before; });
  published_.push_back({result.meta.resultId, state});
  while (published_.size() > basesKept(*state)) published_.pop_front();
  return state;
}

wire::VolumeStatePtr DeltaChain::find(std::uint64_t resultId) const {
  for (const Published& p : published_) {
    if (p.resultId == resultId) return p.state;
  }
  return nullptr;
}

wire::EncodedVolume DeltaChain::make(const wire::VolumeState& target, const wire::VolumeState* base,
                                     const VolumeEncodingRequest& order) {
  ++counters_.volumesEncoded;
  if (!order.region) return wire::encodeVolume(target, base, order.compression, wire::kMaxPartBytes);
  const std::vector<bool> chosen = wire::bricksWithin(target.shape.grid, *order.region);
  const wire::VolumeState part = wire::onlyBricks(target, chosen);
  if (base == nullptr) return wire::encodeVolume(part, nullptr, order.compression, wire::kMaxPartBytes);
  const wire::VolumeState partOfBase = wire::onlyBricks(*base, chosen);
  return wire::encodeVolume(part, &partOfBase, order.compression, wire::kMaxPartBytes);
}

std::shared_ptr<DeltaChain> VolumeChains::get(const SessionPtr& session, const VolumeEncodingRequest& order,
                                              Counters& counters) {
  const MutexLock lock(mutex_);
  std::erase_if(chains_, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<DeltaChain>& chain =
      chains_[{session->id(), session->epoch(), order.stage, order.format, order.toleranceClass, order.guarded}];
  std::shared_ptr<DeltaChain> live = chain.lock();
  if (!live) chain = live = std::make_shared<DeltaChain>(counters);
  return live;
}

}  // namespace lpv::api
