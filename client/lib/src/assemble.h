#pragma once
// Assembles results from their parts and checks everything that the server sends.

#include <chrono>
#include <map>
#include <memory>
#include <optional>

#include "base/status.h"
#include "lpv/results.h"
#include "wire/volume_codec.h"

namespace lpv::client {

/// Assembles volumes from VolumeParts.
class VolumeAssembler {
 public:
  /// Returns the volume if this is its last part, nothing while parts are missing. After an error, assembly starts
  /// again at the next first part of a result.
  Expected<std::optional<VolumeResult>> add(const v1::VolumePart& part);

 private:
  Status begin(const v1::VolumePart& part);
  Expected<VolumeResult> finish();
  void hold(wire::VolumeStatePtr state);

  /// Volumes that deltas may be relative to, by result id: the base of the newest result and all results after it.
  std::map<std::uint64_t, wire::VolumeStatePtr> held_;
  std::unique_ptr<wire::VolumeDecoder> decoder_;
  VolumeResult result_;
  int next_ = 0;
  std::chrono::steady_clock::time_point began_;
};

/// Assembles frames from FrameParts.
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
