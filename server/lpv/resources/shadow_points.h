#pragma once
// What is known of the points of a list while light is summed at them, pool of lights by pool.

#include <string>

#include "gpu/buffer.h"
#include "shaders/layout.h"

namespace lpv {

class ShadowPoints {
 public:
  ShadowPoints() = default;
  /// Of so many points at most, with undefined content.
  ShadowPoints(const std::string& label, std::size_t points);

  /// As layout::kShadowPoints; layout::kPatchSums, too, once they are kept.
  void bind() const;
  /// Makes room for what patches send to each point, the first time.
  void keepPatchSums();
  explicit operator bool() const { return count_ > 0; }
  /// That there is room for.
  std::size_t count() const { return count_; }

 private:
  std::string label_;
  std::size_t count_ = 0;
  gpu::Buffer points_, patchSums_;
};

}  // namespace lpv
