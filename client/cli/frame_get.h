#pragma once
// Renders one frame into a file, for `frame get` and `render`.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "command.h"
#include "lpv/client.h"
#include "scene_flags.h"

namespace lpv::cli {

/// Where a frame goes, and as what.
struct FrameFile {
  std::string path;  ///< "-": stdout
  std::optional<v1::FrameFormat> given;

  /// Adds -o and --format.
  void addTo(CLI::App& app);
  /// The format given, else by the file's extension; PNG for stdout. An error unless it is png, jpg, jpeg or exr.
  Expected<v1::FrameFormat> format() const;
};

/// Requests the frame and writes it, with a progress line meanwhile. The server's default view is used when neither
/// `camera` nor the flags name one.
Expected<client::FrameResult> getFrame(client::Client& client, const std::string& session, const FrameFlags& flags,
                                       const std::optional<v1::Camera>& camera, const FrameFile& file);

}  // namespace lpv::cli
