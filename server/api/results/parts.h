#pragma once
// Results as messages: volumes and frames cut into parts below the size limit, encoded once for all who want the same.

#include <future>
#include <list>
#include <memory>
#include <optional>
#include <vector>

#include "api/results/delta_chain.h"
#include "base/mutex.h"
#include "base/worker_pool.h"
#include "encode/frame_codec.h"
#include "lpv/v1/result.pb.h"
#include "session/answer_room.h"
#include "session/delivery/result.h"

namespace lpv::api {

namespace pb = lpv::v1;

/// Where an encoding finds its room, and whose it is.
struct EncodingRoom {
  AnswerRoom& answers;
  const std::string& session;
  const Limits& limits;
};

/// Whole volumes, so that calls for one volume in one coding share one: the last few small ones, and large ones while
/// an answer holds them.
class VolumeEncodings {
 public:
  /// RESOURCE_EXHAUSTED where there is no room for a new one.
  Expected<EncodingPtr> get(const VolumePtr& volume, const VolumeEncodingRequest& order, const EncodingRoom& room,
                            Counters& counters);

 private:
  struct Entry {
    std::weak_ptr<const Volume> volume;
    wire::Format format;
    wire::Compression compression;
    std::weak_ptr<const Encoding> encoding;
    EncodingPtr kept;  ///< the same, where it is small
  };
  Mutex mutex_;
  std::list<Entry> entries_ LPV_GUARDED_BY(mutex_);  // newest first
};

/// A finished result, ready to be pulled part by part. Of the result's own volume or pixels nothing is kept.
class VolumeParts {
 public:
  VolumeParts(const Result& result, const VolumeEncodingRequest& order, EncodingPtr encoding);
  /// False after the last part.
  bool next(pb::VolumePart* part);
  std::int64_t bytes() const { return bytes_; }

 private:
  void fill(pb::VolumeHeader* header) const;

  Result result_;
  VolumeEncodingRequest order_;
  EncodingPtr encoding_;
  std::size_t index_ = 0;
  std::int64_t bytes_ = 0;
};

/// Encodes pixels; the result is a file.
Expected<std::string> encodeFrame(const Frame& frame, pb::FrameFormat format, int quality);

/// An encoded picture, which those share who get the same.
using FrameFile = std::shared_ptr<const std::string>;

/// The files of frames that several subscribers get at once: each is encoded by the first who asks for it, and the
/// others wait for that.
class FrameEncodings {
 public:
  /// `pool` may be the caller's: another thread works in the place of one that waits.
  Expected<FrameFile> get(const FramePtr& frame, pb::FrameFormat format, int quality, WorkerPool& pool);

 private:
  struct Entry {
    std::weak_ptr<const Frame> frame;
    pb::FrameFormat format;
    int quality;
    std::shared_future<Expected<FrameFile>> file;
  };
  std::optional<std::shared_future<Expected<FrameFile>>> find(const FramePtr& frame, pb::FrameFormat format,
                                                              int quality) const LPV_REQUIRES(mutex_);

  Mutex mutex_;
  std::list<Entry> entries_ LPV_GUARDED_BY(mutex_);  // of frames that somebody still has
};

class FrameParts {
 public:
  /// `file` is the encoded picture; the result's room shrinks to it.
  FrameParts(Result result, pb::FrameFormat format, FrameFile file);
  bool next(pb::FramePart* part);
  std::int64_t bytes() const { return std::int64_t(file_->size()); }

 private:
  Result result_;
  pb::FrameFormat format_;
  FrameFile file_;
  std::size_t offset_ = 0;
  int index_ = 0;
  bool done_ = false;
};

void toProto(const ResultMeta& meta, pb::ResultInfo* out);

pb::VolumeFormat toProto(wire::Format format);
/// What a result of that format is counted as.
SentAs sentAs(wire::Format format);
SentAs sentAs(pb::FrameFormat format);
pb::PayloadCompression toProto(wire::Compression compression);

}  // namespace lpv::api
