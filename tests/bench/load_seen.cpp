#include "bench/load_seen.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string_view>

namespace lpv::bench {
namespace {

double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// "gather" of TICK_STAGE_GATHER.
std::string stageText(v1::TickStage stage) {
  std::string name = v1::TickStage_Name(stage);
  name.erase(0, std::min(name.size(), std::string_view("TICK_STAGE_").size()));
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return name;
}

}  // namespace

void LoadSeen::acknowledged(std::uint64_t revision) { newest_ = std::max(newest_.load(), revision); }

void LoadSeen::frame(const client::FrameResult& frame) {
  const std::lock_guard lock(mutex_);
  if (!anyFrame_) {
    for (const v1::StageTime& time : frame.header.result().stage_times())
      firstFrame_[stageText(time.stage())] = time.seconds();
    anyFrame_ = true;
  }
  if (!counting_) return;
  ++frames_;
  bytes_ += double(frame.file.size());
  const std::uint64_t newest = newest_;
  const std::uint64_t shown = frame.header.result().revision();
  behind_.push_back(newest > shown ? double(newest - shown) : 0.0);
  for (const v1::StageTime& time : frame.header.result().stage_times()) {
    stages_[stageText(time.stage())].push_back(time.seconds());
  }
}

void LoadSeen::volume() {
  anyVolume_ = true;
  if (counting_) ++volumes_;
}

void LoadSeen::report(Measured* out) {
  const std::lock_guard lock(mutex_);
  out->frames = double(frames_);
  out->frameBytes = bytes_;
  out->volumes = double(volumes_);
  out->firstFrameSeconds = firstFrame_;
  out->revisionsBehind = median(behind_);
  for (auto& [stage, seconds] : stages_) out->stageSeconds[stage] = median(seconds);
}

}  // namespace lpv::bench
