#pragma once
// The last published volumes of one session, stage, format and tolerance class: what deltas are relative to, encoded
// once for everybody who needs the same.

#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "base/mutex.h"
#include "session/answer_room.h"
#include "session/delivery/result.h"
#include "session/session.h"
#include "wire/publish.h"
#include "wire/volume_codec.h"

namespace lpv::api {

/// How a reader wants its volumes.
struct VolumeEncodingRequest {
  VolumeStage stage = VolumeStage::kTransported;
  wire::Format format = wire::Format::kHalf;
  wire::Compression compression = wire::Compression::kNone;
  int toleranceClass = 0;
  bool guarded = false;          ///< with guard cells
  std::optional<Bounds> region;  ///< world, metres

  /// What of a result is sent.
  const VolumePtr& sentOf(const VolumePtr& volume) const { return guarded ? volume->guarded : volume; }
};

/// A volume ready to be sent.
struct Encoding {
  wire::EncodedVolume volume;
  std::uint64_t baseId = 0;  ///< result it is relative to; 0: none
  AnswerHoldPtr hold = nullptr;  ///< the room of a large one that calls asked for
};
using EncodingPtr = std::shared_ptr<const Encoding>;

/// Thread-safe.
class DeltaChain {
 public:
  explicit DeltaChain(Counters& counters) : counters_(counters) {}

  /// `result` for a reader who holds result.baseId; a key frame where that is not among the last kept. A result older
  /// than the newest published is a key frame outside the chain.
  EncodingPtr encode(const Result& result, const VolumeEncodingRequest& order);

 private:
  struct Published {
    std::uint64_t resultId = 0;
    wire::VolumeStatePtr state;
  };
  struct CachedEncoding {
    std::uint64_t resultId = 0;
    std::uint64_t baseId = 0;
    wire::Compression compression;
    std::optional<Bounds> region;
    EncodingPtr encoding;
  };

  wire::VolumeStatePtr stateOf(const Result& result, const VolumeEncodingRequest& order) LPV_REQUIRES(mutex_);
  wire::VolumeStatePtr find(std::uint64_t resultId) const LPV_REQUIRES(mutex_);
  wire::EncodedVolume make(const wire::VolumeState& target, const wire::VolumeState* base,
                           const VolumeEncodingRequest& order);

  Counters& counters_;
  Mutex mutex_;  ///< held while encoding: a second reader waits instead of encoding again
  std::deque<Published> published_ LPV_GUARDED_BY(mutex_);  ///< oldest first
  std::list<CachedEncoding> encodings_ LPV_GUARDED_BY(mutex_);  ///< newest first
};

/// The chains that live subscribers share: one is gone when its last reader is.
class VolumeChains {
 public:
  std::shared_ptr<DeltaChain> get(const SessionPtr& session, const VolumeEncodingRequest& order, Counters& counters);

 private:
  using Key = std::tuple<std::string, std::uint64_t, VolumeStage, wire::Format, int, bool>;
  Mutex mutex_;
  std::map<Key, std::weak_ptr<DeltaChain>> chains_ LPV_GUARDED_BY(mutex_);
};

}  // namespace lpv::api
