#pragma once
// Published volumes to and from the parts of lpv/v1/result.proto, whole or relative to another.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"
#include "wire/bricks.h"
#include "wire/volume_state.h"

namespace lpv::wire {

/// How payloads are packed.
enum class Compression { kNone, kZstd };

/// A payload's bytes at most, before compression and after.
inline constexpr std::size_t kMaxPayloadBytes = std::size_t(1) << 20U;

/// One message's worth of a volume.
struct Part {
  std::vector<BrickRun> bricks;
  std::string payload;  ///< of those bricks, in order, as VolumePart says
};

struct EncodedVolume {
  std::uint64_t checksum = 0;  ///< of the whole target
  std::vector<double> scales;  ///< per layer
  Compression compression = Compression::kNone;
  std::vector<Part> parts;  ///< at least one
};

/// `target` as parts of at most `maxPayloadBytes` <= kMaxPayloadBytes (at least one brick each). Without `base`: every
/// brick it has. With one, of the same shape: the bricks that differ; an empty part where none does.
EncodedVolume encodeVolume(const VolumeState& target, const VolumeState* base, Compression compression,
                           std::size_t maxPayloadBytes);

/// Puts one volume together from its parts, in any order. Checks everything: whatever a server sends, the worst is an
/// error. A message's content is at most kMaxPayloadBytes, and bricks are made as they arrive, whatever the header
/// announced.
class VolumeDecoder {
 public:
  /// Bricks that do not come are those of `base`, zeros without one. A shape out of range, or a base of another, is
  /// reported by add and finish.
  VolumeDecoder(VolumeShape shape, Compression compression, VolumeStatePtr base = nullptr);

  /// INVALID_ARGUMENT for bricks out of range or seen before, and for a payload that is not theirs; from then on
  /// nothing else.
  Status add(const std::vector<BrickRun>& bricks, const std::string& payload);

  /// The volume; INVALID_ARGUMENT where the checksum is another, as it is where bricks are missing. Ends the decoder.
  Expected<VolumeStatePtr> finish(std::uint64_t checksum);

 private:
  Status addBricks(const std::vector<BrickRun>& bricks, const std::string& payload);
  Expected<std::vector<int>> claim(const std::vector<BrickRun>& bricks);
  Status addPlain(const std::vector<int>& bricks, std::string_view body);
  Status addPlanes(const std::vector<int>& bricks, const std::string& body);
  Status addTokens(const std::vector<int>& bricks, std::string_view body);
  std::size_t plainBytes(const std::vector<int>& bricks) const;

  VolumeStatePtr base_;
  VolumeState state_;
  Compression compression_;
  Status status_;  ///< why this decoder accepts nothing
  std::vector<bool> seen_;  ///< per brick
};

}  // namespace lpv::wire
