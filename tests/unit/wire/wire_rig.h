#pragma once
// Volumes for the codec's tests, and both ends of a wire.

#include <cstdint>
#include <optional>

#include "wire/publish.h"
#include "wire/volume_codec.h"

namespace lpv::wire {

/// A glowing disc of area `area` m^2 at `place`, facing `normal`, both sides, as seen from each cell centre: one
/// emitter small enough to be a point (MATHS.md 3b). Radiance 1 in green, `red` and `blue` in the others.
struct Glow {
  glm::dvec3 place{0.0};
  glm::dvec3 normal{0.0, 1.0, 0.0};
  double area = 0.05;
  double red = 0.6;
  double blue = 0.3;
};

/// The field of those emitters over a grid of cells of 0.25 m, in closed form; one layer.
Volume fieldOf(const std::vector<Glow>& glows, const glm::ivec3& dims);

/// Numbers without any order, and `layers` layers of them.
Volume randomVolume(const glm::ivec3& dims, std::size_t layers, float magnitude, std::uint32_t seed = 7);

/// Largest |L00 - held| and |L1 - held| / sqrt 3 of a cell and colour, relative as toleranceOf says.
double furthest(const Volume& truth, const Volume& held);

/// Parts through a decoder, last first: any order will do.
Expected<VolumeStatePtr> decode(const VolumeState& sent, const EncodedVolume& encoded, const VolumeStatePtr& base);

/// One end publishes, the other reconstructs from what it acknowledged last.
class Wire {
 public:
  Wire(Format format, int toleranceClass) : format_(format), class_(toleranceClass) {}

  /// Sends a volume relative to what is held; the decoder's error, if it has one.
  Status send(const Volume& volume);
  /// Publishes a volume that does not reach the other end.
  void skip(const Volume& volume);

  const VolumeStatePtr& published() const { return published_; }
  const VolumeStatePtr& held() const { return held_; }
  std::size_t bytes() const { return bytes_; }  ///< of the last result
  bool wasDelta() const { return delta_; }

 private:
  Format format_;
  int class_;
  VolumeStatePtr published_;
  VolumeStatePtr held_;
  std::size_t bytes_ = 0;
  bool delta_ = false;
};

}  // namespace lpv::wire
