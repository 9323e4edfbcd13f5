#pragma once
// Uploads an imported scene to a session: blobs first, then edits, the last of which fits the grid, where it is fitted.

#include <memory>
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

/// Lights and surfaces of a session that have the names of a scene's, as an earlier load of the same file leaves them.
struct EarlierLoad {
  std::vector<std::string> lights;
  std::vector<std::string> surfaces;
  std::size_t same = 0;  ///< those of the same mesh: without them the names are a coincidence
};

class SceneBlobs;

/// A scene on its way to a session.
class SceneUpload {
 public:
  /// `scene` has to outlive this.
  explicit SceneUpload(const ImportedScene& scene);
  ~SceneUpload();
  SceneUpload(const SceneUpload&) = delete;
  SceneUpload& operator=(const SceneUpload&) = delete;

  Expected<EarlierLoad> earlier(client::Client& client, const std::string& session) const;

  /// Uploads everything as one undo step, which removes `replaced` first. If an edit is refused, the session is again
  /// as it was.
  Expected<UploadedScene> run(client::Editor& editor, const EarlierLoad& replaced = {}) const;

 private:
  const ImportedScene& scene_;
  std::unique_ptr<SceneBlobs> blobs_;
};

}  // namespace lpv::cli
