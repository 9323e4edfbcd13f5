#pragma once
// Results put together from their parts, with everything a server sends checked.

#include <chrono>
#include <map>
#include <memory>
#include <optional>

#include "base/status.h"
#include "lpv/results.h"
#include "wire/volume_codec.h"

namespace lpv::client {

/// Parts of volumes in, volumes out.
class VolumeAssembler {
 public:
  /// The volume when this was its last part, nothing while parts are missing. After an error the next first part
  /// starts afresh.
  Expected<std::optional<VolumeResult>> add(const v1::VolumePart& part);

 private:
  Status begin(const v1::VolumePart& part);
  Expected<VolumeResult> finish();
  void hold(wire::VolumeStatePtr state);

  /// What deltas may be relative to: the base of the newest result and all after it, by result id.
  std::map<std::uint64_t, wire::VolumeStatePtr> held_;
  std::unique_ptr<wire::VolumeDecoder> decoder_;
  VolumeResult result_;
  int next_ = 0;
  std::chrono::steady_clock::time_point began_;
};

/// Parts of frames in, frames out.
class FrameAssembler {
 public:
  Expected<std::optional<FrameResult>> add(const v1::FramePart& part);

 private:
  Status begin(const v1::FramePart& part);
  bool active_ = false;
  FrameResult result_;
  int next_ = 0;
};

}  // namespace lpv::client
