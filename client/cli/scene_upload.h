#pragma once
// Uploads an imported scene to a session: blobs first, then edits, the last of which fits the grid, where it is fitted.

#include <string>
#include <vector>

#include "import/scene_file.h"
#include "lpv/editor.h"

namespace lpv::cli {

/// Names that the session gave to what was created.
struct UploadedScene {
  std::vector<std::string> lights;
  std::vector<std::string> surfaces;
  std::vector<std::string> cameras;
  std::uint64_t revision = 0;
  std::vector<std::string> warnings;  ///< of what lies outside a grid of fixed bounds
};

/// Uploads everything as one undo step. If an edit is refused, what the earlier ones created is removed again.
Expected<UploadedScene> uploadScene(client::Editor& editor, const ImportedScene& scene);

}  // namespace lpv::cli
