#pragma once
// Flags that several commands share: how files are read, where objects are, which camera looks.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "import/scene_file.h"
#include "lpv/client.h"
#include "lpv/edits.h"
#include "lpv/v1/result.pb.h"

namespace lpv::cli {

/// --scale, --up and --ignore-emissive-textures.
void addImportFlags(CLI::App& app, ImportOptions& options);
/// --up alone, for meshes that have --scale as an object's scale.
void addUpFlag(CLI::App& app, ImportOptions& options);

/// --translate, --rotate, --scale.
struct TransformFlags {
  std::optional<glm::dvec3> translate;  ///< metres
  std::optional<glm::dvec3> rotate;     ///< degrees: intrinsic X, then Y, then Z
  std::optional<glm::dvec3> scale;

  void addTo(CLI::App& app);
  bool any() const { return translate || rotate || scale; }
  client::Move move() const;
  /// The move from `now` where the flags add: translations are summed, rotations turn about the world's axes, scales
  /// multiply.
  client::Move relativeTo(const Transform& now) const;
};

/// --eye --target --up-vector --fov, --camera, --size, --exposure.
struct FrameFlags {
  std::optional<glm::dvec3> eye;
  std::optional<glm::dvec3> target;
  std::optional<glm::dvec3> up;
  std::optional<double> fov;
  std::string cameraName;
  std::optional<glm::ivec2> size;
  std::optional<v1::Exposure> exposure;

  void addTo(CLI::App& app);
  void addCameraTo(CLI::App& app);
  void addSizeTo(CLI::App& app);
  /// Whether a camera was described (not named).
  bool hasCamera() const { return eye.has_value(); }
  /// The camera described; unset fields keep the server's defaults.
  v1::Camera camera() const;
  /// Pixels; 640x360 unless given.
  glm::ivec2 pixels() const { return size.value_or(glm::ivec2(640, 360)); }
};

/// "v" or "r,g,b".
CLI::Option* addColour(CLI::App& app, const std::string& name, std::optional<glm::dvec3>& value,
                       const std::string& about);

/// Writes a file so that it appears complete or not at all.
Status writeFile(const std::string& path, const std::string& bytes);

}  // namespace lpv::cli
