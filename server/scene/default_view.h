#pragma once

#include "scene/camera.h"
#include "scene/scene.h"

namespace lpv {

/// Chooses a view of a scene for subscribers that give no camera.
///
/// Inside a closed room with something in it, or lit from inside: from near one end along its longest horizontal axis,
/// at half its height, where the view is widest. A room with one open side: through that side, from outside. Anything
/// else: defaultCamera.
class DefaultView {
 public:
  /// The view of an empty scene.
  DefaultView() = default;
  /// Reads every triangle: tens of milliseconds for 100,000. Do not call it with a lock held.
  explicit DefaultView(const Scene& scene);

  /// `aspect`: width / height of the frame. It determines only the eye's distance from an open side.
  Camera camera(double aspect) const;

 private:
  enum class Kind { kOutside, kInside, kThroughOpening };

  Kind kind_ = Kind::kOutside;
  Bounds bounds_;
  Camera inside_;           ///< kInside
  int openAxis_ = 0;        ///< kThroughOpening: 0 or 2 ...
  bool openUpper_ = false;  ///< ... and whether it is the side at that axis's maximum
};

}  // namespace lpv
