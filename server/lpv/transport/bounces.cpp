#include "lpv/transport/bounces.h"

#include <algorithm>

namespace lpv {

namespace {

constexpr int kPairsOfThread = 8;  // of patch_visibility.comp

std::uint32_t groupsFor(int threads) {
  return std::uint32_t((threads + layout::kPatchGroup - 1) / layout::kPatchGroup);
}

}  // namespace

BouncePass::BouncePass() : params_("patch params", sizeof(layout::PatchParams), gpu::BufferUse::kDynamic) {}

void BouncePass::bind(const PatchSet& set, const layout::PatchParams& params) {
  params_.update(0, gpu::bytesOfValue(params));
  params_.bindUniform(layout::kParams);
  set.patches.bindStorage(layout::kPatches);
  set.pairs.bindStorage(layout::kPatchPairs);
  set.lights.bindStorage(layout::kPatchLights);
}

GpuTask BouncePass::findPairs(PatchSet& set, const GpuOccluders& occluders, Pacing pacing) {
  layout::PatchParams params = set.params();
  const int threads = set.count * ((set.count + kPairsOfThread - 1) / kPairsOfThread);
  while (params.first < threads) {
    const int wanted = pacing.unitsFor(Stage::kVisibility) / kPairsOfThread;
    const int count = std::clamp(wanted, layout::kPatchGroup, std::max(threads - params.first, layout::kPatchGroup));
    bind(set, params);
    occluders.bind();
    pairs_.get({set.colours, occluders.transparent()}).dispatch(groupsFor(count));
    gpu::memoryBarrier();
    params.first += int(groupsFor(count)) * layout::kPatchGroup;
    co_yield submitted(Stage::kVisibility, double(count) * kPairsOfThread);
  }
}

GpuTask BouncePass::run(PatchSet& set, int bounces, Pacing pacing) {
  layout::PatchParams params = set.params();
  params.lastBounce = bounces - 1;
  double queued = 0.0;
  for (params.bounce = 0; params.bounce < bounces; ++params.bounce) {
    for (params.first = 0; params.first < set.count;) {
      const int wanted = pacing.unitsFor(Stage::kReflect) / set.count;
      const int count =
          std::clamp(wanted, layout::kPatchGroup, std::max(set.count - params.first, layout::kPatchGroup));
      bind(set, params);
      bounce_.get({set.colours}).dispatch(groupsFor(count));
      gpu::memoryBarrier();
      params.first += int(groupsFor(count)) * layout::kPatchGroup;
      queued += double(count) * set.count;
      if (queued < 0.9 * pacing.unitsFor(Stage::kReflect)) continue;
      co_yield submitted(Stage::kReflect, queued);
      queued = 0.0;
    }
  }
  co_yield submitted(Stage::kReflect, queued);
}

}  // namespace lpv
