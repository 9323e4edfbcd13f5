#pragma once
// Encodes published volumes as the parts of lpv/v1/result.proto, whole or as a delta to a base, and decodes them.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"
#include "wire/bricks.h"
#include "wire/volume_state.h"

namespace lpv::wire {

/// Compression of payloads.
enum class Compression { kNone, kZstd };

/// Largest payload, bytes, before and after compression.
inline constexpr std::size_t kMaxPayloadBytes = std::size_t(1) << 20U;

/// The content of one VolumePart message.
struct Part {
  std::vector<BrickRun> bricks;
  std::string payload;  ///< those bricks in order, coded as VolumePart.payload defines
};

struct EncodedVolume {
  std::uint64_t checksum = 0;  ///< of the whole target
  std::vector<double> scales;  ///< per layer
  Compression compression = Compression::kNone;
  std::vector<Part> parts;  ///< at least one
};

/// Encodes `target` as parts of at most `maxPayloadBytes` <= kMaxPayloadBytes, with at least one brick each. Without
/// `base` all its bricks are sent. With a base, which must have the same shape, only the bricks that differ; if none
/// does, one empty part.
EncodedVolume encodeVolume(const VolumeState& target, const VolumeState* base, Compression compression,
                           std::size_t maxPayloadBytes);

/// Assembles one volume from its parts, which may come in any order. Everything that the server sends is checked;
/// malformed input is an error and never undefined behaviour. A message decompresses to at most kMaxPayloadBytes, and
/// memory is allocated per brick as bricks arrive, not by what the header announces.
class VolumeDecoder {
 public:
  /// Bricks that no part has are taken from `base`, or are zeros without a base. A shape out of range, or a base of
  /// another shape, is reported by add and finish.
  VolumeDecoder(VolumeShape shape, Compression compression, VolumeStatePtr base = nullptr);

  /// Adds one part. INVALID_ARGUMENT for bricks that are out of range or were added before, and for a payload that does
  /// not fit them. After an error every call returns that error.
  Status add(const std::vector<BrickRun>& bricks, const std::string& payload);

  /// Returns the volume; the decoder cannot be used afterwards. INVALID_ARGUMENT if its checksum differs, for example
  /// because parts are missing.
  Expected<VolumeStatePtr> finish(std::uint64_t checksum);

 private:
  Status addBricks(const std::vector<BrickRun>& bricks, const std::string& payload);
  Expected<std::vector<int>> claim(const std::vector<BrickRun>& bricks);
  Status addPlain(const std::vector<int>& bricks, std::string_view body);
  Status addPlanes(const std::vector<int>& bricks, const std::string& body);
  Status addRunLevels(const std::vector<int>& bricks, std::string_view body);
  std::size_t plainBytes(const std::vector<int>& bricks) const;

  VolumeStatePtr base_;
  VolumeState state_;
  Compression compression_;
  Status status_;  ///< first error; returned from then on
  std::vector<bool> seen_;  ///< per brick
};

}  // namespace lpv::wire
