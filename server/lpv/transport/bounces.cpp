#include "lpv/transport/bounces.h"

#include <algorithm>

namespace lpv {

namespace {

constexpr int kPairsOfThread = 8;  // of patch_exchange.comp and patch_balance.comp
constexpr int kTurnsOfBalance = 4;  // the room of 4 m, albedo .95: 4 % of its light lost with none, .1 % with these

std::uint32_t groupsFor(int threads) {
  return std::uint32_t((threads + layout::kPatchGroup - 1) / layout::kPatchGroup);
}

}  // namespace

BouncePass::BouncePass() : params_("patch params", sizeof(layout::PatchParams), gpu::BufferUse::kDynamic) {}

GpuTask BouncePass::dispatch(const Step& step, PatchSet& set, layout::PatchParams params, const GpuOccluders* occluders,
                             Pacing pacing) {
  for (params.first = 0; params.first < step.threads;) {
    const int wanted = int(pacing.unitsFor(step.stage) / step.units), left = step.threads - params.first;
    const int count = std::clamp(wanted, layout::kPatchGroup, std::max(left, layout::kPatchGroup));
    params_.update(0, gpu::bytesOfValue(params));
    params_.bindUniform(layout::kParams);
    set.patches.bindStorage(layout::kPatches);
    set.exchange.bindStorage(layout::kPatchExchange);
    set.sent.bindStorage(layout::kPatchSent);
    set.exchangeTexels.bind(layout::kPatchExchangeTexels);
    set.sentTexels.bind(layout::kPatchSentTexels);
    set.lights.bindStorage(layout::kPatchLights);
    if (set.shares) set.shares.bindStorage(layout::kPatchShares);
    if (set.folded()) set.pieceLights.bindStorage(layout::kPieceLights);
    if (set.foldHits) set.foldHits.bindStorage(layout::kFoldHits);
    if (occluders != nullptr) occluders->bind();
    step.program.dispatch(groupsFor(count));
    gpu::memoryBarrier();
    params.first += int(groupsFor(count)) * layout::kPatchGroup;
    co_yield submitted(step.stage, count * step.units);
  }
}

GpuTask BouncePass::findExchange(PatchSet& set, const GpuOccluders& occluders, Pacing pacing) {
  layout::PatchParams params = set.params();
  const int byEights = set.count * ((set.count + kPairsOfThread - 1) / kPairsOfThread);
  const Step looks = {crevices_.get({0, bool(set.shares)}), Stage::kVisibility, set.count,
                      double(layout::kCreviceRays)};
  co_await dispatch(looks, set, params, &occluders, pacing);
  const Step rays = {exchange_.get({bool(set.shares)}), Stage::kVisibility, byEights, double(kPairsOfThread)};
  co_await dispatch(rays, set, params, &occluders, pacing);
  const Step own = {crevices_.get({1, bool(set.shares)}), Stage::kReflect, set.count, double(set.count)};
  co_await dispatch(own, set, params, &occluders, pacing);
  const Step sums = {balance_.get({0}), Stage::kReflect, set.count, double(set.count)};
  co_await dispatch(sums, set, params, nullptr, pacing);
  const Step means = {balance_.get({1}), Stage::kReflect, byEights, double(kPairsOfThread)};
  co_await dispatch(means, set, params, nullptr, pacing);
  const Step scales = {balance_.get({2}), Stage::kReflect, set.count, double(set.count)};
  for (params.bounce = 1; params.bounce <= kTurnsOfBalance; ++params.bounce)
    co_await dispatch(scales, set, params, nullptr, pacing);
  const Step gains = {balance_.get({3}), Stage::kReflect, set.count, double(set.count)};
  co_await dispatch(gains, set, params, nullptr, pacing);
}

GpuTask BouncePass::findLights(PatchSet& set, const GpuOccluders& occluders, Pacing pacing) {
  const int byEights = set.count * ((set.count + kPairsOfThread - 1) / kPairsOfThread);
  const Step step = {lights_.get({}), Stage::kVisibility, byEights, double(kPairsOfThread)};
  layout::PatchParams params = set.params();
  params.lightsLow = glm::vec4(glm::vec3(occluders.boxOfLights().min), 0.0F);
  params.lightsHigh = glm::vec4(glm::vec3(occluders.boxOfLights().max), 0.0F);
  co_await dispatch(step, set, params, &occluders, pacing);
}

GpuTask BouncePass::run(PatchSet& set, const BouncePlan& plan, int done, int turns, Pacing pacing) {
  layout::PatchParams params = set.params();
  params.lastBounce = turns - 1;
  params.balanced = kTurnsOfBalance & 1;
  constexpr int kRows = layout::kPatchRows;
  const Step step = {bounce_.get({bool(set.shares)}), Stage::kReflect, (set.count + kRows - 1) / kRows,
                     double(kRows) * set.count};
  for (params.bounce = done; params.bounce < turns; ++params.bounce) {
    params.weight = float(plan.weight(params.bounce));
    co_await dispatch(step, set, params, nullptr, pacing);
  }
  if (!set.folded() || done > 0) co_return;  // pieces send what they sent when they were looked from
  const Step pieces = {pieces_.get({1}), Stage::kReflect, set.pieces, 1.0};
  co_await dispatch(pieces, set, params, nullptr, pacing);
  const Step sums = {pieces_.get({5}), Stage::kReflect, set.count, double(set.pieces) / set.count};
  co_await dispatch(sums, set, params, nullptr, pacing);
}

GpuTask BouncePass::takeMeans(PatchSet& set, Pacing pacing) {
  const Step means = {pieces_.get({0}), Stage::kReflect, set.count, double(set.pieces) / set.count};
  co_await dispatch(means, set, set.params(), nullptr, pacing);
}

GpuTask BouncePass::finishPieces(PatchSet& set, int foldTurns, int again, Pacing pacing) {
  layout::PatchParams params = set.params();
  params.foldTurns = foldTurns;
  const Step gather = {pieces_.get({4}), Stage::kReflect, set.pieces, double(foldTurns * layout::kFoldRays)};
  const Step pieces = {pieces_.get({2}), Stage::kReflect, set.pieces, 1.0};
  for (; params.bounce <= again; ++params.bounce) {
    if (again > 0) co_await dispatch(gather, set, params, nullptr, pacing);
    co_await dispatch(pieces, set, params, nullptr, pacing);
  }
  const Step means = {pieces_.get({3}), Stage::kReflect, set.count, double(set.pieces) / set.count};
  co_await dispatch(means, set, set.params(), nullptr, pacing);
}

GpuTask BouncePass::findSlopes(PatchSet& set, const GpuOccluders& occluders, Pacing pacing) {
  const Step slopes = {slopes_.get({bool(set.shares)}), Stage::kReflect, set.count, double(set.count)};
  co_await dispatch(slopes, set, set.params(), &occluders, pacing);
}

}  // namespace lpv
