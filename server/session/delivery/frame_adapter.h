#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace lpv {

/// What a frame is made with.
struct FrameShape {
  glm::ivec2 size{0};  ///< pixels
  int quality = 85;    ///< JPEG, 1..100

  bool operator==(const FrameShape&) const = default;
};

/// Chooses size and quality of one subscriber's frames by how long it takes to acknowledge them: coarser at once when
/// they come too late for the rate, finer again step by step when a finer one, going by its bytes, would still come in
/// time. Where coarser frames come no sooner (the line is long, not narrow) it goes back, and leaves it for a while.
class FrameAdapter {
 public:
  /// `rate`: frames per second to keep, above 0.
  explicit FrameAdapter(double rate) : interval_(1.0 / rate) {}

  /// A frame was acknowledged `seconds` after it was given to be sent.
  void acknowledged(double seconds);
  /// What the next frame is made with where `wanted` was asked for: no edge below 16 pixels that was not, even edges.
  FrameShape shapeFor(const FrameShape& wanted) const;
  /// 0: as asked for; up to coarsest().
  int level() const { return level_; }
  static int coarsest();

 private:
  void goTo(int level);

  double interval_;  ///< seconds
  int level_ = 0;
  double mean_ = 0.0;  ///< seconds until the acknowledgement, of the frames at this level
  int seen_ = 0;  ///< of them
  double before_ = 0.0;  ///< the mean at the finer level that was left; 0: none was
  int finer_ = 0;  ///< that level
  int stay_ = 0;  ///< frames until coarser ones are tried again
};

}  // namespace lpv
