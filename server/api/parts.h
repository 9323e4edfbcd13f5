#pragma once
// Results as messages: volumes and frames cut into parts below the size limit, encoded once for all who want the same.

#include <list>
#include <memory>
#include <mutex>
#include <vector>

#include "encode/frame_codec.h"
#include "lpv/v1/result.pb.h"
#include "session/results.h"
#include "wire/volume_codec.h"

namespace lpv::api {

namespace pb = lpv::v1;

using EncodedVolumePtr = std::shared_ptr<const wire::EncodedVolume>;

/// The last few encodings, so that every reader of one volume in one format shares one.
class VolumeEncodings {
 public:
  EncodedVolumePtr get(const VolumePtr& volume, wire::Format format);

 private:
  struct Entry {
    std::weak_ptr<const Volume> volume;
    wire::Format format;
    EncodedVolumePtr encoded;
  };
  std::mutex mutex_;
  std::list<Entry> entries_;  // newest first
};

/// The process's cache.
VolumeEncodings& volumeEncodings();

/// A finished result, ready to be pulled part by part.
class VolumeParts {
 public:
  VolumeParts(const Result& result, VolumeStage stage, wire::Format format);
  /// False after the last part.
  bool next(pb::VolumePart* part);
  std::int64_t bytes() const { return bytes_; }

 private:
  Result result_;
  VolumeStage stage_;
  wire::Format format_;
  EncodedVolumePtr encoded_;
  std::size_t index_ = 0;
  std::int64_t bytes_ = 0;
};

class FrameParts {
 public:
  /// `file` is the encoded picture.
  FrameParts(const Result& result, pb::FrameFormat format, std::string file);
  bool next(pb::FramePart* part);
  std::int64_t bytes() const { return std::int64_t(file_.size()); }

 private:
  Result result_;
  pb::FrameFormat format_;
  std::string file_;
  std::size_t offset_ = 0;
  int index_ = 0;
  bool done_ = false;
};

void toProto(const ResultMeta& meta, pb::ResultInfo* out);

Expected<wire::Format> volumeFormatOf(pb::VolumeFormat format);
pb::VolumeFormat toProto(wire::Format format);
Expected<VolumeStage> stageOf(pb::VolumeStage stage);

}  // namespace lpv::api
