#pragma once
// An imported scene to a session: blobs first, then edits, the last of which fits the grid.

#include <string>
#include <vector>

#include "import/scene_file.h"
#include "lpv/editor.h"

namespace lpv::cli {

/// What was made, by the names the session gave.
struct UploadedScene {
  std::vector<std::string> lights;
  std::vector<std::string> surfaces;
  std::vector<std::string> cameras;
  std::uint64_t revision = 0;
};

/// All or nothing: where an edit is refused, what earlier ones made is removed again. One undo step.
Expected<UploadedScene> uploadScene(client::Editor& editor, const ImportedScene& scene);

}  // namespace lpv::cli
