#pragma once
// Flags that several commands share: how files are read, transforms of objects, the camera and size of frames.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "import/scene_file.h"
#include "lpv/client.h"
#include "lpv/edits.h"
#include "lpv/v1/result.pb.h"

namespace lpv::cli {

/// Adds --scale, --up and --ignore-emissive-textures.
void addImportFlags(CLI::App& app, ImportOptions& options);
/// Adds --up only, for commands in which --scale is the object's scale.
void addUpFlag(CLI::App& app, ImportOptions& options);

/// The flags --translate, --rotate and --scale.
struct TransformFlags {
  std::optional<glm::dvec3> translate;  ///< metres
  std::optional<glm::dvec3> rotate;     ///< degrees: intrinsic X, then Y, then Z
  std::optional<glm::dvec3> scale;

  void addTo(CLI::App& app);
  bool any() const { return translate || rotate || scale; }
  client::Move move() const;
  /// The transform of a new object.
  Transform placed() const;
  /// The absolute move that --relative means from `now`: translations are added, rotations turn about the world's axes,
  /// scales are multiplied.
  client::Move relativeTo(const Transform& now) const;
};

/// The flags --eye, --target, --up-vector, --fov, --camera, --size, --exposure and --samples.
struct FrameFlags {
  std::optional<glm::dvec3> eye;
  std::optional<glm::dvec3> target;
  std::optional<glm::dvec3> up;
  std::optional<double> fov;
  std::string cameraName;
  std::optional<glm::ivec2> size;
  std::optional<v1::Exposure> exposure;
  int samples = 0;  ///< per pixel; 0: as the server has it
  bool falseColour = false;

  void addTo(CLI::App& app);
  void addCameraTo(CLI::App& app);
  void addSizeTo(CLI::App& app);
  /// --false-colour, of single frames.
  void addFalseColourTo(CLI::App& app);
  /// True if --eye and --target were given.
  bool hasCamera() const { return eye.has_value(); }
  /// The camera given by --eye and its companions; unset fields take the server's defaults.
  v1::Camera camera() const;
  /// Size in pixels; 640x360 by default.
  glm::ivec2 pixels() const { return size.value_or(glm::ivec2(640, 360)); }
};

/// Adds an option whose value is "v" or "r,g,b".
CLI::Option* addColour(CLI::App& app, const std::string& name, std::optional<glm::dvec3>& value,
                       const std::string& about);

}  // namespace lpv::cli
